#pragma once
/// How many threads to use when the user does not say.

#include <algorithm>
#include <thread>

namespace volcal {

/// `asked`, or as many as the machine has when that is not positive; at least 1.
inline int thread_count(int asked) {
  return asked > 0 ? asked : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace volcal
