#pragma once
/// Ctrl-C while work is under way that can be ended between two parts of it.

#include <string_view>

namespace volcal::cli {

/// Holds SIGINT while it lives; a second one ends the program at once. One at a time. `words`, a literal, are
/// written at the first.
class InterruptWatch {
 public:
  explicit InterruptWatch(std::string_view words);
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  bool was_asked_for() const;
};

}  // namespace volcal::cli
