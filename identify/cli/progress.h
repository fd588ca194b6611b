#pragma once
/// A progress bar on standard error for work over a second; nothing when it is not a terminal.

#include <chrono>
#include <string>

namespace volcal::cli {

class ProgressBar {
 public:
  explicit ProgressBar(std::string name);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(const std::string& stage, double done);
  void finish();

 private:
  std::string name_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace volcal::cli
