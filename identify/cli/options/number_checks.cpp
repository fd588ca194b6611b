#include "volcal/identify/cli/options/number_checks.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/text/text_file.h"

namespace volcal::cli {
namespace {

constexpr double kMost = 1e12;  // no count, length, time or seed of a campaign comes near it

CLI::Validator checked(const char* name, bool (*fits)(double), const char* rule, double most) {
  return {[fits, rule, most](std::string& text) -> std::string {
            double value = 0.0;
            if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value))
              return "\"" + text + "\" is not a number";
            if (!fits(value)) return text + " " + rule;
            return value <= most ? "" : text + " must be at most " + number_text(most);
          },
          name};
}

}  // namespace

CLI::Validator not_negative(double most) {
  return checked(
      "NONNEGATIVE", [](double value) { return value >= 0.0; }, "must not be negative", most);
}

CLI::Validator not_negative() { return not_negative(kMost); }

CLI::Validator positive(double most) {
  return checked(
      "POSITIVE", [](double value) { return value > 0.0; }, "must be positive", most);
}

CLI::Validator positive() { return positive(kMost); }

CLI::Validator one_of(std::span<const std::string_view> words) {
  return CLI::IsMember(std::vector<std::string>(words.begin(), words.end()));
}

CLI::Validator number_of_threads() { return not_negative(kMostThreads); }

}  // namespace volcal::cli
