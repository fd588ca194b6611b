#include "volcal/identify/cli/interrupt_watch.h"

#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigaction() is POSIX
#include <unistd.h>

#include <string_view>

namespace volcal::cli {
namespace {

volatile sig_atomic_t interrupts = 0;
std::string_view words_of_watch;

void note_interrupt(int /*signal*/) {
  interrupts = 1;
  static_cast<void>(!::write(STDERR_FILENO, words_of_watch.data(), words_of_watch.size()));
}

void set_handler(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = handler == SIG_DFL ? 0 : static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
}

}  // namespace

InterruptWatch::InterruptWatch(std::string_view words) {
  interrupts = 0;
  words_of_watch = words;
  set_handler(&note_interrupt);
}

InterruptWatch::~InterruptWatch() { set_handler(SIG_DFL); }

bool InterruptWatch::was_asked_for() const { return interrupts != 0; }

}  // namespace volcal::cli
