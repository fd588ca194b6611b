#include <fmt/format.h>
#include <pybind11/stl.h>

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/program/nc_check.h"
#include "volcal/identify/program/program_header.h"
#include "volcal/identify/report/text/program_text.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

using Point_mm = std::array<double, 3>;

struct CompensatedProgram {
  std::string text;
  NcRewriteSummary summary;
  ProgramCheck check;
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

CompensatedProgram compensated(const ProgramErrors& errors, const NcSetup& setup,
                               const FunctionalPoint& point, const NcRewriteOptions& options,
                               const std::string& program, const std::string& name) {
  NcRewriter rewriter(errors, setup, point, options, name);
  NcCheck check(errors, setup, point);
  CompensatedProgram done;
  const NcRewriter::Sink sink = [&](std::string_view line, std::span<const NcWrittenLine> written) {
    for (const NcWrittenLine& text : written) done.text += text.text;
    check.add(line, written);
  };
  for (std::size_t begin = 0; begin < program.size();) {
    const std::size_t end = std::min(program.find('\n', begin), program.size() - 1) + 1;
    rewriter.rewrite(std::string_view(program).substr(begin, end - begin), sink);
    begin = end;
  }
  done.summary = rewriter.summary();
  done.check = {check.before(), check.after(), check.length()};
  return done;
}

CompensatedProgram compensate_program(const Result& of, const std::string& program,
                                      const std::map<std::string, Point_mm>& work_offsets,
                                      const std::map<int, double>& tool_lengths, const std::string& tool,
                                      const std::string& lengths_from, const std::optional<Point_mm>& start,
                                      const std::string& units, const std::optional<bool>& block_delete,
                                      double tolerance_um, double arc_tolerance_um, int decimals,
                                      const py::dict& conditions, bool within_readings,
                                      const std::string& name) {
  const FitResult& result = of.result;
  const NcSetup setup = setup_of(result.machine, work_offsets, tool_lengths, start, units, block_delete);
  const auto texts = named_texts(conditions);
  NcRewriteOptions options;
  options.tolerance = tolerance_um * kMetrePerMicrometre;
  options.arc_tolerance = arc_tolerance_um * kMetrePerMicrometre;
  options.decimals_mm = decimals;
  options.within_readings = within_readings;
  return without_lock([&] {
    const FunctionalPoint point = functional_point(result.machine, tool, lengths_from);
    const Conditions conditions_stated = stated_conditions(result, texts);
    options.header = program_header("in Python", acting_conditions(result, conditions_stated));
    const ProgramErrors errors = program_errors(result, tool, conditions_stated);
    return compensated(errors, setup, point, options, program, name);
  });
}

}  // namespace

void define_compensation(py::module_& module) {
  py::class_<CompensatedProgram>(module, "CompensatedProgram",
                                 "An NC program rewritten so that errors cancel.")
      .def_property_readonly(
          "text", [](const CompensatedProgram& done) { return text_of(done.text); }, "The rewritten program.")
      .def_property_readonly(
          "summary",
          [](const CompensatedProgram& done) {
            return from_json(json_text(program_json(done.summary, done.check), -1));
          },
          "What was done, as `volcal compensate --json`: counts of lines, corrections and errors before and "
          "after, um.")
      .def_property_readonly(
          "rms_before", [](const CompensatedProgram& done) { return done.check.before.rms; },
          "RMS error of the tool point along the program, m.")
      .def_property_readonly(
          "rms_after", [](const CompensatedProgram& done) { return done.check.after.rms; },
          "The same along the rewritten program, m.")
      .def("__repr__", [](const CompensatedProgram& done) {
        return text_of(fmt::format("<volcal.CompensatedProgram of {} lines, RMS {:.2f} -> {:.2f} um>",
                                   done.summary.lines_written, done.check.before.rms * kPerMicro,
                                   done.check.after.rms * kPerMicro));
      });
  module.def(
      "compensate", &compensate_program, py::arg("result"), py::arg("program"), py::kw_only(),
      py::arg("work_offsets") = std::map<std::string, Point_mm>(),
      py::arg("tool_lengths") = std::map<int, double>(), py::arg("tool") = "", py::arg("lengths_from") = "",
      py::arg("start") = py::none(), py::arg("units") = "", py::arg("block_delete") = py::none(),
      py::arg("tolerance_um") = 0.5, py::arg("arc_tolerance_um") = 0.5, py::arg("decimals") = 4,
      py::arg("conditions") = py::dict(), py::arg("within_readings") = false, py::arg("name") = "program",
      "Rewrites an NC program (RS-274, ISO 6983) of X, Y and Z, given as text, so that the identified errors "
      "cancel, as `volcal compensate`.\n\n"
      "work_offsets: {\"G54\": (x, y, z)}, mm, machine coordinates. tool_lengths: {1: 150.2}, mm, by H "
      "number. "
      "tool: whose functional point is corrected while no length is active, \"\" = the first. lengths_from: "
      "tool "
      "that lengths are differences to. start: (x, y, z), mm, before the program. units: \"mm\" or \"inch\" "
      "before "
      "G20 or G21. block_delete: the control's switch. tolerance_um, arc_tolerance_um: of the corrected "
      "path. "
      "decimals: of coordinates in mm, 4 to 7. conditions: {\"T_air\": 23.3}. within_readings: refuse "
      "motions beyond "
      "the "
      "measured positions. name: stands for the file in messages. Raises InputError with the line.");
}

}  // namespace volcal::python
