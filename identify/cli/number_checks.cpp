#include "volcal/identify/cli/number_checks.h"

#include <cmath>
#include <string>

namespace volcal::cli {
namespace {

CLI::Validator checked(const char* name, bool (*fits)(double), const char* rule) {
  return {[fits, rule](std::string& text) -> std::string {
            double value = 0.0;
            if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value))
              return "\"" + text + "\" is not a number";
            return fits(value) ? "" : text + " " + rule;
          },
          name};
}

}  // namespace

CLI::Validator not_negative() {
  return checked(
      "NONNEGATIVE", [](double value) { return value >= 0.0; }, "must not be negative");
}

CLI::Validator positive() {
  return checked(
      "POSITIVE", [](double value) { return value > 0.0; }, "must be positive");
}

}  // namespace volcal::cli
