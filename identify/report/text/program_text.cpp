#include "volcal/identify/report/text/program_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

std::string point_text(const Eigen::Vector3d& point) {
  const Eigen::Vector3d mm = (point / kMetrePerMillimetre).array() + 0.0;  // no negative zero
  return fmt::format("X{:.7g} Y{:.7g} Z{:.7g}", mm.x(), mm.y(), mm.z());
}

nlohmann::ordered_json point_json(const Eigen::Vector3d& point) {
  return {point.x() / kMetrePerMillimetre, point.y() / kMetrePerMillimetre, point.z() / kMetrePerMillimetre};
}

void add_errors(const std::string& name, const PathErrors& errors, TextTable& table) {
  table.add_row({name, fixed_number(errors.rms / kMicro, 2), fixed_number(errors.max / kMicro, 2),
                 count_number(errors.line_of_max), point_text(errors.place_of_max),
                 fixed_number(errors.feed_time, 1)});
}

nlohmann::ordered_json errors_json(const PathErrors& errors) {
  nlohmann::ordered_json json = {{"rms_um", errors.rms / kMicro},
                                 {"max_um", errors.max / kMicro},
                                 {"line_of_max", errors.line_of_max},
                                 {"place_of_max_mm", point_json(errors.place_of_max)}};
  // NaN, where a feed per turn has no spindle speed, becomes null.
  json["feed_time_s"] = errors.feed_time;
  return json;
}

}  // namespace

std::string program_summary_text(const NcRewriteSummary& summary) {
  std::string text = fmt::format(
      "{} lines in, {} out: {} motions, {} of them arcs; {} lines were split; largest correction {:.1f} um\n",
      count_number(summary.lines_read), count_number(summary.lines_written), count_number(summary.motions),
      count_number(summary.arcs), count_number(summary.split_lines), summary.largest_correction / kMicro);
  for (const Eigen::Vector3d& point : summary.functional_points)
    text += fmt::format("Functional point {} mm from the spindle reference\n", point_text(point));
  if (summary.clamped > 0)
    text += fmt::format("! {} rapids end at the limit of the travel: their correction would leave it\n",
                        count_number(summary.clamped));
  if (summary.beyond_readings > 0)
    text += fmt::format(
        "! {} motions, the first in line {}, end beyond the measured positions: the last measured error is "
        "held\n",
        count_number(summary.beyond_readings), count_number(summary.first_beyond));
  return text;
}

std::string program_check_text(const ProgramCheck& check) {
  TextTable table({{"", Align::Left},
                   {"RMS [um]"},
                   {"max [um]"},
                   {"in line"},
                   {"at [mm], machine coordinates", Align::Left},
                   {"feed time [s]"}},
                  fmt::format("Error of the tool point along {:.1f} mm of feed motion",
                              check.length / kMetrePerMillimetre));
  add_errors("as programmed", check.before, table);
  add_errors("rewritten", check.after, table);
  return table.text();
}

nlohmann::ordered_json program_json(const NcRewriteSummary& summary,
                                    const std::optional<ProgramCheck>& check) {
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const Eigen::Vector3d& point : summary.functional_points) points.push_back(point_json(point));
  nlohmann::ordered_json json = {{"lines_read", summary.lines_read},
                                 {"lines_written", summary.lines_written},
                                 {"motions", summary.motions},
                                 {"arcs", summary.arcs},
                                 {"split_lines", summary.split_lines},
                                 {"rapids_at_travel_limit", summary.clamped},
                                 {"largest_correction_um", summary.largest_correction / kMicro},
                                 {"functional_points_mm", points}};
  if (check) {
    json["check"] = {{"feed_length_mm", check->length / kMetrePerMillimetre},
                     {"before", errors_json(check->before)},
                     {"after", errors_json(check->after)}};
  }
  return json;
}

}  // namespace volcal
