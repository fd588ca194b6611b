#include "volcal/identify/cli/interrupt_watch.h"

#include <signal.h>  // NOLINT(modernize-deprecated-headers): sigaction() is POSIX
#include <unistd.h>

#include <string_view>

namespace volcal::cli {
namespace {

volatile sig_atomic_t interrupts = 0;

void note_interrupt(int /*signal*/) {
  constexpr std::string_view kWords = "\nending after this block of draws; Ctrl-C again ends at once\n";
  interrupts = 1;
  static_cast<void>(!::write(STDERR_FILENO, kWords.data(), kWords.size()));
}

void set_handler(void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = handler == SIG_DFL ? 0 : static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
}

}  // namespace

InterruptWatch::InterruptWatch() {
  interrupts = 0;
  set_handler(&note_interrupt);
}

InterruptWatch::~InterruptWatch() { set_handler(SIG_DFL); }

bool InterruptWatch::was_asked_for() const { return interrupts != 0; }

}  // namespace volcal::cli
