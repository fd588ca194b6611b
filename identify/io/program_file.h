#pragma once
/// NC programs as files: lines in, lines out, in constant memory.

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/text/temporary_paths.h"

namespace volcal {

/// Lines of a text file of any size with their line ends.
class LineFile {
 public:
  /// Throws InputError when the file cannot be read.
  explicit LineFile(const std::string& path);

  /// The next line, valid until the next call; false at the end. Throws InputError for files that are no text
  /// of lines (NUL bytes, no line end within 64 KiB).
  bool next(std::string_view& line);

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  bool refill();
  void skip_byte_order_mark();

  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  bool at_end_ = false;
  bool begun_ = false;
};

/// A file written under a temporary name beside its target and renamed by commit(): a killed program leaves
/// the old file or the new one.
class AtomicFile {
 public:
  /// Throws InputError when nothing can be written there.
  explicit AtomicFile(std::string path);
  /// Removes what was written unless commit() was reached.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view text);
  /// Flushes to the disk and renames. Throws InputError.
  void commit();

 private:
  [[noreturn]] void fail(const std::string& doing) const;

  std::string path_;
  std::string temporary_;
  TemporaryPath known_temporary_;
  std::FILE* file_ = nullptr;
};

}  // namespace volcal
