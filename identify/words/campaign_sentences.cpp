/// What is noticed while a campaign is read.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

constexpr double kDegreePerRadian = 180.0 / std::numbers::pi;

/// "direction_x" as it stands in a TOML text.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

std::string in_setup(const Finding& finding) {
  return fmt::format("setup \"{}\" ({}): ", finding.text("setup"), finding.text("file"));
}

std::string columns_unused(const Finding& finding) {
  const std::vector<std::string> columns = finding.texts("columns");
  std::string text =
      fmt::format("setup \"{}\": {} of {} {} not read", finding.text("setup"), join_names(columns),
                  finding.text("file"), columns.size() == 1 ? "is" : "are");
  const std::vector<std::string> keys = finding.texts("meant");
  const std::vector<std::string> sources = finding.texts("meant_columns");
  if (keys.size() != sources.size()) throw std::invalid_argument("meant columns without their names");
  if (keys.empty()) return text;
  std::string entries;
  for (std::size_t i = 0; i < keys.size(); ++i)
    entries += (i == 0 ? "" : ", ") + keys[i] + " = " + quoted(sources[i]);
  return text + fmt::format("; to read what is meant, add columns = {{ {} }}{}", entries,
                            finding.flag("milliseconds") ? " and scale = { time_s = 0.001 }" : "");
}

std::string rows_repeated(const Finding& finding) {
  return in_setup(finding) +
         fmt::format(
             "{} of {} rows repeat an earlier row in {}, line {} that of line {}: each counts as a "
             "measurement of its own; remove the copies{}",
             finding.count("repeats"), finding.count("rows"),
             finding.flag("at_other_times") ? "all but its time" : "every column", finding.count("line"),
             finding.count("first_line"),
             finding.flag("at_other_times") ? ", unless the readings were computed without noise" : "");
}

std::string against_direction(const Finding& finding) {
  const std::string& column = finding.text("column");
  return in_setup(finding) +
         fmt::format("{} of {} moves of {} go against {}: if its sign is reversed add scale = {{ {} = -1 }}",
                     finding.count("against"), finding.count("moves"), finding.text("axis"), column, column);
}

std::string times_far_apart(const Finding& finding) {
  constexpr double kDay_s = 86400.0;
  return in_setup(finding) + fmt::format(
                                 "its readings are {:.0f} s apart and span {:.1f} days: if the times are in "
                                 "milliseconds add scale = {{ time_s = 0.001 }}",
                                 finding.number("step").si, finding.number("span").si / kDay_s);
}

std::string moves_too_fast(const Finding& finding) {
  return in_setup(finding) + fmt::format(
                                 "by its times the machine moved at {:.0f} m/s between readings: are they in "
                                 "minutes, hours or days? add scale = {{ time_s = 60.0 }}, 3600.0 or 86400.0",
                                 finding.number("speed").si);
}

/// "c_deg reversed", "b_deg in radians"
std::string taken_otherwise(const std::string& column, double factor) {
  const bool radians = std::abs(factor) > 1.0;
  return column + (radians ? " in radians" : "") +
         (factor < 0.0 ? radians ? " and reversed" : " reversed" : "");
}

std::string angles_misread(const Finding& finding) {
  const std::vector<std::string> columns = finding.texts("columns");
  const std::vector<FindingNumber> factors = finding.numbers("factors");
  if (columns.size() != factors.size()) throw std::invalid_argument("columns without their factors");
  std::vector<std::string> taken, entries;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    taken.push_back(taken_otherwise(columns[i], factors[i].si));
    entries.push_back(fmt::format("{} = {:.12g}", columns[i], factors[i].si));
  }
  return in_setup(finding) +
         fmt::format(
             "its positions miss what the instrument allows by {:.1f} mm, with {} by {:.1f} mm: if so add "
             "scale = {{ {} }}",
             finding.number("miss").in_unit(), join_names(taken), finding.number("better").in_unit(),
             join_names(entries));
}

std::string positions_misread(const Finding& finding) {
  constexpr std::string_view kQuestion =
      "are its positions those of the machine's axes (a control with tool centre point motion shows others), "
      "is "
      "the tool the right one?";
  return in_setup(finding) +
         fmt::format(
             "with its tool the nominal tool point scatters by {:.4g} mm where it stands at one sphere: {}",
             finding.number("miss").in_unit(), kQuestion);
}

std::string angles_in_radians(const Finding& finding) {
  const std::vector<std::string> columns = finding.texts("columns");
  std::vector<std::string> entries;
  for (const std::string& column : columns)
    entries.push_back(fmt::format("{} = {:.12g}", column, kDegreePerRadian));
  return in_setup(finding) + fmt::format(
                                 "{} {} values that are not round in degrees but are whole degrees if {} in "
                                 "radians: if so add scale = {{ {} }}",
                                 join_names(columns), columns.size() == 1 ? "holds" : "hold",
                                 columns.size() == 1 ? "it is" : "they are", join_names(entries));
}

std::string misread(const Finding& finding) {
  std::vector<std::string> setups, entries;
  for (const std::string& setup : finding.texts("setups")) setups.push_back('"' + setup + '"');
  const std::vector<std::string> columns = finding.texts("columns");
  const double factor = finding.number("factor").si;
  for (const std::string& column : columns) entries.push_back(fmt::format("{} = {:.6g}", column, factor));
  const bool one = setups.size() == 1;
  return fmt::format(
      "{} {}: the other readings expect {} {} {}: if so add scale = {{ {} }}", one ? "setup" : "setups",
      join_names(setups), one ? "its" : "their", join_names(columns),
      factor < 0.0 ? std::string("with the opposite sign") : fmt::format("{:.4g} times as large", factor),
      join_names(entries));
}

std::string duplicated(const Finding& finding) {
  return fmt::format("setups \"{}\" and \"{}\" hold the same readings: they count twice; remove one of them",
                     finding.text("first_setup"), finding.text("setup"));
}

std::string directions_derived(const Finding& finding) {
  return fmt::format(
      "directions of approach that the files do not record ({} in {}) follow from the order of the readings "
      "along each line; if they do not stand in the order in which they were measured, set directions = "
      "\"as-recorded\"",
      join_names(finding.texts("columns")), join_names(finding.texts("setups")));
}

std::string half_turns(const Finding& finding) {
  const std::int64_t readings = finding.count("readings");
  return fmt::format(
      "half a turn of {} goes either way: the direction of approach of {} {} after it in {} is not known; "
      "add "
      "the column {}",
      finding.text("axis"), readings, readings == 1 ? "reading" : "readings",
      join_names(finding.texts("setups")), finding.text("column"));
}

std::string centre_assumed(const Finding& finding) {
  const std::vector<std::string>& axes = finding.texts("axes");
  const bool several = axes.size() > 1;
  return fmt::format(
      "the machine file does not say where the {} of {} {}: {} through the machine's origin; state a point "
      "of "
      "{}, centre_mm below [axes.{}]",
      several ? "lines" : "line", join_names(axes), several ? "are" : "is",
      several ? "they are taken to pass" : "it is taken to pass", several ? "each" : "it", axes.front());
}

std::string left_out(const Finding& finding) {
  const std::vector<std::int64_t> rows = finding.counts("rows");
  return fmt::format("setup \"{}\" leaves out {} {}: {}", finding.text("setup"),
                     rows.size() == 1 ? "row" : "rows", fmt::join(rows, ", "), finding.text("reason"));
}

}  // namespace

std::span<const SentenceMaker> campaign_sentences() {
  static constexpr auto kSentences = std::to_array<SentenceMaker>({
      {FindingCode::ReadingsColumnsUnused, columns_unused},
      {FindingCode::ReadingsRowsRepeated, rows_repeated},
      {FindingCode::ReadingsAgainstDirection, against_direction},
      {FindingCode::ReadingsTimesFarApart, times_far_apart},
      {FindingCode::ReadingsMovesTooFast, moves_too_fast},
      {FindingCode::ReadingsAnglesMisread, angles_misread},
      {FindingCode::ReadingsPositionsMisread, positions_misread},
      {FindingCode::ReadingsAnglesInRadians, angles_in_radians},
      {FindingCode::ReadingsMisread, misread},
      {FindingCode::ReadingsDuplicated, duplicated},
      {FindingCode::ReadingsDirectionsDerived, directions_derived},
      {FindingCode::ReadingsHalfTurns, half_turns},
      {FindingCode::MachineCentreAssumed, centre_assumed},
      {FindingCode::ReadingsLeftOut, left_out},
  });
  return kSentences;
}

}  // namespace volcal
