/// What OpenBLAS needs to start. Without 128 MiB of address space for a buffer of each of its threads it
/// tries for ever, and it makes the first threads while it is loaded, before main(). So the limits of the
/// process (ulimit -v, ulimit -d) are looked at before any library is initialised: under one, the program
/// starts itself again with a single thread of OpenBLAS, which is all that it uses, or says that the limit is
/// too low.

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstddef>

namespace {

constexpr std::size_t kLeastMebibytes =
    320;  // libraries, one buffer of OpenBLAS, matrices of a small campaign
constexpr std::size_t kMebibyte = std::size_t{1} << 20U;
constexpr const char* kThreadsOfBlas = "OPENBLAS_NUM_THREADS=";
constexpr std::size_t kMostVariables = 4096;

bool limits_memory(decltype(RLIMIT_AS) which) {
  rlimit limit{};
  return ::getrlimit(which, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

bool starts_with(const char* text, const char* begin) {
  while (*begin != '\0') {
    if (*text++ != *begin++) return false;
  }
  return true;
}

bool has_room() {
  constexpr std::size_t kBytes = kLeastMebibytes * kMebibyte;
  void* const room =
      ::mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) return false;
  ::munmap(room, kBytes);
  return true;
}

[[noreturn]] void refuse_to_start() {
  constexpr char kSentence[] =
      "error: the limit of memory is too low to start: 320 MiB must be free (raise or lift it: ulimit -v, "
      "ulimit -d)\n";
  const auto written = ::write(STDERR_FILENO, kSentence, sizeof kSentence - 1);
  ::_exit(written < 0 ? 1 : 2);
}

/// Returns only where that is not possible.
void start_again_with_one_thread(char** arguments, char** environment) {
  static char variable[] = "OPENBLAS_NUM_THREADS=1";
  static char* extended[kMostVariables];
  std::size_t count = 0;
  for (; environment[count] != nullptr; ++count) {
    if (count + 2 >= kMostVariables || starts_with(environment[count], kThreadsOfBlas)) return;
    extended[count] = environment[count];
  }
  extended[count] = variable;
  extended[count + 1] = nullptr;
  ::execve("/proc/self/exe", arguments, extended);
}

void check_memory_limit(int /*argc*/, char** arguments, char** environment) {
  if (!has_room()) refuse_to_start();
  if (limits_memory(RLIMIT_AS) || limits_memory(RLIMIT_DATA))
    start_again_with_one_thread(arguments, environment);
}

// Called by the loader before the constructors of the shared libraries. Sanitizers map terabytes of their
// own.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)
[[gnu::section(".preinit_array"), gnu::used]] void (*const kCheckMemoryLimit)(int, char**,
                                                                              char**) = check_memory_limit;
#else
[[maybe_unused]] void (*const kCheckMemoryLimit)(int, char**, char**) = check_memory_limit;
#endif

}  // namespace
