#include "volcal/identify/report/text/program_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/words/finding_json.h"
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

namespace {

void add_tcp_errors(const std::string& name, const TcpErrors& errors, TextTable& table) {
  table.add_row({name, fixed_number(errors.rms / kMicro, 2), fixed_number(errors.max / kMicro, 2),
                 count_number(errors.line_of_max), fixed_number(errors.axis_rms / kMicro, 1),
                 fixed_number(errors.axis_max / kMicro, 1)});
}

nlohmann::ordered_json tcp_errors_json(const TcpErrors& errors) {
  return {{"rms_um", errors.rms / kMicro},
          {"max_um", errors.max / kMicro},
          {"line_of_max", errors.line_of_max},
          {"axis_rms_urad", errors.axis_rms / kMicro},
          {"axis_max_urad", errors.axis_max / kMicro}};
}

std::vector<std::string> letters_of(const std::set<AxisName>& axes) {
  std::vector<std::string> letters;
  for (const AxisName axis : axes) letters.emplace_back(1, letter_of(axis));
  return letters;
}

}  // namespace

std::string tcp_summary_text(const TcpSummary& summary, const std::optional<TcpProgramCheck>& check) {
  std::string text = fmt::format(
      "{} lines in, {} out: {} motions with tool centre point motion; {} lines were split; largest "
      "correction "
      "{:.1f} um, of a rotary axis {:.1f} urad\n",
      count_number(summary.lines_read), count_number(summary.lines_written), count_number(summary.motions),
      count_number(summary.split_lines), summary.largest_correction / kMicro, summary.largest_turn / kMicro);
  if (summary.copied_rapids > 0)
    text += fmt::format("{} rapids outside it are copied as they are\n", count_number(summary.copied_rapids));
  if (summary.near_poles > 0)
    text += fmt::format(
        "! at {} positions, the first in line {}, the tool is so near a pole that more than a tenth of the "
        "error "
        "of its direction stays: moves of rotary axes are bounded there\n",
        count_number(summary.near_poles), count_number(summary.first_near_pole));
  if (summary.beyond_readings > 0)
    text += fmt::format(
        "! {} positions, the first in line {}, lie beyond the measured ones: the last measured error is "
        "held\n",
        count_number(summary.beyond_readings), count_number(summary.first_beyond));
  for (const AxisName axis : summary.assumed_endless)
    text += fmt::format(
        "! {0} goes beyond its travel: it carries the workpiece and is taken to turn without end, unless "
        "endless = false stands in [axes.{0}] of the machine file\n",
        letter_of(axis));
  if (!check) return text;
  TextTable table(
      {{"", Align::Left}, {"RMS [um]"}, {"max [um]"}, {"in line"}, {"axis RMS [urad]"}, {"max [urad]"}},
      fmt::format("Error of the tool point, and of the tool's axis, along {:.1f} mm of feed motion",
                  check->length / kMetrePerMillimetre));
  add_tcp_errors("as programmed", check->before, table);
  add_tcp_errors("rewritten", check->after, table);
  return text + table.text();
}

nlohmann::ordered_json tcp_summary_json(const TcpSummary& summary,
                                        const std::optional<TcpProgramCheck>& check) {
  nlohmann::ordered_json json = {{"lines_read", summary.lines_read},
                                 {"lines_written", summary.lines_written},
                                 {"motions", summary.motions},
                                 {"split_lines", summary.split_lines},
                                 {"copied_rapids", summary.copied_rapids},
                                 {"largest_correction_um", summary.largest_correction / kMicro},
                                 {"largest_rotary_correction_urad", summary.largest_turn / kMicro},
                                 {"positions_near_poles", summary.near_poles},
                                 {"positions_beyond_readings", summary.beyond_readings},
                                 {"assumed_endless", letters_of(summary.assumed_endless)}};
  if (check) {
    json["check"] = {{"feed_length_mm", check->length / kMetrePerMillimetre},
                     {"before", tcp_errors_json(check->before)},
                     {"after", tcp_errors_json(check->after)}};
  }
  return json;
}

std::vector<Finding> ProgramFindings::all() const {
  std::vector<Finding> all;
  for (const auto* part : {&not_compensated, &invisible, &contradicted, &of_tables})
    all.insert(all.end(), part->begin(), part->end());
  return all;
}

ProgramFindings program_findings(const FitResult& result, const std::string& tool, bool with_rotary_axes) {
  const std::vector<Tool>& tools = result.machine.tools;
  const std::vector<AxisName> left =
      with_rotary_axes ? std::vector<AxisName>{} : identified_rotary_axes(result);
  return {errors_in_no_table(result, left), result.rank.invisible,
          findings_of_tables(result, {tool.empty() && !tools.empty() ? tools.front().name : tool}),
          contradictions(result)};
}

void add_program_findings(const ProgramFindings& findings, const FitResult& result,
                          const Conditions& conditions, nlohmann::ordered_json& json) {
  add_findings("effects_not_compensated", findings.not_compensated, json);
  json["conditions"] = conditions_json(result, conditions);
  add_findings("invisible", findings.invisible, json);
  add_findings("of_tables", findings.of_tables, json);
  add_findings("contradicted", findings.contradicted, json);
}

}  // namespace volcal
