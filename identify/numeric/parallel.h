#pragma once
/// Items of work over threads.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "volcal/identify/numeric/interruption.h"

namespace volcal {

/// Threads beside the calling one. Where the system gives fewer than asked for, there are fewer.
class Workers {
 public:
  template <class Work>
  Workers(int count, const Work& work) {
    try {
      threads_.reserve(static_cast<std::size_t>(std::max(count, 0)));
      for (int i = 0; i < count; ++i) threads_.emplace_back(work);
    } catch (const std::system_error&) {  // the others take what is left
    } catch (const std::bad_alloc&) {
    }
  }
  ~Workers() {
    for (std::thread& thread : threads_) thread.join();
  }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

 private:
  std::vector<std::thread> threads_;
};

/// work(0) ... work(items - 1), in any order; the first exception is thrown on, and that of an Interruption
/// of the calling thread, which is asked before every item.
template <class Work>
void run_parallel(std::size_t items, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  Interruption* const interruption = Interruption::current();
  const auto run = [&] {
    const Interruption::Share share(interruption);
    try {
      for (std::size_t item = next++; item < items; item = next++) {
        Interruption::check();
        work(item);
      }
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
      next = items;
    }
  };
  {
    const std::size_t most = std::min<std::size_t>(items, static_cast<std::size_t>(std::max(threads, 1)));
    const Workers workers(static_cast<int>(most) - 1, std::cref(run));
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace volcal
