#include "volcal/identify/report/values/posix_checksum.h"

#include <array>

namespace volcal::report {
namespace {

constexpr std::uint32_t kPolynomial = 0x04C11DB7U;  // of IEEE 802.3, most significant bit first

constexpr std::array<std::uint32_t, 256> remainders() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t rest = byte << 24U;
    for (int bit = 0; bit < 8; ++bit) rest = (rest << 1U) ^ ((rest >> 31U) * kPolynomial);
    table[byte] = rest;
  }
  return table;
}

constexpr std::array<std::uint32_t, 256> kRemainders = remainders();

std::uint32_t with_byte(std::uint32_t rest, std::uint32_t byte) {
  return (rest << 8U) ^ kRemainders[((rest >> 24U) ^ byte) & 0xFFU];
}

}  // namespace

std::uint32_t posix_checksum(std::string_view content) {
  std::uint32_t rest = 0;
  for (const char c : content) rest = with_byte(rest, static_cast<unsigned char>(c));
  for (std::size_t length = content.size(); length > 0; length >>= 8U)
    rest = with_byte(rest, static_cast<std::uint32_t>(length & 0xFFU));
  return ~rest;
}

}  // namespace volcal::report
