#include "volcal/identify/text/temporary_paths.h"

#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

namespace volcal {
namespace {

std::recursive_mutex& placing() {
  static auto* const mutex = new std::recursive_mutex;  // outlives the threads that wait for it
  return *mutex;
}

std::mutex& guard_of_paths() {
  static auto* const mutex = new std::mutex;
  return *mutex;
}

std::multiset<std::string>& temporary_paths() {
  static auto* const paths = new std::multiset<std::string>;
  return *paths;
}

}  // namespace

int PuttingInPlace::written_ = 0;

PuttingInPlace::PuttingInPlace() : lock_(placing()) {}

TemporaryPath::TemporaryPath(std::string path) : path_(std::move(path)) {
  const std::lock_guard lock(guard_of_paths());
  temporary_paths().insert(path_);
}

TemporaryPath::TemporaryPath(TemporaryPath&& other) noexcept : path_(std::exchange(other.path_, {})) {}

TemporaryPath& TemporaryPath::operator=(TemporaryPath&& other) noexcept {
  if (this == &other) return *this;
  forget();
  path_ = std::exchange(other.path_, {});
  return *this;
}

TemporaryPath::~TemporaryPath() { forget(); }

void TemporaryPath::forget() {
  if (path_.empty()) return;
  const std::lock_guard lock(guard_of_paths());
  const auto found = temporary_paths().find(path_);
  if (found != temporary_paths().end()) temporary_paths().erase(found);
  path_.clear();
}

bool abandon_temporary_paths() {
  placing().lock();  // for good
  const std::lock_guard lock(guard_of_paths());
  std::error_code error;
  for (const std::string& path : temporary_paths()) std::filesystem::remove_all(path, error);
  return PuttingInPlace::written() > 0;
}

}  // namespace volcal
