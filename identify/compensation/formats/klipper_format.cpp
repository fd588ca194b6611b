#include <fmt/format.h>

#include <map>

#include "volcal/identify/compensation/skew_factors.h"

namespace volcal {
namespace {

constexpr std::string_view kKlipperFile = "skew_correction.cfg";

std::vector<TableFile> write_klipper(const FitResult& result, const TableFormatOptions& options) {
  const SkewFactors factors = skew_factors(result, options);
  return {{std::string(kKlipperFile),
           fmt::format("[skew_correction]\n\n[skew_correction volcal]\nxy_skew = {:.12g}\nxz_skew = {:.12g}\n"
                       "yz_skew = {:.12g}\n",
                       factors.xy, factors.xz, factors.yz)}};
}

CompensationTables read_klipper(std::span<const TableFile> files) {
  TableLines lines(file_named(files, kKlipperFile));
  std::map<std::string, double> factors;
  bool in_profile = false;
  while (lines.advance_to_content()) {
    const std::string_view line = trimmed_text(lines.current());
    if (line.front() == '#' || line.front() == ';') continue;
    if (line.front() == '[') {
      in_profile = line.starts_with("[skew_correction ");
      continue;
    }
    const auto stop = line.find_first_of("=:");
    if (stop == std::string_view::npos) lines.fail("the line is not key = value", "write xy_skew = 0.0001");
    const std::string key(trimmed_text(line.substr(0, stop)));
    if (!in_profile || (key != "xy_skew" && key != "xz_skew" && key != "yz_skew"))
      lines.fail("key " + key.substr(0, 40) + " is not one of a profile",
                 "write xy_skew, xz_skew and yz_skew under [skew_correction NAME]");
    if (!factors.emplace(key, lines.number(line.substr(stop + 1), key)).second)
      lines.fail(key + " is given twice", "keep one profile in the file");
  }
  if (factors.size() != 3)
    lines.fail("a profile needs xy_skew, xz_skew and yz_skew", "add what is missing; 0 = no correction");
  return skew_tables({factors["xy_skew"], factors["xz_skew"], factors["yz_skew"]});
}

}  // namespace

const TableFormat& klipper_format() {
  static const TableFormat format = {
      .name = "klipper",
      .summary = "Klipper skew profile: skew_correction.cfg to include in printer.cfg",
      .source = "Klipper, skew_correction.py (calc_skew, [skew_correction NAME]) and docs/Skew_Correction.md",
      .verified = "read back by volcal with the equation of Klipper's source; not tried on a printer",
      .supported = CompensationPart::Squareness,
      .refusal = kSkewRefusal,
      .limits = {.sampled = false},
      .settings = {},
      .write = write_klipper,
      .read = read_klipper};
  return format;
}

}  // namespace volcal
