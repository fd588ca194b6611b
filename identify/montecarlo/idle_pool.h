#pragma once
/// Objects that one thread uses at a time and that are dear to make: taken, used, given back.

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace volcal {

template <class Object>
class IdlePool {
 public:
  /// An idle object, or what make() gives, a unique_ptr.
  template <class Make>
  std::unique_ptr<Object> take(const Make& make) {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Object> object = std::move(idle_.back());
        idle_.pop_back();
        return object;
      }
    }
    return make();
  }
  void give_back(std::unique_ptr<Object> object) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(object));
  }
  /// All that are not in use.
  const std::vector<std::unique_ptr<Object>>& idle() const { return idle_; }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Object>> idle_;
};

}  // namespace volcal
