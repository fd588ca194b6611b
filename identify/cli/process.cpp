#include "volcal/identify/cli/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <thread>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/numeric/blas_core.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/text/temporary_paths.h"

namespace volcal::cli {
namespace {

std::atomic<int> interruption{
    0};                     // NOLINT(*-avoid-non-const-global-variables): a signal handler sees no other
int wake_up[2] = {-1, -1};  // NOLINT(*-avoid-non-const-global-variables): likewise

struct Work {
  std::mutex guard;
  std::string words;
};

Work& work() {
  static auto* const current = new Work;  // outlives the threads that look at it
  return *current;
}

std::string reason(int signal) {
  if (signal == SIGXCPU) return "the processor time allowed (ulimit -t) is used up";
  return fmt::format("interrupted by {}", signal == SIGINT    ? "SIGINT"
                                          : signal == SIGTERM ? "SIGTERM"
                                                              : "SIGHUP");
}

void say(const std::string& sentence) {
  const auto written = ::write(STDERR_FILENO, sentence.data(), sentence.size());
  static_cast<void>(written);
}

[[noreturn]] void end_interrupted(int signal) {
  const bool written = abandon_temporary_paths();
  const std::string doing = current_work();
  say(fmt::format(
      "{}volcal: {}{}: {}\n", ::isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", reason(signal),
      doing.empty() ? "" : " (" + doing + ")",
      written ? "what had been written is complete" : "nothing was written, the output is as before"));
  ::_exit(kIncomplete);
}

/// Only what is allowed in a handler: it wakes the thread that ends the program, or ends it where there is
/// none.
void note_signal(int signal) {
  const int before = errno;
  int none = 0;
  if (interruption.compare_exchange_strong(none, signal)) {
    const char byte = 0;
    if (wake_up[1] < 0 || ::write(wake_up[1], &byte, 1) != 1) ::_exit(kIncomplete);
  }
  errno = before;
}

void wait_for_signal() {
  char byte = 0;
  while (::read(wake_up[0], &byte, 1) < 0 && errno == EINTR) {
  }
  end_interrupted(interruption);
}

void watch_signals() {
  if (::pipe2(wake_up, O_CLOEXEC) != 0) return;
  try {
    std::thread(wait_for_signal).detach();
  } catch (const std::system_error&) {
    ::close(wake_up[1]);
    wake_up[1] = -1;
  }
}

void handle(int signal, void (*handler)(int)) {
  struct sigaction before {};
  if (::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) return;  // nohup
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  ::sigaction(signal, &action, nullptr);
}

/// A file opened later must not get the number of a closed standard stream: what is printed would go into it.
/// Writing to what stands there instead fails, as it should.
void occupy_closed_streams() {
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    const int taken = ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (taken >= 0 && taken != stream) ::close(taken);
  }
}

/// At the hard limit the system kills without a word; a second before it SIGXCPU comes.
void hear_of_processor_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_CPU, &limit) != 0 || limit.rlim_max == RLIM_INFINITY) return;
  if (limit.rlim_cur < limit.rlim_max || limit.rlim_max < 2) return;
  limit.rlim_cur = limit.rlim_max - 1;
  ::setrlimit(RLIMIT_CPU, &limit);
}

}  // namespace

void start_with_better_kernels(char** arguments) {
  const auto core = better_blas_core();
  if (!core || ::setenv("OPENBLAS_CORETYPE", core->c_str(), 0) != 0) return;
  ::execv("/proc/self/exe", arguments);  // returns where that is not possible: the kernels stay what they are
}

void prepare_process() {
  occupy_closed_streams();
  use_single_threaded_blas();
  watch_signals();
  hear_of_processor_limit();
  handle(SIGXFSZ, SIG_IGN);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) handle(signal, note_signal);
}

void stay_if_interrupted() {
  while (interruption != 0 && wake_up[1] >= 0) ::pause();
}

void set_current_work(const std::string& words) {
  const std::lock_guard lock(work().guard);
  work().words = words;
}

std::string current_work() {
  const std::lock_guard lock(work().guard);
  return work().words;
}

std::string out_of_memory_message() {
  const std::string doing = current_work();
  return fmt::format(
      "the memory does not suffice{}; nothing more was written (fewer readings, setups or parameters, fewer "
      "--threads, or a higher limit, see ulimit -v)",
      doing.empty() ? "" : " for " + doing);
}

}  // namespace volcal::cli
