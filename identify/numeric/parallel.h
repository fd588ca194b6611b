#pragma once
/// Items of work over threads.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace volcal {

/// work(0) ... work(items - 1), in any order; the first exception is thrown on.
template <class Work>
void run_parallel(std::size_t items, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto run = [&] {
    try {
      for (std::size_t item = next++; item < items; item = next++) work(item);
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
      next = items;
    }
  };
  std::vector<std::thread> workers;
  const int extra = std::min(threads, static_cast<int>(items)) - 1;
  workers.reserve(static_cast<std::size_t>(std::max(extra, 0)));
  for (int i = 0; i < extra; ++i) workers.emplace_back(run);
  run();
  for (std::thread& worker : workers) worker.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace volcal
