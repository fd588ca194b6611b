#include "volcal/identify/text/text_encoding.h"

#include <iconv.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

struct EncodingName {
  const char* name;   ///< of the key `encoding`
  const char* iconv;  ///< of the system's table
};

/// In the order of TextEncoding.
constexpr std::array<EncodingName, 10> kEncodings = {{{"utf-8", "UTF-8"},
                                                      {"latin1", "ISO-8859-1"},
                                                      {"cp1252", "WINDOWS-1252"},
                                                      {"cp1250", "WINDOWS-1250"},
                                                      {"cp1251", "WINDOWS-1251"},
                                                      {"cp437", "IBM437"},
                                                      {"cp850", "IBM850"},
                                                      {"cp932", "CP932"},
                                                      {"gbk", "GBK"},
                                                      {"utf-16", "UTF-16LE"}}};
constexpr std::string_view kReplacement = "\uFFFD";

const EncodingName& names_of(TextEncoding encoding) {
  return kEncodings.at(static_cast<std::size_t>(encoding));
}

/// A conversion of the system, closed at the end.
class Conversion {
 public:
  Conversion(const char* from, const char* name) : handle_(::iconv_open("UTF-8", from)) {
    if (handle_ != closed()) return;
    throw InputError({}, std::string("this system has no table of the encoding ") + name,
                     "save the file as UTF-8, or install the system's character sets (glibc: gconv modules)");
  }
  ~Conversion() { ::iconv_close(handle_); }
  Conversion(const Conversion&) = delete;
  Conversion& operator=(const Conversion&) = delete;

  /// Converts a piece of `rest`, which is shortened by it, into `out`; false where the next byte is unknown.
  bool convert(std::string_view& rest, std::string& out) {
    std::array<char, 4096> buffer{};
    char* from = const_cast<char*>(rest.data());  // iconv does not write there
    std::size_t left = rest.size();
    char* to = buffer.data();
    std::size_t room = buffer.size();
    const std::size_t status = ::iconv(handle_, &from, &left, &to, &room);
    const bool known = status != static_cast<std::size_t>(-1) || errno == E2BIG;
    out.append(buffer.data(), buffer.size() - room);
    rest.remove_prefix(rest.size() - left);
    return known;
  }

 private:
  static ::iconv_t closed() { return reinterpret_cast<::iconv_t>(-1); }  // as POSIX has it
  ::iconv_t handle_;
};

}  // namespace

const std::vector<std::string>& encoding_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const EncodingName& encoding : kEncodings) all.emplace_back(encoding.name);
    return all;
  }();
  return names;
}

std::optional<TextEncoding> encoding_of_name(std::string_view name) {
  const auto found = std::ranges::find(encoding_names(), name);
  if (found == encoding_names().end()) return std::nullopt;
  return static_cast<TextEncoding>(found - encoding_names().begin());
}

std::size_t utf8_length(std::string_view text) {
  if (text.empty()) return 0;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool surrogate = first == 0xED && byte(1) >= 0xA0;
  const bool beyond = first == 0xF4 && byte(1) >= 0x90;
  return overlong || surrogate || beyond ? 0 : length;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

bool is_control(std::string_view character) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
  if (character.size() == 1) return byte(0) < 0x20 || byte(0) == 0x7F;
  if (character.size() == 2) return byte(0) == 0xC2 && byte(1) < 0xA0;
  if (character.size() != 3 || byte(0) != 0xE2) return false;
  const bool format =
      byte(1) == 0x80 && ((byte(2) >= 0x8E && byte(2) <= 0x8F) || (byte(2) >= 0xA8 && byte(2) <= 0xAE));
  const bool isolate = byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9;
  return format || isolate;
}

bool holds_control(std::string_view text) {
  while (!text.empty()) {
    const std::string_view character = text.substr(0, std::max<std::size_t>(utf8_length(text), 1));
    if (is_control(character)) return true;
    text.remove_prefix(character.size());
  }
  return false;
}

DecodedText decode(std::string_view bytes, TextEncoding encoding) {
  const bool utf16 = encoding == TextEncoding::Utf16;
  const bool big_endian = utf16 && bytes.starts_with("\xFE\xFF");
  if (big_endian || (utf16 && bytes.starts_with("\xFF\xFE"))) bytes.remove_prefix(2);
  const EncodingName& names = names_of(encoding);
  Conversion conversion(big_endian ? "UTF-16BE" : names.iconv, names.name);
  DecodedText decoded;
  decoded.text.reserve(bytes.size() + bytes.size() / 16);
  while (!bytes.empty()) {
    if (conversion.convert(bytes, decoded.text) || bytes.empty()) continue;
    if (decoded.unknown_line == 0)
      decoded.unknown_line = 1 + static_cast<int>(std::ranges::count(decoded.text, '\n'));
    decoded.text += kReplacement;
    bytes.remove_prefix(std::min<std::size_t>(utf16 ? 2 : 1, bytes.size()));
  }
  return decoded;
}

std::string to_utf8(std::string_view text, TextEncoding encoding) {
  return encoding == TextEncoding::Utf8 ? std::string(text) : decode(text, encoding).text;
}

int line_not_utf8(std::string_view text) {
  int line = 1;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return line;
    if (text.front() == '\n') ++line;
    text.remove_prefix(length);
  }
  return 0;
}

TextEncoding likely_encoding(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) return TextEncoding::Utf16;
  for (const TextEncoding encoding : {TextEncoding::Cp1252, TextEncoding::Gbk, TextEncoding::Cp932}) {
    if (decode(bytes, encoding).unknown_line == 0) return encoding;
  }
  return TextEncoding::Latin1;
}

std::string encoding_remedy(std::string_view bytes, std::string_view before, std::string_view behind) {
  const TextEncoding likely = likely_encoding(bytes);
  std::string remedy(before);
  remedy += names_of(likely).name;
  remedy += behind;
  if (likely == TextEncoding::Cp1252) remedy += " (Windows, western Europe)";
  return remedy + "; or save the file as UTF-8";
}

}  // namespace volcal
