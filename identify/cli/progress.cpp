#include "volcal/identify/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "volcal/identify/cli/process.h"

namespace volcal::cli {
namespace {

constexpr int kWidth = 30;
constexpr double kPatience = 1.0;  // s

}  // namespace

ProgressBar::ProgressBar(std::string name)
    : name_(std::move(name)),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {
  set_current_work(name_);
}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::update(const std::string& stage, double done) {
  set_current_work(name_ + ": " + stage);
  if (!terminal_) return;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (seconds < kPatience && !drawn_) return;
  drawn_ = true;
  const int filled = static_cast<int>(done * kWidth);
  fmt::print(stderr, "\r{} [{:=<{}}{: <{}}] {:3.0f} %  {}\033[K", name_, "", filled, "", kWidth - filled,
             done * 100.0, stage);
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
  drawn_ = false;
}

}  // namespace volcal::cli
