#include "volcal/identify/text/text_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <system_error>
#include <vector>

#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/temporary_paths.h"
#include "volcal/identify/text/text_encoding.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;

/// Where an error about a file as a whole is reported.
SourcePlace place_of(const std::string& path, const SourcePlace& named_at) {
  return named_at.file.empty() ? SourcePlace{path, 0} : named_at;
}

std::string read_all(const std::string& path, const SourcePlace& place) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file) {
    throw InputError(place, "cannot open " + path + ": " + std::strerror(errno),
                     "check the permissions of the file");
  }
  std::error_code error;
  const auto expected = fs::file_size(path, error);
  std::string text;
  text.resize(error ? 0 : expected);
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  std::vector<char> rest(1 << 16);
  while (const std::size_t count = std::fread(rest.data(), 1, rest.size(), file.get())) {
    text.append(rest.data(), count);
  }
  if (std::ferror(file.get())) throw InputError(place, "reading " + path + " failed", "check the disk");
  return text;
}

/// A text of lines, without its byte order mark, that is more than blanks.
std::string checked_text(std::string text, const std::string& file) {
  require_text(text, file);
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    throw InputError({file, 0}, "the file is empty", "export it again or name another file");
  }
  return text;
}

}  // namespace

void require_text(const std::string& text, const std::string& file) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    throw InputError(
        {file, 1}, "the file is UTF-16 text",
        "save it again as UTF-8 or plain CSV; of readings encoding = \"utf-16\" in their setup does");
  }
  if (const auto zero = text.find('\0'); zero != std::string::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(zero), '\n');
    throw InputError({file, static_cast<int>(line)}, "the file is binary (it holds NUL bytes)",
                     "give the text file that the instrument exports");
  }
  if (text.find('\n') == std::string::npos && text.find_last_not_of('\r') > text.find('\r')) {
    throw InputError({file, 1}, "its lines end in CR alone, as on old Macintoshes",
                     "save it again with line ends LF or CRLF");
  }
}

void require_file(const std::string& path, const SourcePlace& named_at) {
  const SourcePlace place = place_of(path, named_at);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    if (named_at.file.empty()) {
      throw InputError(place, "the file does not exist",
                       missing_remedy(path, "give its path; it is relative to the folder you are in"));
    }
    throw InputError(place, "file does not exist: " + printable(path),
                     missing_remedy(path, "paths inside a file are relative to that file"));
  }
  if (fs::is_directory(status)) {
    throw InputError(place, path + " is a directory, a file is expected", "name the file inside it");
  }
  if (!fs::is_regular_file(status)) {
    const char* const kind = fs::is_fifo(status) ? "pipe" : fs::is_socket(status) ? "socket" : "device";
    throw InputError(place, path + " is a " + kind + ", a file is expected",
                     "save what it gives to a file first, and name that");
  }
}

std::string read_text_file(const std::string& path, const SourcePlace& named_at) {
  return read_text_file(path, FileEncoding{}, named_at);
}

std::string read_text_file(const std::string& path, const FileEncoding& encoding,
                           const SourcePlace& named_at) {
  require_file(path, named_at);
  std::string text = read_all(path, place_of(path, named_at));
  if (encoding.encoding != TextEncoding::Utf8 && !(encoding.only_if_not_utf8 && is_utf8(text)))
    text = to_utf8(text, encoding.encoding);
  return checked_text(std::move(text), path);
}

std::string foreign_text(const std::string& bytes, const std::string& file,
                         std::optional<TextEncoding> encoding, const std::string& option) {
  if (!encoding && (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")))
    encoding = TextEncoding::Utf16;
  if (!encoding || *encoding == TextEncoding::Utf8) {
    if (const int line = line_not_utf8(bytes); line > 0)
      throw InputError({file, line}, "the file is not UTF-8 text", encoding_remedy(bytes, option, ""));
    return checked_text(bytes, file);
  }
  DecodedText decoded = decode(bytes, *encoding);
  if (decoded.unknown_line > 0)
    throw InputError({file, decoded.unknown_line}, "a byte here is not a character of the encoding named",
                     encoding_remedy(bytes, option, ""));
  return checked_text(std::move(decoded.text), file);
}

std::string read_foreign_text(const std::string& path, std::optional<TextEncoding> encoding,
                              const std::string& option) {
  require_file(path);
  return foreign_text(read_all(path, {path, 0}), path, encoding, option);
}

std::string missing_remedy(const std::string& path, const std::string& otherwise) {
  std::error_code error;
  fs::path missing(path);
  if (!missing.has_filename()) missing = missing.parent_path();
  const fs::path folder = missing.has_parent_path() ? missing.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) return "the folder " + folder.string() + " does not exist either";
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::ranges::sort(names);
  const auto near = nearest_name(missing.filename().string(), names);
  return near ? "did you mean \"" + *near + "\"?" : otherwise;
}

std::string resolve_path(const std::string& from, const std::string& file) {
  const fs::path path(file);
  if (path.is_absolute()) return path.lexically_normal().string();
  return (fs::path(from).parent_path() / path).lexically_normal().string();
}

std::string printable(const std::string& text) {
  constexpr std::size_t kLongest = 60;
  std::string shown;
  std::string_view rest = text;
  while (!rest.empty() && shown.size() < kLongest) {
    const std::size_t length = utf8_length(rest);
    const std::string_view character = rest.substr(0, std::max<std::size_t>(length, 1));
    shown += length == 0 || is_control(character) ? std::string_view("?") : character;
    rest.remove_prefix(character.size());
  }
  if (!rest.empty()) shown += "...";
  return shown;
}

void write_text_file(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".part";
  const TemporaryPath known(temporary);
  std::ofstream file(temporary, std::ios::binary);
  file << text;
  file.close();
  std::error_code failure, ignored;
  PuttingInPlace placing;
  if (file) std::filesystem::rename(temporary, path, failure);
  if (!file || failure) {
    std::filesystem::remove(temporary, ignored);
    throw InputError({path, 0}, "the file cannot be written",
                     "choose a folder that exists and is writable, and check the free space");
  }
  placing.done();
}

bool same_file(const std::string& one, const std::string& other) {
  std::error_code error;
  return std::filesystem::equivalent(one, other, error) && !error;
}

std::string number_text(double value, int digits) { return fmt::format("{:.{}g}", value, digits); }

}  // namespace volcal
