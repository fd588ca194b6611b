#pragma once
/// What a registry holds: the library's own plug-ins and those that a program adds to them.

#include <algorithm>
#include <atomic>
#include <deque>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace volcal {

/// Plug-ins by name, in the order of their registration. Any number of threads may read and add; what all()
/// has returned stays valid, and does not see what is added later. A program therefore adds its own before it
/// uses the library.
template <class Plugin>
class Registration {
 public:
  using NameOf = std::string_view (*)(const Plugin& plugin);

  Registration(std::initializer_list<const Plugin*> built_in, NameOf name_of) : name_of_(name_of) {
    states_.emplace_back(built_in);
    current_ = &states_.back();
  }

  std::span<const Plugin* const> all() const { return *current_.load(); }

  const Plugin* find(std::string_view name) const {
    const auto plugins = all();
    const auto found =
        std::ranges::find_if(plugins, [&](const Plugin* plugin) { return name_of_(*plugin) == name; });
    return found == plugins.end() ? nullptr : *found;
  }

  /// Throws std::invalid_argument for nothing, a plug-in without a name, and a name that is taken.
  const Plugin& add(std::unique_ptr<const Plugin> plugin) {
    if (plugin == nullptr) throw std::invalid_argument("nothing is registered");
    const std::string_view name = name_of_(*plugin);
    if (name.empty()) throw std::invalid_argument("what is registered has no name");
    const std::lock_guard lock(adding_);
    if (find(name) != nullptr)
      throw std::invalid_argument("\"" + std::string(name) + "\" is registered already: choose another name");
    std::vector<const Plugin*> next = *current_.load();
    next.push_back(plugin.get());
    own_.push_back(std::move(plugin));
    states_.push_back(std::move(next));
    current_ = &states_.back();
    return *own_.back();
  }

 private:
  NameOf name_of_;
  std::mutex adding_;
  std::deque<std::unique_ptr<const Plugin>> own_;
  std::deque<std::vector<const Plugin*>> states_;  ///< each as it was before something was added to it
  std::atomic<const std::vector<const Plugin*>*> current_ = nullptr;
};

}  // namespace volcal
