#include "volcal/identify/text/atomic_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;

constexpr const char* kList = ".volcal";
constexpr const char* kListOfEditable = ".volcal-init";

[[noreturn]] void fail(const std::string& path, const std::string& problem) {
  throw InputError({path, 0}, problem, "check the path, its permissions and the free space");
}

[[noreturn]] void fail_system(const std::string& path, const std::string& doing) {
  fail(path, doing + " failed: " + std::strerror(errno));
}

/// An open file descriptor.
class Descriptor {
 public:
  Descriptor(const std::string& path, int flags, int mode = 0)
      : number_(::open(path.c_str(), flags | O_CLOEXEC, mode)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  bool open() const { return number_ >= 0; }

 private:
  int number_;
};

/// Some file systems cannot flush a directory (EINVAL); that is no reason to refuse the result.
void flush(const std::string& path) {
  const Descriptor descriptor(path, O_RDONLY);
  if (!descriptor.open()) fail_system(path, "opening");
  if (::fsync(descriptor.number()) != 0 && errno != EINVAL && errno != EROFS) fail_system(path, "flushing");
}

void flush_tree(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file() || entry.is_directory()) flush(entry.path().string());
  }
  flush(folder.string());
}

/// A file that is made. `shown`: what messages call it.
class NewFile {
 public:
  NewFile(const std::string& path, std::string shown)
      : shown_(std::move(shown)), file_(path, O_WRONLY | O_CREAT | O_TRUNC, 0666) {
    if (!file_.open()) fail_system(shown_, "creating the file");
  }

  void append(std::string_view text) const {
    while (!text.empty()) {
      const auto count = ::write(file_.number(), text.data(), text.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail_system(shown_, "writing");
      text.remove_prefix(static_cast<std::size_t>(count));
    }
  }

 private:
  std::string shown_;
  Descriptor file_;
};

std::string temporary_prefix(const fs::path& target) { return "." + target.filename().string() + ".tmp-"; }

std::string backup_of(const fs::path& target) {
  return (target.parent_path() / ("." + target.filename().string() + ".previous")).string();
}

std::string fresh_name(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  return (target.parent_path() /
          (temporary_prefix(target) + std::to_string(::getpid()) + "-" + std::to_string(counter++)))
      .string();
}

/// Temporary folders are locked while their writer lives.
void remove_abandoned(const fs::path& target) {
  std::error_code error;
  const std::string prefix = temporary_prefix(target);
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(target.parent_path(), error)) {
    if (entry.path().filename().string().starts_with(prefix)) found.push_back(entry.path());
  }
  for (const fs::path& path : found) {
    const Descriptor folder(path.string(), O_RDONLY | O_DIRECTORY);
    if (folder.open() && ::flock(folder.number(), LOCK_EX | LOCK_NB) == 0) fs::remove_all(path, error);
  }
}

/// A run on a file system without exchange may have been killed between its two renames.
void repair(const fs::path& target) {
  std::error_code error;
  const fs::path backup = backup_of(target);
  if (!fs::exists(backup, error)) return;
  if (fs::exists(target, error)) {
    fs::remove_all(backup, error);
  } else {
    fs::rename(backup, target, error);
  }
}

/// FNV-1a of a file's bytes, or of the names and checksums in a folder.
std::uint64_t content_sum(const fs::path& path) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  const auto add = [&sum](std::string_view text) {
    for (const char c : text) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  };
  if (fs::is_directory(path)) {
    std::set<fs::path> entries;
    for (const auto& entry : fs::directory_iterator(path)) entries.insert(entry.path());
    for (const fs::path& entry : entries) {
      add(entry.filename().string());
      add(std::to_string(content_sum(entry)));
    }
    return sum;
  }
  std::ifstream file(path, std::ios::binary);
  std::vector<char> block(1 << 16);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0)
    add({block.data(), static_cast<std::size_t>(file.gcount())});
  return sum;
}

/// Names that a run wrote with their checksums; empty text: written by an older version.
std::map<std::string, std::string> listed(const fs::path& folder) {
  std::map<std::string, std::string> names;
  for (const char* name : {kList, kListOfEditable}) {
    std::ifstream list(folder / name);
    for (std::string line; std::getline(list, line);) {
      const std::size_t tab = line.find('\t');
      names[line.substr(0, tab)] = tab == std::string::npos ? "" : line.substr(tab + 1);
    }
  }
  return names;
}

void require_unedited(const fs::path& target) {
  for (const auto& [name, sum] : listed(target)) {
    const fs::path path = target / name;
    if (sum.empty() || !fs::exists(path) || std::to_string(content_sum(path)) == sum) continue;
    throw InputError({path.string(), 0}, "it has been edited since it was written, and would be overwritten",
                     "name another folder with -o, or overwrite it with --force");
  }
}

[[noreturn]] void refuse_foreign(const fs::path& target, Replaceable replaceable) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(target)) names.insert(entry.path().filename().string());
  names.erase(kListOfEditable);
  throw InputError({target.string(), 0},
                   "the output folder holds files that volcal did not write" +
                       (names.empty() ? "" : ", as " + printable(*names.begin())),
                   replaceable == Replaceable::Unedited
                       ? "name another folder with -o; --force overwrites files of the same names"
                       : "name another folder with -o, or empty this one");
}

void require_replaceable(const fs::path& target, Replaceable replaceable) {
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) {
    throw InputError({target.string(), 0}, "the output is to be a folder, but a file of this name exists",
                     "name another folder with -o");
  }
  const fs::path here = fs::current_path(error);
  for (fs::path above = here; !above.empty(); above = above.parent_path()) {
    if (above == target) {
      throw InputError({target.string(), 0}, "the output folder is the current directory or holds it",
                       "name a folder inside it, as in -o result");
    }
    if (above == above.parent_path()) break;
  }
  if (replaceable == Replaceable::Anything || fs::is_empty(target, error)) return;
  const bool ours = fs::exists(target / kList, error) ||
                    (replaceable == Replaceable::Unedited && fs::exists(target / kListOfEditable, error));
  if (!ours) refuse_foreign(target, replaceable);
  if (replaceable == Replaceable::Unedited) require_unedited(target);
}

fs::path absolute_target(const std::string& target) {
  std::error_code error;
  fs::path absolute = fs::weakly_canonical(fs::absolute(target, error), error);
  if (!absolute.has_filename()) absolute = absolute.parent_path();
  if (target.empty() || error || !absolute.has_filename()) fail(target, "the output path cannot be used");
  return absolute;
}

}  // namespace

void require_output_folder(const std::string& target, const std::vector<std::string>& inputs,
                           Replaceable replaceable) {
  const fs::path absolute = absolute_target(target);
  require_replaceable(absolute, replaceable);
  for (const std::string& input : inputs) {
    if (input.empty() || !fs::exists(absolute)) continue;
    const fs::path read = absolute_target(input);
    if (std::mismatch(absolute.begin(), absolute.end(), read.begin(), read.end()).first != absolute.end())
      continue;
    throw InputError({target, 0}, "the output folder holds " + input + ", which is read",
                     "name another folder with -o: this one is replaced as a whole");
  }
}

AtomicFolder::AtomicFolder(const std::string& target, Replaceable replaceable) {
  const fs::path absolute = absolute_target(target);
  target_ = absolute.string();
  std::error_code error;
  fs::create_directories(absolute.parent_path(), error);
  if (error) fail(absolute.parent_path().string(), "creating the folder failed: " + error.message());
  repair(absolute);
  require_replaceable(absolute, replaceable);
  remove_abandoned(absolute);
  create_temporary();
}

/// The lock tells other runs that the folder is in use; one of them may have removed it before it was locked.
void AtomicFolder::create_temporary() {
  for (int attempt = 0; attempt < 100; ++attempt) {
    temporary_ = fresh_name(target_);
    if (::mkdir(temporary_.c_str(), 0777) != 0) {
      if (errno == EEXIST) continue;
      fail_system(target_, "creating the folder");
    }
    known_temporary_ = TemporaryPath(temporary_);
    lock_ = ::open(temporary_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    struct stat status {};
    if (lock_ >= 0 && ::flock(lock_, LOCK_EX) == 0 && ::stat(temporary_.c_str(), &status) == 0) return;
    if (lock_ >= 0) ::close(lock_);
    lock_ = -1;
  }
  fail(target_, "creating a temporary folder beside it failed");
}

AtomicFolder::~AtomicFolder() {
  std::error_code error;
  if (!committed_ && !temporary_.empty()) fs::remove_all(temporary_, error);
  if (lock_ >= 0) ::close(lock_);
}

void AtomicFolder::write(const std::string& name, const std::string& content) const {
  NewFile(path(name), target_ + "/" + name).append(content);
}

void AtomicFolder::write(const TableFile& file) const {
  const NewFile written(path(file.name), target_ + "/" + file.name);
  written.append(file.content);
  if (file.further) file.further([&written](std::string_view text) { written.append(text); });
}

void AtomicFolder::carry_over_user_files() const {
  if (!fs::exists(target_)) return;
  const std::map<std::string, std::string> ours = listed(target_);
  for (const auto& entry : fs::directory_iterator(target_)) {
    const std::string name = entry.path().filename().string();
    if (name == kList || name == kListOfEditable || ours.contains(name) || fs::exists(path(name))) continue;
    fs::copy(entry.path(), path(name), fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  }
}

void AtomicFolder::write_list(const char* list) const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(temporary_))
    names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  std::string text;
  for (const std::string& name : names) text += name + "\t" + std::to_string(content_sum(path(name))) + "\n";
  NewFile(path(list), target_ + "/" + list).append(text);
}

void AtomicFolder::exchange() const {
  if (::rename(temporary_.c_str(), target_.c_str()) == 0) return;
  if (errno != ENOTEMPTY && errno != EEXIST) fail_system(target_, "renaming the result");
  if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS) fail_system(target_, "exchanging the result");
  const std::string backup = backup_of(target_);
  if (::rename(target_.c_str(), backup.c_str()) != 0) fail_system(target_, "setting the old result aside");
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
    const int reason = errno;
    if (::rename(backup.c_str(), target_.c_str()) != 0) fail_system(backup, "putting the old result back");
    errno = reason;
    fail_system(target_, "renaming the result");
  }
  std::error_code error;
  fs::remove_all(backup, error);
}

void AtomicFolder::commit() { put_in_place(kList); }

void AtomicFolder::commit_to_be_edited() { put_in_place(kListOfEditable); }

void AtomicFolder::put_in_place(const char* list) {
  try {
    write_list(list);
    carry_over_user_files();
    flush_tree(temporary_);
  } catch (const fs::filesystem_error& error) {
    fail(target_, std::string("completing the result failed: ") + error.code().message());
  }
  PuttingInPlace placing;
  exchange();
  committed_ = true;
  placing.done();
  std::error_code error;
  fs::remove_all(temporary_, error);
  flush(fs::path(target_).parent_path().string());
}

}  // namespace volcal
