#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/design_stage.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/errors/volume/volume_points.h"
#include "volcal/identify/io/campaign/tolerance_reader.h"
#include "volcal/identify/report/text/error_budget_text.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/errors.h"
#include "volcal/python/model.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

constexpr int kFewestPositions = 2, kMostPositions = 41;  // as of the command line

struct BudgetOf {
  ErrorBudget budget;
  FitResult of;  ///< without its covariance and residuals
  std::string tool;
  Conditions conditions;
  std::optional<Tolerances> tolerances;  ///< of a machine at the design stage

  nlohmann::ordered_json json() const {
    nlohmann::ordered_json json =
        tolerances ? design_budget_json(budget, of.machine, *tolerances) : error_budget_json(budget);
    json["tool"] = tool;
    json["conditions"] = conditions_json(of, conditions);
    if (!tolerances) {
      add_findings("effects_in_no_figure", effects_in_no_figure(of), json);
      add_findings("of_tables", findings_of_tables(of, {tool}), json);
      add_findings("invisible", of.rank.invisible, json);
      add_findings("contradicted", contradictions(of), json);
    }
    return json;
  }
  std::string text() const {
    return conditions_text(of, conditions) +
           (tolerances ? design_budget_text(budget, of.machine, *tolerances, tool, true)
                       : error_budget_text(budget, tool, of.coverage_factor, true));
  }
};

FitResult designed_result(const Machine& machine, const std::string& tolerances,
                          std::optional<Tolerances>& read) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(machine.file, ignored))
    throw InputError({}, "a budget from tolerances needs a machine of a file",
                     "write it, and use Machine.read");
  auto [designed, of_file] = read_design(machine.file, tolerances);
  read = of_file;
  return result_of_tolerances(designed, of_file);
}

/// Of a result, of a model that states values, or of a machine with tolerances.
FitResult errors_of(const py::object& given, const std::string& file, std::optional<Tolerances>& tolerances) {
  if (py::isinstance<Machine>(given)) return designed_result(given.cast<const Machine&>(), file, tolerances);
  if (!file.empty())
    throw InputError({}, "tolerances are of a machine that is not built yet", "give a Machine with them");
  if (py::isinstance<Result>(given)) return given.cast<const Result&>().result;
  const auto& model = given.cast<const Model&>();
  require_stated_errors(model.spec);
  return stated_result(model.machine, model.spec);
}

BudgetOf budget_of(const py::object& errors, const std::optional<std::filesystem::path>& tolerances,
                   const std::string& tool, const py::dict& conditions, int grid, bool within_readings) {
  if (!py::isinstance<Machine>(errors) && !py::isinstance<Result>(errors) && !py::isinstance<Model>(errors))
    throw py::type_error("budget() takes a Result, a Model with values, or a Machine with tolerances");
  if (grid < kFewestPositions || grid > kMostPositions)
    throw InputError({}, fmt::format("grid={} is out of range", grid),
                     fmt::format("give {} to {}", kFewestPositions, kMostPositions));
  BudgetOf of;
  of.of = errors_of(errors, tolerances ? tolerances->string() : "", of.tolerances);
  TableFormatOptions options;
  options.tool = tool;
  const Tool& chosen = tool_of(of.of.machine, options);
  of.tool = chosen.name;
  of.conditions = stated_conditions(of.of, named_texts(conditions));
  if (within_readings) require_within_readings(of.of, of.conditions);
  of.budget = without_lock([&] { return error_budget(of.of, chosen, of.conditions, grid); });
  of.of.covariance.resize(0, 0);
  of.of.residuals.clear();
  return of;
}

py::dict line_columns(const std::vector<BudgetLine>& lines) {
  const auto numbers = [&](auto member) {
    std::vector<double> values;
    for (const BudgetLine& line : lines) values.push_back(line.*member);
    return array_of(values);
  };
  py::dict columns;
  py::list names, depends_on;
  for (const BudgetLine& line : lines) {
    names.append(text_of(line.name));
    depends_on.append(text_of(line.depends_on_text()));
  }
  columns["name"] = names;
  columns["depends_on"] = depends_on;
  columns["rms"] = numbers(&BudgetLine::rms);
  columns["max"] = numbers(&BudgetLine::max);
  columns["share"] = numbers(&BudgetLine::share);
  columns["u_rms"] = numbers(&BudgetLine::u_rms);
  columns["expected_share"] = numbers(&BudgetLine::expected_share);
  return columns;
}

void define_budget_line(py::module_& module) {
  py::class_<BudgetLine>(module, "BudgetLine",
                         "What one contribution, or one cause, adds to the error in the volume.")
      .def_property_readonly(
          "name", [](const BudgetLine& line) { return text_of(line.name); },
          "\"EAY\", \"EC0Y\", or a cause: \"angles\".")
      .def_property_readonly(
          "depends_on", [](const BudgetLine& line) { return text_of(line.depends_on_text()); },
          "What a contribution depends on: \"y\", \"z dir_y\"; \"\" for a constant and a cause.")
      .def_readonly("rms", &BudgetLine::rms, "Root mean square of the displacement, m.")
      .def_readonly("max", &BudgetLine::max, "Largest displacement, m.")
      .def_readonly("share", &BudgetLine::share,
                    "Share of the mean square of the whole error; negative where it cancels "
                    "others.")
      .def_readonly("u_rms", &BudgetLine::u_rms, "Root mean square of its standard uncertainty, m.")
      .def_readonly("expected_share", &BudgetLine::expected_share,
                    "Share of the mean square that is expected with the uncertainty.")
      .def("__repr__", [](const BudgetLine& line) {
        return text_of(fmt::format("<volcal.BudgetLine {}, {:.3g} m RMS>", line.name, line.rms));
      });
}

}  // namespace

void define_budget(py::module_& module) {
  define_budget_line(module);
  py::class_<BudgetOf>(module, "Budget", "Which error contributes how much to the error in the volume.")
      .def_property_readonly(
          "tool", [](const BudgetOf& of) { return text_of(of.tool); },
          "Tool whose functional point is meant.")
      .def_property_readonly(
          "total", [](const BudgetOf& of) { return of.budget.total; }, "The whole error, a BudgetLine.")
      .def_property_readonly(
          "contributions", [](const BudgetOf& of) { return of.budget.contributions; },
          "Every contribution, BudgetLine each, largest first.")
      .def_property_readonly(
          "causes", [](const BudgetOf& of) { return of.budget.causes; },
          "Positioning, straightness, squareness, angles ..., BudgetLine each, largest first.")
      .def_property_readonly(
          "rms_95", [](const BudgetOf& of) { return of.budget.rms_95; },
          "Of tolerances: the RMS that 95 % of such machines do not exceed, m; 0 elsewhere.")
      .def(
          "to_json", [](const BudgetOf& of) { return text_of(json_text(of.json(), 2) + "\n"); },
          "What `volcal budget --json` prints.")
      .def(
          "to_dict", [](const BudgetOf& of) { return from_json(json_text(of.json(), -1)); },
          "The same as dicts and lists, in edge units.")
      .def(
          "to_frame", [](const BudgetOf& of) { return frame_of(line_columns(of.budget.contributions)); },
          "The contributions as a pandas DataFrame, SI. Raises ImportError without pandas.")
      .def("__str__", [](const BudgetOf& of) { return text_of(of.text()); })
      .def(
          "_repr_html_", [](const BudgetOf& of) { return text_of("<pre>" + escaped(of.text()) + "</pre>"); },
          "The text that str() gives, for notebooks.")
      .def("__repr__", [](const BudgetOf& of) {
        return text_of(
            fmt::format("<volcal.Budget of {}, {:.3g} m RMS>", of.of.machine.name, of.budget.total.rms));
      });
  module.def(
      "budget", &budget_of, py::arg("errors"), py::kw_only(), py::arg("tolerances") = py::none(),
      py::arg("tool") = "", py::arg("conditions") = py::dict(), py::arg("grid") = kVolumeCells,
      py::arg("within_readings") = false,
      "Which error contributes how much to the error in the volume, as `volcal budget`: the same numbers to "
      "the "
      "last bit.\n\n"
      "errors: a Result, a Model with values, or, at the design stage, a Machine of a file; tolerances: the "
      "file "
      "of its tolerances (volcal-tolerances-1), None = the table [tolerances] of the machine file. tool: by "
      "name, "
      "\"\" = the machine's first. conditions: {\"T_air\": 23.3}. "
      "grid: as many places as a grid of so many positions per linear axis has, 2 to 41. "
      "within_readings: refuse where an axis was measured over a part of its travel. Raises InputError.");
}

}  // namespace volcal::python
