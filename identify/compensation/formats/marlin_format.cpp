#include <fmt/format.h>

#include <cmath>

#include "volcal/identify/compensation/skew_factors.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::string_view kMarlinFile = "skew.gcode";
constexpr double kLargestFactor = 1.0;  ///< SKEW_FACTOR_MIN, SKEW_FACTOR_MAX

std::vector<TableFile> write_marlin(const FitResult& result, const TableFormatOptions& options) {
  const SkewFactors factors = skew_factors(result, options);
  return {{std::string(kMarlinFile), fmt::format("G21\nM852 I{:.9f} J{:.9f} K{:.9f}\nM500\n",
                                                 factors.xy + 0.0, factors.xz + 0.0, factors.yz + 0.0)}};
}

/// Marlin keeps factors in single precision.
double factor_in(const TableLines& lines, std::string_view word) {
  const double value = lines.number(word.substr(1), "the factor");
  if (std::abs(value) > kLargestFactor)
    lines.fail("the factor is beyond +-1, which Marlin refuses", "check the squareness; factors are radians");
  return static_cast<double>(static_cast<float>(value));
}

SkewFactors factors_in(const TableLines& lines, std::span<const std::string_view> words) {
  SkewFactors factors;
  for (const std::string_view word : words) {
    switch (word.front()) {
      case 'I':
      case 'S':
        factors.xy = factor_in(lines, word);
        break;
      case 'J':
        factors.xz = factor_in(lines, word);
        break;
      case 'K':
        factors.yz = factor_in(lines, word);
        break;
      default:
        lines.fail("M852 has no such word", "write I (XY), J (XZ) and K (YZ)");
    }
  }
  return factors;
}

CompensationTables read_marlin(std::span<const TableFile> files) {
  TableLines lines(file_named(files, kMarlinFile));
  bool millimetres = false;
  std::optional<SkewFactors> factors;
  while (lines.advance_to_content()) {
    const std::string_view line = trimmed_text(lines.current());
    const auto words = words_of(line.substr(0, line.find(';')));
    if (words.empty() || words[0] == "M500") continue;
    if (words[0] == "G21") {
      millimetres = true;
    } else if (words[0] == "M852") {
      if (!millimetres)
        lines.fail("M852 stands before G21", "write G21 above it: in inch mode Marlin multiplies by 25.4");
      factors = factors_in(lines, std::span(words).subspan(1));
    } else {
      lines.fail("the line is neither G21, M852 nor M500", "leave other commands out of this file");
    }
  }
  if (!factors) lines.fail("there is no M852", "write M852 I... J... K...");
  return skew_tables(*factors);
}

}  // namespace

const TableFormat& marlin_format() {
  static const TableFormat format = {
      .name = "marlin",
      .summary = "Marlin skew factors: skew.gcode with M852 and M500",
      .source = "Marlin, M852.cpp and planner.h (skew()), SKEW_CORRECTION_GCODE and SKEW_CORRECTION_FOR_Z",
      .verified = "read back by volcal with the equation of Marlin's source; not tried on a printer",
      .supported = CompensationPart::Squareness,
      .refusal = kSkewRefusal,
      .limits = {.sampled = false},
      .settings = {},
      .write = write_marlin,
      .read = read_marlin};
  return format;
}

}  // namespace volcal
