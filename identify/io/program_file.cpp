#include "volcal/identify/io/program_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::size_t kChunk = 1 << 20;
constexpr std::size_t kLongestLine = 1 << 16;

}  // namespace

LineFile::LineFile(const std::string& path) : path_(path) {
  require_file(path);
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_)
    throw InputError({path, 0}, std::string("the file cannot be opened: ") + std::strerror(errno),
                     "check the permissions of the file");
  buffer_.resize(kChunk + kLongestLine);
}

/// Moves the rest to the front and reads on.
bool LineFile::refill() {
  if (at_end_) return false;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  if (end_ > kLongestLine)
    throw InputError({path_, 0}, "a line is longer than 64 KiB",
                     "is it an NC program? end its lines with LF or CRLF");
  const std::size_t count = std::fread(buffer_.data() + end_, 1, kChunk, file_.get());
  if (std::ferror(file_.get())) throw InputError({path_, 0}, "reading the file failed", "check the disk");
  const std::string_view read(buffer_.data() + end_, count);
  if (!begun_ && (read.starts_with("\xFF\xFE") || read.starts_with("\xFE\xFF")))
    throw InputError({path_, 0}, "the file is UTF-16 text", "save it again as plain text (ASCII or UTF-8)");
  if (std::memchr(buffer_.data() + end_, '\0', count) != nullptr)
    throw InputError({path_, 0}, "the file is binary (it holds NUL bytes)", "give the text of an NC program");
  end_ += count;
  at_end_ = count == 0;
  if (!begun_) skip_byte_order_mark();
  return !at_end_;
}

void LineFile::skip_byte_order_mark() {
  begun_ = true;
  const std::string_view text(buffer_.data(), end_);
  if (text.starts_with("\xEF\xBB\xBF")) begin_ = 3;
}

bool LineFile::next(std::string_view& line) {
  for (;;) {
    const char* const from = buffer_.data() + begin_;
    const auto* const stop = static_cast<const char*>(std::memchr(from, '\n', end_ - begin_));
    if (stop != nullptr || (at_end_ && begin_ < end_)) {
      const std::size_t size = stop != nullptr ? static_cast<std::size_t>(stop - from) + 1 : end_ - begin_;
      line = {from, size};
      begin_ += size;
      return true;
    }
    if (!refill() && begin_ == end_) return false;
  }
}

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  std::error_code error;
  if (std::filesystem::is_directory(path_, error))
    throw InputError({path_, 0}, "the output is a directory, a file is expected", "name a file with -o");
  temporary_ = path_ + ".part-" + std::to_string(::getpid());
  known_temporary_ = TemporaryPath(temporary_);
  file_ = std::fopen(temporary_.c_str(), "wb");
  if (file_ == nullptr) fail("creating the file");
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::error_code error;
  std::filesystem::remove(temporary_, error);
}

void AtomicFile::fail(const std::string& doing) const {
  throw InputError({path_, 0}, doing + " failed: " + std::strerror(errno),
                   "choose a folder that exists and is writable, and check the free space");
}

void AtomicFile::write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("writing");
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) fail("writing");
  PuttingInPlace placing;
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail("renaming");
  placing.done();
  std::fclose(file_);
  file_ = nullptr;
}

}  // namespace volcal
