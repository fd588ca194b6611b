#pragma once
/// Files and folders that are being written under a temporary name. A program that gets a signal to end
/// removes them, so that nothing half-written stays behind.

#include <mutex>
#include <string>

namespace volcal {

/// Known as temporary while the object lives.
class TemporaryPath {
 public:
  TemporaryPath() = default;
  explicit TemporaryPath(std::string path);
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;
  TemporaryPath(TemporaryPath&& other) noexcept;
  TemporaryPath& operator=(TemporaryPath&& other) noexcept;

 private:
  void forget();
  std::string path_;
};

/// Held while something written is put in its place; counts it as written when it ends well.
class PuttingInPlace {
 public:
  PuttingInPlace();
  void done() { ++written_; }
  static int written() { return written_; }

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  static int written_;
};

/// Removes all temporary paths, and from then on lets nothing be put in place: a thread that wants to waits
/// for ever. For a program that ends. True when something had been put in its place before.
bool abandon_temporary_paths();

}  // namespace volcal
