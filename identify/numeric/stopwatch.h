#pragma once
/// Time between stages of a computation.

#include <chrono>

namespace volcal {

class Stopwatch {
 public:
  /// Since the lap before, or since it was made, s.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace volcal
