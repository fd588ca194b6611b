#pragma once
/// A number for content, the same on every machine: Fowler, Noll and Vo's hash, 64 bit, variant 1a.

#include <bit>
#include <cstdint>
#include <string_view>

namespace volcal {

class ContentHash {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte, value >>= 8U) add_byte(value & 0xFFU);
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(std::string_view text) {
    for (const char c : text) add_byte(static_cast<unsigned char>(c));
  }
  std::uint64_t value() const { return hash_; }

 private:
  void add_byte(std::uint64_t byte) { hash_ = (hash_ ^ byte) * 0x100000001B3U; }

  std::uint64_t hash_ = 0xCBF29CE484222325U;
};

}  // namespace volcal
