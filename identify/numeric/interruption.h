#pragma once
/// Whether long work goes on: asked between the items of run_parallel(), wherever they are, without a word
/// about it in what makes them.
///
///   const Interruption guard([&] { if (!wanted()) throw Stopped(); });
///   scan(...);  // throws Stopped between two of its items
///
/// The question is asked in the thread of the guard alone, at most every kBetween; threads that work for it
/// stop once it has thrown, with the same exception. Guards of one thread may be nested: the inner one is
/// asked.

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <thread>
#include <utility>

namespace volcal {

class Interruption {
 public:
  static constexpr std::chrono::milliseconds kBetween{20};

  /// `question` throws what the work is to be left with.
  explicit Interruption(std::function<void()> question)
      : question_(std::move(question)), before_(std::exchange(current(), this)) {}
  ~Interruption() { current() = before_; }
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// Of this thread; null: nobody asks.
  static Interruption*& current() {
    thread_local Interruption* of_thread = nullptr;
    return of_thread;
  }
  /// Throws where the work of this thread is to stop.
  static void check() {
    if (Interruption* own = current()) own->ask();
  }

  /// Makes a thread work for the guard of another one.
  class Share {
   public:
    explicit Share(Interruption* with) : before_(std::exchange(current(), with)) {}
    ~Share() { current() = before_; }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

   private:
    Interruption* before_;
  };

 private:
  void ask() {
    if (stopped_.load(std::memory_order_acquire)) std::rethrow_exception(reason_);
    if (std::this_thread::get_id() != owner_) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < kBetween) return;
    last_ = now;
    try {
      question_();
    } catch (...) {
      reason_ = std::current_exception();
      stopped_.store(true, std::memory_order_release);
      throw;
    }
  }

  std::function<void()> question_;
  Interruption* before_;
  std::thread::id owner_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point last_{};
  std::exception_ptr reason_;
  std::atomic<bool> stopped_{false};
};

}  // namespace volcal
