#pragma once
/// How many threads to use when the user does not say.

#include <algorithm>
#include <thread>

namespace volcal {

/// More than any machine works faster with; every thread takes memory.
inline constexpr int kMostThreads = 1024;

/// `asked`, or as many as the machine has when that is not positive; 1 to kMostThreads.
inline int thread_count(int asked) {
  return asked > 0 ? std::min(asked, kMostThreads)
                   : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace volcal
