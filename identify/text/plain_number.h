#pragma once
/// Numbers as instruments write them, "-363.096", "0.7390009": a sign, digits, a decimal sign, digits,
/// without an exponent. The value is the double nearest to the text, as every correct reader gives it.

#include <bit>
#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace volcal {
namespace detail {

inline constexpr int kWindow = 16;  ///< characters that are looked at together

/// Which of the characters are no digits, a bit each; beyond them a bit that is always set.
inline std::uint32_t places_of_others(const char* at) {
  constexpr std::uint32_t kEnd = 1U << kWindow;
#if defined(__SSE2__)
  const __m128i text = _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
  const __m128i nines_on_top = _mm_add_epi8(text, _mm_set1_epi8(127 - '9'));
  const int digits = _mm_movemask_epi8(_mm_cmpgt_epi8(nines_on_top, _mm_set1_epi8(127 - 10)));
  return (~static_cast<std::uint32_t>(digits) & (kEnd - 1)) | kEnd;
#else
  std::uint32_t others = kEnd;
  for (int i = 0; i < kWindow; ++i) others |= static_cast<std::uint32_t>(at[i] < '0' || at[i] > '9') << i;
  return others;
#endif
}

/// Value of 1 to 8 digits; eight characters are read.
inline double value_of_digits(const char* at, int count) {
  if constexpr (std::endian::native == std::endian::little) {
    std::uint64_t digits = 0;
    std::memcpy(&digits, at, sizeof digits);
    digits = (digits & 0x0F0F0F0F0F0F0F0F) << (8 * (8 - count));
    digits = digits * 10 + (digits >> 8);  // pairs, then fours, then eight
    const std::uint64_t pairs = 0x000000FF000000FF;
    digits = (digits & pairs) * 0x000F424000000064 + ((digits >> 16) & pairs) * 0x0000271000000001;
    return static_cast<double>(static_cast<std::int64_t>(digits >> 32));
  } else {
    std::int64_t value = 0;
    for (int i = 0; i < count; ++i) value = 10 * value + (at[i] - '0');
    return static_cast<double>(value);
  }
}

}  // namespace detail

/// End of the number at `at`, its value in `value`; null where the text is no number of this form, has more
/// than eight digits on a side of the decimal sign or fourteen in all, or stands within 18 characters of
/// `end`: read it with care then. What follows the number is the caller's to judge.
inline const char* read_plain_number(const char* at, const char* end, char decimal, double& value) {
  constexpr double kPowersOfTen[] = {1.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8};
  if (end - at < 2 + detail::kWindow) return nullptr;
  const bool negative = *at == '-';
  at += negative ? 1 : 0;
  std::uint32_t others = detail::places_of_others(at);
  const int whole = std::countr_zero(others);
  if (whole == 0 || whole > 8) return nullptr;
  double size = detail::value_of_digits(at, whole);
  at += whole;
  if (*at == decimal) {
    others &= others - 1;
    const int behind = std::countr_zero(others) - whole - 1;
    const bool ends_in_window = whole + 1 + behind < detail::kWindow;
    if (behind < 1 || behind > 8 || !ends_in_window) return nullptr;
    // All are whole numbers below 2^53, so that the quotient alone is rounded.
    const double power = kPowersOfTen[behind];
    size = (size * power + detail::value_of_digits(at + 1, behind)) / power;
    at += 1 + behind;
  }
  value = negative ? -size : size;
  return at;
}

}  // namespace volcal
