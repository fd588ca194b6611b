#include "volcal/identify/text/today.h"

#include <fmt/chrono.h>

#include <charconv>
#include <cstdlib>
#include <string_view>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr const char* kFixedTime = "SOURCE_DATE_EPOCH";
constexpr long long kLastTime = 253402300799;  // 9999-12-31T23:59:59Z

std::time_t fixed_time(std::string_view text) {
  long long seconds = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc() || end != text.data() + text.size() || seconds < 0 || seconds > kLastTime) {
    throw InputError(
        {}, std::string("the environment's ") + kFixedTime + " is not a time: \"" + std::string(text) + "\"",
        "set it to the seconds since 1970, or unset it");
  }
  return static_cast<std::time_t>(seconds);
}

}  // namespace

std::time_t present_time() {
  const char* fixed = std::getenv(kFixedTime);
  return fixed == nullptr ? std::time(nullptr) : fixed_time(fixed);
}

std::string present_time_text() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(present_time())); }

std::string today() {
  const std::time_t now = present_time();
  const bool is_fixed = std::getenv(kFixedTime) != nullptr;
  return fmt::format("{:%Y-%m-%d}", is_fixed ? fmt::gmtime(now) : fmt::localtime(now));
}

}  // namespace volcal
