#include "volcal/identify/text/decimal_text.h"

#include <cmath>
#include <cstdint>
#include <iterator>
#include <string_view>

namespace volcal {

void append_decimal(double value, int decimals, fmt::memory_buffer& text) {
  constexpr std::uint64_t kPowersOfTen[] = {1,      10,      100,      1000,      10000,
                                            100000, 1000000, 10000000, 100000000, 1000000000};
  constexpr double kLargest = 1e15;  // whole numbers below are exact
  const std::uint64_t power = kPowersOfTen[decimals];
  const double scaled = value * static_cast<double>(power);
  if (!(std::abs(scaled) < kLargest)) {
    fmt::format_to(std::back_inserter(text), "{:.9g}", value);
    return;
  }
  const auto whole = static_cast<std::uint64_t>(std::llround(std::abs(scaled)));
  if (scaled < 0.0 && whole > 0) text.push_back('-');
  const fmt::format_int before(whole / power);
  text.append(before.data(), before.data() + before.size());
  if (whole % power == 0) return;
  // A one in front keeps the zeros behind the point.
  const fmt::format_int behind(power + whole % power);
  std::string_view digits(behind.data() + 1, behind.size() - 1);
  digits = digits.substr(0, digits.find_last_not_of('0') + 1);
  text.push_back('.');
  text.append(digits.data(), digits.data() + digits.size());
}

}  // namespace volcal
