#pragma once
/// Plain numbers as bytes and back: doubles as they are, whole numbers in groups of seven bits (small counts
/// take one byte). For one machine and its like: little-endian IEEE 754.

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace volcal {

static_assert(std::endian::native == std::endian::little);

class StateWriter {
 public:
  void operator()(std::uint64_t value) {
    for (; value >= 0x80U; value >>= 7U) bytes_ += static_cast<char>(value | 0x80U);
    bytes_ += static_cast<char>(value);
  }
  void operator()(const Eigen::ArrayXd& values) {
    bytes_.append(reinterpret_cast<const char*>(values.data()),
                  static_cast<std::size_t>(values.size()) * sizeof(double));
  }
  void operator()(double value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void operator()(std::span<const std::uint32_t> values) {
    for (const std::uint32_t value : values) (*this)(std::uint64_t{value});
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Throws std::invalid_argument at the end of the bytes.
class StateReader {
 public:
  explicit StateReader(std::string_view bytes) : bytes_(bytes) {}

  void operator()(std::uint64_t& value) {
    value = 0;
    for (unsigned shift = 0;; shift += 7U) {
      require(1);
      const auto byte = static_cast<unsigned char>(bytes_.front());
      bytes_.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if (byte < 0x80U) return;
      if (shift > 56U) throw std::invalid_argument("a number is too long");
    }
  }
  void operator()(double& value) { copy(&value, sizeof value); }
  void operator()(Eigen::ArrayXd& values) {
    copy(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
  }
  void operator()(std::span<std::uint32_t> values) {
    for (std::uint32_t& value : values) {
      std::uint64_t wide = 0;
      (*this)(wide);
      if (wide > UINT32_MAX) throw std::invalid_argument("a count is too large");
      value = static_cast<std::uint32_t>(wide);
    }
  }
  bool at_end() const { return bytes_.empty(); }

 private:
  void require(std::size_t size) const {
    if (bytes_.size() < size) throw std::invalid_argument("the state ends too early");
  }
  void copy(void* to, std::size_t size) {
    require(size);
    std::memcpy(to, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }

  std::string_view bytes_;
};

}  // namespace volcal
