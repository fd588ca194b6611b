/// The fuzzers without libFuzzer: every input of a corpus, then inputs made from it by chance, for so many
/// seconds or so many inputs. Built with the compiler and the libraries of the tests, it shows what throws,
/// aborts or does not end; coverage and sanitizers are the preset fuzz's.
///
/// Usage: short_fuzz NAME CORPUS SECONDS [SEED]      SECONDS 0: the corpus alone

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#define VOLCAL_FUZZER(NAME) extern "C" int NAME##_input(const std::uint8_t* data, std::size_t size);
#include "short_fuzz_names.inc"
#undef VOLCAL_FUZZER

namespace {

using Bytes = std::vector<std::uint8_t>;
using Fuzzer = int (*)(const std::uint8_t*, std::size_t);

constexpr std::size_t kLongest = 1 << 16;

Fuzzer fuzzer_named(const std::string& name) {
#define VOLCAL_FUZZER(NAME) \
  if (name == #NAME) return NAME##_input;
#include "short_fuzz_names.inc"
#undef VOLCAL_FUZZER
  return nullptr;
}

std::vector<Bytes> corpus(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<Bytes> inputs;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return inputs;
}

class Mutator {
 public:
  Mutator(const std::vector<Bytes>& inputs, std::uint64_t seed) : inputs_(inputs), random_(seed) {}

  Bytes next() {
    Bytes input = inputs_[below(inputs_.size())];
    for (std::size_t changes = 1 + below(8); changes > 0; --changes) change(input);
    if (input.size() > kLongest) input.resize(kLongest);
    return input;
  }

 private:
  std::size_t below(std::size_t count) { return count == 0 ? 0 : random_() % count; }

  void change(Bytes& input) {
    static const std::vector<std::string> words = {
        "1e308", "-1e308", "1e-308", "nan",  "inf", "9223372036854775808",
        "-1",    "0",      "\"",     "[",    "]",   "{",
        "}",     ",",      ";",      "\r\n", "#",   "'",
        ".",     "=",      "\n",     "e",    "(",   ")",
        "null",  "true",   "[[",     "]]",   "/",   "\\u0000",
        "\xff",  "\t"};
    const std::size_t at = below(input.size() + 1);
    const auto place = input.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(6)) {
      case 0:
        if (at < input.size()) input[at] = static_cast<std::uint8_t>(random_());
        return;
      case 1: {
        const std::size_t size = std::min(input.size() - at, below(1 + below(64)));
        input.erase(place, place + static_cast<std::ptrdiff_t>(size));
        return;
      }
      case 2: {
        const std::string& word = words[below(words.size())];
        input.insert(place, word.begin(), word.end());
        return;
      }
      case 3: {
        const std::string& word = words[below(words.size())];
        for (std::size_t i = 0; i < word.size() && at + i < input.size(); ++i)
          input[at + i] = static_cast<std::uint8_t>(word[i]);
        return;
      }
      case 4:
        insert_piece(inputs_[below(inputs_.size())], input, at);
        return;
      default:
        insert_piece(Bytes(input), input, at);
    }
  }

  void insert_piece(const Bytes& from, Bytes& input, std::size_t at) {
    if (from.empty()) return;
    const std::size_t begin = below(from.size()), size = std::min(from.size() - begin, 1 + below(256));
    const auto first = from.begin() + static_cast<std::ptrdiff_t>(begin);
    input.insert(input.begin() + static_cast<std::ptrdiff_t>(at), first,
                 first + static_cast<std::ptrdiff_t>(size));
  }

  const std::vector<Bytes>& inputs_;
  std::mt19937_64 random_;
};

constexpr unsigned kLongestRun = 20;  // s, of one input

// What a signal handler sees of the input that runs.
const Bytes* running = nullptr;
std::string kept;

/// Async-signal-safe.
void keep_running_input() {
  const int file = ::open(kept.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file < 0 || running == nullptr) return;
  const auto written = ::write(file, running->data(), running->size());
  static_cast<void>(written);
  ::close(file);
}

void keep_and_end(int signal) {
  keep_running_input();
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

/// Handlers run on a stack of their own: an input may have used up the other.
void keep_inputs_that_crash() {
  static std::array<char, 1 << 16> stack;
  stack_t alternative{};
  alternative.ss_sp = stack.data();
  alternative.ss_size = stack.size();
  ::sigaltstack(&alternative, nullptr);
  struct sigaction action {};
  action.sa_handler = keep_and_end;
  action.sa_flags = SA_ONSTACK;
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGALRM}) ::sigaction(signal, &action, nullptr);
}

class Runner {
 public:
  explicit Runner(Fuzzer fuzzer) : fuzzer_(fuzzer) {}

  void run(const Bytes& input) {
    running = &input;
    ::alarm(kLongestRun);
    try {
      fuzzer_(input.data(), input.size());
    } catch (...) {
      keep_running_input();
      throw;
    }
    ++count_;
  }
  unsigned long count() const { return count_; }

 private:
  Fuzzer fuzzer_;
  unsigned long count_ = 0;
};

int fuzz(const std::string& name, const std::string& folder, double seconds, std::uint64_t seed) {
  using Clock = std::chrono::steady_clock;
  const Fuzzer fuzzer = fuzzer_named(name);
  if (fuzzer == nullptr) {
    std::fprintf(stderr, "short_fuzz: there is no fuzzer %s\n", name.c_str());
    return 2;
  }
  const std::vector<Bytes> inputs = corpus(folder);
  if (inputs.empty()) {
    std::fprintf(stderr, "short_fuzz: %s holds no input\n", folder.c_str());
    return 2;
  }
  kept = "broke-" + name;
  keep_inputs_that_crash();
  Runner runner(fuzzer);
  try {
    for (const Bytes& input : inputs) runner.run(input);
    Mutator mutator(inputs, seed);
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (Clock::now() < end) {
      const Bytes input = mutator.next();
      runner.run(input);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s; the input is %s\n", name.c_str(), error.what(), kept.c_str());
    return 1;
  }
  std::printf("%s: %lu inputs\n", name.c_str(), runner.count());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: short_fuzz NAME CORPUS SECONDS [SEED]\n");
    return 2;
  }
  const char* const longer = std::getenv("VOLCAL_FUZZ_SECONDS");
  return fuzz(argv[1], argv[2], std::atof(longer != nullptr ? longer : argv[3]),
              argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1);
}
