#include "own_format.h"

#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/text/table_text.h"
#include "volcal/model/description/units.h"

namespace {

constexpr int kSteps = 50;

std::string file_of(volcal::AxisName axis) { return std::string(1, volcal::letter_of(axis)) + ".lines"; }

/// "position_mm correction_um" per line, mean of both directions.
std::vector<volcal::TableFile> write_lines(const volcal::FitResult& result,
                                           const volcal::TableFormatOptions& options) {
  const volcal::Compensation ideal = volcal::ideal_compensation(result, options);
  std::vector<volcal::TableFile> files;
  for (const volcal::AxisName name : result.machine.main_linear_axes()) {
    const volcal::Axis& axis = result.machine.axis(name);
    std::ostringstream text;
    text << std::setprecision(12);
    for (int i = 0; i <= kSteps; ++i) {
      const double q = axis.travel_min + axis.travel() * i / kSteps;
      text << q / volcal::kMetrePerMillimetre << ' '
           << ideal.along_axis(name, q, 0)[volcal::direction_of(name)] / volcal::kMicro << '\n';
    }
    files.push_back({file_of(name), text.str()});
  }
  return files;
}

volcal::AxisTable read_table(volcal::AxisName axis, const volcal::TableFile& file) {
  volcal::AxisTable table;
  table.input = axis;
  volcal::TableLines lines(file);
  while (lines.advance_to_content()) {
    const std::vector<std::string_view> words = volcal::words_of(lines.current());
    if (words.size() != 2) lines.fail("a line is a position and a correction", "write 10.0 -1.5");
    const double q = lines.number(words[0], "position") * volcal::kMetrePerMillimetre;
    volcal::require_ascending(table.position, q, lines.place());
    table.position.push_back(q);
    table.forward.push_back(lines.number(words[1], "correction") * volcal::kMicro);
  }
  if (table.position.size() < 2) lines.fail("the table is too short", "give two positions or more");
  table.backward = table.forward;
  return table;
}

volcal::CompensationTables read_lines(std::span<const volcal::TableFile> files) {
  volcal::CompensationTables tables;
  for (const volcal::AxisName axis : volcal::kLinearAxes) {
    if (const volcal::TableFile* file = volcal::find_file(files, file_of(axis)))
      tables.terms.push_back(volcal::axis_term(axis, read_table(axis, *file)));
  }
  return tables;
}

}  // namespace

std::unique_ptr<const volcal::TableFormat> lines_format() {
  return std::make_unique<volcal::TableFormat>(
      volcal::TableFormat{.name = "lines",
                          .summary = "one file per linear axis: position in mm, correction in um",
                          .source = "this example",
                          .verified = "read back by this example",
                          .supported = volcal::CompensationPart::Positioning,
                          .refusal = "a line holds the correction of its own axis",
                          .limits = {.points_per_table = kSteps + 1, .equidistant = true},
                          .settings = {},
                          .write = write_lines,
                          .read = read_lines});
}
