#include "volcal/identify/io/exports/npz_archive.h"

#include <zip.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <stdexcept>
#include <string_view>

#include "volcal/identify/text/text_encoding.h"

namespace volcal {
namespace {

const std::string kByteOrder = std::endian::native == std::endian::little ? "<" : ">";
constexpr std::size_t kNpyAlignment = 64;
constexpr zip_uint16_t kFirstDosDate = (1 << 5) | 1;  // 1 January 1980

template <class Value>
std::span<const char> bytes_of(const Value* data, Eigen::Index count) {
  return {reinterpret_cast<const char*>(data), static_cast<std::size_t>(count) * sizeof(Value)};
}

std::string shape_of_list(std::size_t size) { return "(" + std::to_string(size) + ",)"; }

char32_t code_point(std::string_view character) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
  if (character.size() == 1) return byte(0);
  char32_t code = byte(0) & (0xFFU >> (character.size() + 1));
  for (std::size_t i = 1; i < character.size(); ++i) code = (code << 6U) | (byte(i) & 0x3FU);
  return code;
}

std::u32string utf32(std::string_view text) {
  std::u32string codes;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    codes += length == 0 ? U'\uFFFD' : code_point(text.substr(0, length));
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return codes;
}

[[noreturn]] void fail_to_zip(const char* reason) {
  throw std::runtime_error(std::string("the archive cannot be made: ") + reason);
}

/// A zip archive in memory.
class ZipInMemory {
 public:
  ZipInMemory() {
    zip_error_init(&error_);
    memory_ = zip_source_buffer_create(nullptr, 0, 0, &error_);
    if (memory_ == nullptr) fail_to_zip(zip_error_strerror(&error_));
    zip_source_keep(memory_);
    archive_ = zip_open_from_source(memory_, ZIP_TRUNCATE, &error_);
    if (archive_ != nullptr) return;
    zip_source_free(memory_);
    zip_source_free(memory_);
    fail_to_zip(zip_error_strerror(&error_));
  }
  ~ZipInMemory() {
    if (archive_ != nullptr) zip_discard(archive_);
    zip_source_free(memory_);
    zip_error_fini(&error_);
  }
  ZipInMemory(const ZipInMemory&) = delete;
  ZipInMemory& operator=(const ZipInMemory&) = delete;

  /// `content` must outlive close().
  void add(const std::string& name, const std::string& content) {
    zip_source_t* source = zip_source_buffer(archive_, content.data(), content.size(), 0);
    const zip_int64_t index =
        source == nullptr ? -1 : zip_file_add(archive_, name.c_str(), source, ZIP_FL_ENC_UTF_8);
    if (index < 0) {
      zip_source_free(source);
      fail_to_zip(zip_strerror(archive_));
    }
    const auto place = static_cast<zip_uint64_t>(index);
    if (zip_set_file_compression(archive_, place, ZIP_CM_STORE, 0) != 0 ||
        zip_file_set_dostime(archive_, place, 0, kFirstDosDate, 0) != 0)
      fail_to_zip(zip_strerror(archive_));
  }

  std::string close() {
    if (zip_close(archive_) != 0) fail_to_zip(zip_strerror(archive_));
    archive_ = nullptr;
    zip_stat_t facts;
    if (zip_source_stat(memory_, &facts) != 0 || zip_source_open(memory_) != 0)
      fail_to_zip(zip_error_strerror(zip_source_error(memory_)));
    std::string bytes(facts.size, '\0');
    const zip_int64_t read = zip_source_read(memory_, bytes.data(), bytes.size());
    zip_source_close(memory_);
    if (read != static_cast<zip_int64_t>(bytes.size())) fail_to_zip("it cannot be read back");
    return bytes;
  }

 private:
  zip_error_t error_{};
  zip_source_t* memory_ = nullptr;
  zip_t* archive_ = nullptr;
};

}  // namespace

void NpzArchive::add_array(const std::string& name, const std::string& type, const std::string& shape,
                           std::span<const char> data) {
  // Matrices are column by column, which is of no account to lists.
  std::string header = "{'descr': '" + type + "', 'fortran_order': True, 'shape': " + shape + ", }";
  constexpr std::size_t kPreamble = 10;
  header.append(kNpyAlignment - 1 - (kPreamble + header.size()) % kNpyAlignment, ' ');
  header += '\n';
  std::string content = "\x93NUMPY";
  content += '\x01';
  content += '\0';
  content += static_cast<char>(header.size() & 0xFFU);
  content += static_cast<char>(header.size() >> 8U);
  content += header;
  content.append(data.data(), data.size());
  files_.emplace_back(name + ".npy", std::move(content));
}

void NpzArchive::add(const std::string& name, const Eigen::VectorXd& values) {
  add_array(name, kByteOrder + "f8", shape_of_list(static_cast<std::size_t>(values.size())),
            bytes_of(values.data(), values.size()));
}

void NpzArchive::add(const std::string& name, const Eigen::MatrixXd& values) {
  add_array(name, kByteOrder + "f8",
            "(" + std::to_string(values.rows()) + ", " + std::to_string(values.cols()) + ")",
            bytes_of(values.data(), values.size()));
}

void NpzArchive::add(const std::string& name, const std::vector<std::int64_t>& values) {
  add_array(name, kByteOrder + "i8", shape_of_list(values.size()),
            bytes_of(values.data(), static_cast<Eigen::Index>(values.size())));
}

void NpzArchive::add(const std::string& name, const std::vector<bool>& values) {
  std::string flags;
  for (const bool value : values) flags += value ? '\x01' : '\0';
  add_array(name, "|b1", shape_of_list(values.size()), flags);
}

void NpzArchive::add(const std::string& name, const std::vector<std::string>& texts) {
  std::vector<std::u32string> codes;
  std::size_t longest = 1;
  for (const std::string& text : texts) {
    codes.push_back(utf32(text));
    longest = std::max(longest, codes.back().size());
  }
  std::u32string all;
  for (std::u32string& text : codes) {
    text.resize(longest, U'\0');
    all += text;
  }
  add_array(name, kByteOrder + "U" + std::to_string(longest), shape_of_list(texts.size()),
            bytes_of(all.data(), static_cast<Eigen::Index>(all.size())));
}

std::string NpzArchive::bytes() const {
  ZipInMemory archive;
  for (const auto& file : files_) archive.add(file.first, file.second);
  return archive.close();
}

}  // namespace volcal
