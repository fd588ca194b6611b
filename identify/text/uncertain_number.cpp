#include "volcal/identify/text/uncertain_number.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace volcal {
namespace {

constexpr int kMostDecimals = 9;

/// Of U rounded to two significant digits: 0.0996 is 0.10.
int decimals_for(double u) {
  const std::string rounded = fmt::format("{:.1e}", u);
  const int power = std::stoi(rounded.substr(rounded.find('e') + 1));
  return std::clamp(1 - power, 0, kMostDecimals);
}

}  // namespace

std::string value_with_u(double value, double u) {
  if (!std::isfinite(value) || !std::isfinite(u) || u <= 0.0)
    return fmt::format("{:.3g} +- {:.2g}", value, u);
  const int decimals = decimals_for(u);
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.front() == '-' && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return fmt::format("{} +- {:.{}f}", text, u, decimals);
}

}  // namespace volcal
