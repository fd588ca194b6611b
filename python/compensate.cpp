#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/program/nc_check.h"
#include "volcal/identify/program/program_header.h"
#include "volcal/identify/program/tcp/tcp_check.h"
#include "volcal/identify/program/tcp/tcp_rewriter.h"
#include "volcal/identify/program/tcp/tcp_words.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/program_text.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/findings.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

using Point_mm = std::array<double, 3>;

struct CompensatedProgram {
  std::string text;
  nlohmann::ordered_json summary;
  std::vector<Finding> findings;
  std::int64_t lines = 0;
  double rms_before = 0.0, rms_after = 0.0;  ///< m
};

/// What is asked for beside the errors.
struct Wishes {
  NcSetup setup;
  FunctionalPoint point;
  std::string tool;
  NcRewriteOptions options;
  int rotary_decimals = 5;
  bool orientation = false;
  std::string name;  ///< of the program
};

Eigen::Vector3d in_metres(const std::string& argument, const Point_mm& point) {
  for (const double coordinate : point) require_finite(argument, coordinate);
  return Eigen::Vector3d(point[0], point[1], point[2]) * kMetrePerMillimetre;
}

NcSetup setup_of(const Machine& machine, const std::map<std::string, Point_mm>& work_offsets,
                 const std::map<int, double>& tool_lengths, const std::optional<Point_mm>& start,
                 const std::string& units, const std::optional<bool>& block_delete) {
  NcSetup setup = nc_setup(machine);
  for (const auto& [name, point] : work_offsets) {
    const auto index = work_offset_index(name);
    if (!index)
      throw InputError({}, "work_offsets: " + name + " is not a work offset",
                       "there are G54 to G59, G59.1 to G59.3");
    setup.work_offsets[*index] = in_metres("work_offsets " + name, point);
  }
  for (const auto& [number, length] : tool_lengths) {
    require_finite(fmt::format("tool_lengths {}", number), length);
    setup.tool_lengths[number] = length * kMetrePerMillimetre;
  }
  if (start) setup.start = in_metres("start", *start);
  if (!units.empty() && units != "mm" && units != "inch")
    throw InputError({}, "units \"" + units + "\" are not known", "choose \"mm\" or \"inch\"");
  if (!units.empty()) setup.length_unit = units == "inch" ? kMetrePerInch : kMetrePerMillimetre;
  setup.block_delete = block_delete;
  return setup;
}

/// What the rewritten program is valid for: "result fit G54=X10,Y20,Z-300 H1=150.2".
std::string made_of(const Result& of, const std::map<std::string, Point_mm>& work_offsets,
                    const std::map<int, double>& tool_lengths) {
  std::string text = !of.path.empty()         ? "result " + of.path
                     : of.campaign != nullptr ? "a fit of " + of.campaign->file
                                              : "a result in Python";
  for (const auto& [name, point] : work_offsets)
    text += fmt::format(" {}=X{:.10g},Y{:.10g},Z{:.10g}", name, point[0], point[1], point[2]);
  for (const auto& [number, length] : tool_lengths) text += fmt::format(" H{}={:.10g}", number, length);
  return text;
}

/// Lines of a text with their ends.
template <class Take>
void for_lines(std::string_view text, const Take& take) {
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    take(text.substr(begin, end - begin));
    begin = end;
  }
}

/// How the first line that begins tool centre point motion does.
std::optional<TcpBegin> first_tcp(const std::string& program) {
  std::optional<TcpBegin> first;
  for_lines(program, [&](std::string_view line) {
    if (!first) first = tcp_begin(line);
  });
  return first;
}

CompensatedProgram compensated(const FitResult& result, const Conditions& conditions, const Wishes& wishes,
                               const std::string& program) {
  const ProgramErrors errors = program_errors(result, wishes.tool, conditions);
  NcRewriter rewriter(errors, wishes.setup, wishes.point, wishes.options, wishes.name);
  NcCheck check(errors, wishes.setup, wishes.point);
  CompensatedProgram done;
  const NcRewriter::Sink sink = [&](std::string_view line, std::span<const NcWrittenLine> written) {
    for (const NcWrittenLine& text : written) done.text += text.text;
    check.add(line, written);
  };
  for_lines(program, [&](std::string_view line) { rewriter.rewrite(line, sink); });
  done.summary =
      program_json(rewriter.summary(), ProgramCheck{check.before(), check.after(), check.length()});
  done.lines = rewriter.summary().lines_written;
  done.rms_before = check.before().rms;
  done.rms_after = check.after().rms;
  return done;
}

TcpRewriteOptions tcp_options(const FitResult& result, const Wishes& wishes) {
  TcpRewriteOptions options = tcp_options_of(result);
  options.tolerance = wishes.options.tolerance;
  options.decimals_mm = wishes.options.decimals_mm;
  options.decimals_deg = wishes.rotary_decimals;
  options.orientation = wishes.orientation;
  options.within_readings = wishes.options.within_readings;
  options.header = wishes.options.header;
  return options;
}

/// With tool centre point motion.
CompensatedProgram tcp_compensated(const FitResult& result, const Conditions& conditions,
                                   const Wishes& wishes, const std::string& program) {
  const ErrorsOfOffset errors = tcp_errors_of(result, wishes.tool, conditions);
  TcpRewriter rewriter(result.machine, errors, wishes.setup, wishes.point, tcp_options(result, wishes),
                       wishes.name);
  TcpCheck check(result.machine, errors, wishes.setup, wishes.point);
  CompensatedProgram done;
  const TcpRewriter::Sink sink = [&](std::string_view line, std::span<const NcWrittenLine> written) {
    for (const NcWrittenLine& text : written) done.text += text.text;
    check.add(line, written);
  };
  for_lines(program, [&](std::string_view line) { rewriter.rewrite(line, sink); });
  done.summary =
      tcp_summary_json(rewriter.summary(), TcpProgramCheck{check.before(), check.after(), check.length()});
  done.lines = rewriter.summary().lines_written;
  done.rms_before = check.before().rms;
  done.rms_after = check.after().rms;
  return done;
}

CompensatedProgram with_findings(CompensatedProgram done, const FitResult& result,
                                 const Conditions& conditions, const ProgramFindings& findings) {
  add_program_findings(findings, result, conditions, done.summary);
  done.findings = findings.all();
  return done;
}

void require_turning(const Wishes& wishes, const std::optional<TcpBegin>& tcp) {
  require_range("rotary_decimals", wishes.rotary_decimals, kFewestRotaryDecimals, kMostRotaryDecimals);
  if (wishes.orientation && !tcp)
    throw InputError({wishes.name, 0},
                     "orientation turns rotary axes, and the program has no tool centre point motion",
                     "leave orientation out, or write G43.4 H or TRAORI in the program");
}

CompensatedProgram compensate_program(const Result& of, const std::string& program,
                                      const std::map<std::string, Point_mm>& work_offsets,
                                      const std::map<int, double>& tool_lengths, const std::string& tool,
                                      const std::string& lengths_from, const std::optional<Point_mm>& start,
                                      const std::string& units, const std::optional<bool>& block_delete,
                                      double tolerance_um, double arc_tolerance_um, int decimals,
                                      int rotary_decimals, bool orientation, const py::dict& conditions,
                                      bool within_readings, const std::string& name) {
  const FitResult& result = of.result;
  const std::optional<TcpBegin> tcp = first_tcp(program);
  Wishes wishes{.setup = setup_of(result.machine, work_offsets, tool_lengths, start, units, block_delete),
                .point = functional_point(result.machine, tool, lengths_from),
                .tool = tool,
                .options = {},
                .rotary_decimals = rotary_decimals,
                .orientation = orientation,
                .name = name};
  require_turning(wishes, tcp);
  const Conditions stated = stated_conditions(result, named_texts(conditions));
  if (within_readings) require_conditions_of_readings(result, stated);
  wishes.options.tolerance = tolerance_um * kMetrePerMicrometre;
  wishes.options.arc_tolerance = arc_tolerance_um * kMetrePerMicrometre;
  wishes.options.decimals_mm = decimals;
  wishes.options.within_readings = within_readings;
  wishes.options.header =
      program_header(made_of(of, work_offsets, tool_lengths), acting_conditions(result, stated),
                     tcp == TcpBegin::ByName ? CommentStyle::Semicolon : CommentStyle::Brackets);
  return without_lock([&] {
    check_rewrite_options(wishes.options);
    return with_findings(
        tcp ? tcp_compensated(result, stated, wishes, program) : compensated(result, stated, wishes, program),
        result, stated, program_findings(result, tool, tcp.has_value()));
  });
}

}  // namespace

void define_compensation(py::module_& module) {
  py::class_<CompensatedProgram>(module, "CompensatedProgram",
                                 "An NC program rewritten so that errors cancel.")
      .def_property_readonly(
          "text", [](const CompensatedProgram& done) { return text_of(done.text); }, "The rewritten program.")
      .def_property_readonly(
          "summary", [](const CompensatedProgram& done) { return from_json(json_text(done.summary, -1)); },
          "What was done, as `volcal compensate --check --json`: counts of lines, corrections and errors "
          "before and "
          "after, um; what is to be said of the errors, in sentences and as findings.")
      .def_property_readonly(
          "findings", [](const CompensatedProgram& done) { return findings_of(done.findings); },
          "What is to be said of the errors: what is not compensated, errors that the readings do not show, "
          "stated "
          "values that they contradict, what tables hold that the errors were read from.")
      .def_property_readonly(
          "rms_before", [](const CompensatedProgram& done) { return done.rms_before; },
          "RMS error of the tool point along the program, m.")
      .def_property_readonly(
          "rms_after", [](const CompensatedProgram& done) { return done.rms_after; },
          "The same along the rewritten program, m.")
      .def("__repr__", [](const CompensatedProgram& done) {
        return text_of(fmt::format("<volcal.CompensatedProgram of {} lines, RMS {:.2f} -> {:.2f} um>",
                                   done.lines, done.rms_before * kPerMicro, done.rms_after * kPerMicro));
      });
  module.def(
      "compensate", &compensate_program, py::arg("result"), py::arg("program"), py::kw_only(),
      py::arg("work_offsets") = std::map<std::string, Point_mm>(),
      py::arg("tool_lengths") = std::map<int, double>(), py::arg("tool") = "", py::arg("lengths_from") = "",
      py::arg("start") = py::none(), py::arg("units") = "", py::arg("block_delete") = py::none(),
      py::arg("tolerance_um") = 0.5, py::arg("arc_tolerance_um") = 0.5, py::arg("decimals") = 4,
      py::arg("rotary_decimals") = 5, py::arg("orientation") = false, py::arg("conditions") = py::dict(),
      py::arg("within_readings") = false, py::arg("name") = "program",
      "Rewrites an NC program (RS-274, ISO 6983) of X, Y and Z, or with rotary axes and tool centre point "
      "motion "
      "(G43.4 H, TRAORI), given as text, so that the identified errors cancel, as `volcal compensate`.\n\n"
      "work_offsets: {\"G54\": (x, y, z)}, mm, machine coordinates. tool_lengths: {1: 150.2}, mm, by H "
      "number. "
      "tool: whose functional point is corrected while no length is active, \"\" = the first. lengths_from: "
      "tool "
      "that lengths are differences to. start: (x, y, z), mm, before the program. units: \"mm\" or \"inch\" "
      "before "
      "G20 or G21. block_delete: the control's switch. tolerance_um, arc_tolerance_um: of the corrected "
      "path. "
      "decimals: of coordinates in mm, 4 to 7. rotary_decimals: of positions of rotary axes in deg, 3 to 8. "
      "orientation: with tool centre point motion, turn the tool's axis to where it is meant, too. "
      "conditions: {\"T_air\": 23.3}. within_readings: refuse "
      "motions and conditions beyond the measured ones. name: stands for the file in messages. Raises "
      "InputError with the line.");
}

}  // namespace volcal::python
