#include "volcal/python/result.h"

#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>

#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/io/results/result_json.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/fit_summary.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/today.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/python/model.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/findings.h"
#include "volcal/python/shared/long_work.h"
#include "volcal/python/shared/option_words.h"

namespace volcal::python {
namespace {

/// Fields of ResidualRecord.
py::dtype residual_type() {
  const std::array<std::tuple<const char*, const char*, std::size_t>, 12> fields = {{
      {"setup", "u8", offsetof(ResidualRecord, setup)},
      {"row", "u8", offsetof(ResidualRecord, row)},
      {"channel", "i4", offsetof(ResidualRecord, channel)},
      {"source_line", "i8", offsetof(ResidualRecord, source_line)},
      {"reading", "f8", offsetof(ResidualRecord, reading)},
      {"predicted", "f8", offsetof(ResidualRecord, predicted)},
      {"sigma", "f8", offsetof(ResidualRecord, sigma)},
      {"redundancy", "f8", offsetof(ResidualRecord, redundancy)},
      {"w", "f8", offsetof(ResidualRecord, w)},
      {"flagged", "?", offsetof(ResidualRecord, flagged)},
      {"removed", "?", offsetof(ResidualRecord, removed)},
      {"left_out", "?", offsetof(ResidualRecord, left_out)},
  }};
  py::list names, formats, offsets;
  for (const auto& [name, format, offset] : fields) {
    names.append(name);
    formats.append(format);
    offsets.append(offset);
  }
  return {names, formats, offsets, sizeof(ResidualRecord)};
}

py::array residuals_of(const py::object& self) {
  return residual_view(self.cast<const Result&>().result.residuals, self);
}

template <class Value>
py::list parameter_list(const Result& result, const Value& value) {
  py::list list;
  for (const NamedParameter& each : named_parameters(result.result.layout)) list.append(value(each));
  return list;
}

py::array_t<double> standard_uncertainties(const Result& result) {
  Eigen::VectorXd u(result.result.parameters.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i] = std::sqrt(parameter_variance(result.result, i));
  return array_of(u);
}

/// Of an aligned result that was read from files nothing is written of readings, which stay in the former
/// frame.
const Campaign& campaign_of(const Result& result) {
  static const Campaign none;
  if (result.campaign != nullptr) return *result.campaign;
  if (!result.result.alignment.empty()) return none;
  throw InputError({}, "the result was read from files, without its readings", "fit the campaign again");
}

/// An aligned result is reported with its own machine, and without readings.
std::string report_of(const Result& of) {
  const FitResult& result = of.result;
  const ReportOptions options{.date = today(), .provenance = result.provenance};
  if (result.alignment.empty()) return report_html(result, campaign_of(of), options);
  Campaign campaign;
  campaign.machine = result.machine;
  campaign.file = campaign_of(of).file;
  return report_html(result, campaign, options);
}

void write_result(const Result& result, const std::filesystem::path& path, bool report) {
  const Campaign& campaign = campaign_of(result);
  without_lock([&] {
    std::map<std::string, std::string> more;
    if (report && report_available()) more["report.html"] = report_of(result);
    write_result_folder(result.result, campaign, path.string(), more);
  });
}

template <class Value>
py::object column(const std::vector<ErrorTableRow>& rows, const Value& value) {
  py::list list;
  for (const ErrorTableRow& row : rows) list.append(value(row));
  return py::module_::import("numpy").attr("array")(list);
}

py::dict error_table_of(const Result& result, int positions, const std::string& zero) {
  if (zero != "mean" && zero != "plus")
    throw InputError({}, "zero \"" + zero + "\" is not known", "choose \"mean\" or \"plus\"");
  check_table_rows(positions);
  ErrorTableOptions options;
  options.positions = positions;
  options.zero_plus = zero == "plus";
  const auto rows = without_lock([&] { return error_table(result.result, options); });
  py::dict table;
  table["symbol"] = column(rows, [](const auto& row) { return row.symbol.name(); });
  table["axis"] =
      column(rows, [](const auto& row) { return row.axis ? std::string(1, letter_of(*row.axis)) : ""; });
  table["position"] = column(rows, [](const auto& row) { return row.axis ? row.position : std::nan(""); });
  table["direction"] = column(rows, [](const auto& row) { return row.direction; });
  table["value"] = column(rows, [](const auto& row) { return row.value; });
  table["u"] = column(rows, [](const auto& row) { return row.u; });
  table["U95"] = column(rows, [](const auto& row) { return row.U95; });
  table["unit"] = column(rows, [](const auto& row) { return row.rotation ? "rad" : "m"; });
  table["extrapolated"] = column(rows, [](const auto& row) { return row.extrapolated; });
  return table;
}

/// Positions in mm and deg by column, axes that are not named at home.
std::vector<AxisPosition> positions_of(const Machine& machine, const py::dict& given) {
  AxisPosition home{};
  for (const Axis& axis : machine.axes) home[index_of(axis.name)] = axis.home;
  std::vector<AxisPosition> positions;
  for (const auto& [name, values] : given) {
    const std::string key = py::str(name).cast<std::string>();
    const auto axis = std::ranges::find_if(
        machine.axes, [&](const Axis& each) { return position_column(each.name) == key; });
    if (axis == machine.axes.end())
      throw InputError({}, key + " is not a position of an axis of the machine",
                       "give x_mm, y_mm, z_mm, c_deg ...");
    const Doubles array = numbers_of(values, {}, key, "give one number per point");
    const auto count = static_cast<std::size_t>(array.size());
    if (positions.empty()) positions.assign(count, home);
    if (positions.size() != count)
      throw InputError({}, key + " has another length than the positions before it",
                       "give one number per point");
    for (std::size_t i = 0; i < count; ++i) {
      require_finite(fmt::format("{} of point {}", key, i + 1), array.data()[i]);
      positions[i][index_of(axis->name)] = array.data()[i] * position_unit(axis->name).si_per_unit;
    }
  }
  return positions;
}

const Tool& tool_named(const Machine& machine, const std::string& name) {
  TableFormatOptions options;
  options.tool = name;
  return tool_of(machine, options);
}

constexpr const char* kApproachRemedy = "give -1, 0 or 1 by axis: {\"X\": 1, \"Y\": -1}";

ApproachDirection approach_of(const Machine& machine, const py::dict& given) {
  ApproachDirection direction{};
  for (const auto& [name, value] : given) {
    const std::string letter = py::str(name).cast<std::string>();
    const auto axis = letter.size() == 1 ? axis_from_letter(letter[0]) : std::nullopt;
    if (!axis || !machine.has_axis(*axis))
      throw InputError({}, "approach: " + letter + " is not an axis of the machine", kApproachRemedy);
    const double sign = number_of(value, "approach " + letter);
    if (sign != -1.0 && sign != 0.0 && sign != 1.0)
      throw InputError({}, fmt::format("approach {} is {:g}", letter, sign), kApproachRemedy);
    direction[index_of(*axis)] = static_cast<std::int8_t>(sign);
  }
  return direction;
}

py::dict errors_at(const Result& of, const std::string& tool_name, const py::dict& approach,
                   const py::dict& conditions, bool within_readings, const py::kwargs& given) {
  const FitResult& result = of.result;
  const auto positions = positions_of(result.machine, given);
  const auto direction = approach_of(result.machine, approach);
  const auto texts = named_texts(conditions);
  const auto count = static_cast<py::ssize_t>(positions.size());
  py::array_t<double> value({count, py::ssize_t{6}}), u({count, py::ssize_t{6}});
  py::array_t<bool> extrapolated(count);
  double* to_value = value.mutable_data();
  double* to_u = u.mutable_data();
  bool* to_extrapolated = extrapolated.mutable_data();
  without_lock([&] {
    const Tool& tool = tool_named(result.machine, tool_name);
    const Conditions stated = stated_conditions(result, texts);
    if (within_readings) require_conditions_of_readings(result, stated);
    const ErrorField field(result, tool, stated);
    for (const AxisPosition& position : positions) {
      require_identified_rotary_axes(result, position);
      const VolumetricError error = volumetric_error(result, field, position, tool, direction);
      if (within_readings)
        require_measured(fmt::format("point {}", &position - positions.data() + 1), result.machine,
                         field.measured(), position, error);
      to_value = std::copy(error.value.begin(), error.value.end(), to_value);
      to_u = std::copy(error.u.begin(), error.u.end(), to_u);
      *to_extrapolated++ = error.extrapolated;
    }
  });
  py::dict errors;
  errors["value"] = value;
  errors["u"] = u;
  errors["extrapolated"] = extrapolated;
  return errors;
}

py::dict provenance_dict(const Result& result) {
  const Provenance& provenance = result.result.provenance;
  py::dict dict;
  dict["version"] = text_of(provenance.version);
  dict["date"] = text_of(provenance.date);
  dict["command"] = text_of(provenance.command);
  return dict;
}

void define_numbers(py::class_<Result>& type) {
  type.def_property_readonly(
          "parameters",
          [](const py::object& self) {
            return read_only_view(self.cast<const Result&>().result.parameters, self);
          },
          "Estimates: float array of shape (p,), SI (m, rad, 1/K ...), read-only, no copy. Divided by "
          "si_per_unit they "
          "are in `units`.")
      .def_property_readonly(
          "names",
          [](const Result& result) {
            return parameter_list(result, [](const auto& each) { return text_of(each.name); });
          },
          "Names of the p parameters: \"EXX 3\" (coefficient of a function), \"EC0Y\", \"station P1 x\", "
          "\"reversal "
          "EXX\".")
      .def_property_readonly(
          "units",
          [](const Result& result) {
            return parameter_list(result, [](const auto& each) { return text_of(each.unit); });
          },
          "Edge units of the p parameters: \"um\", \"urad\", \"mm\", \"um/m/K\".")
      .def_property_readonly(
          "si_per_unit",
          [](const Result& result) {
            std::vector<double> factors;
            for (const NamedParameter& each : named_parameters(result.result.layout))
              factors.push_back(each.si_per_unit);
            return array_of(factors);
          },
          "Factors from `units` to SI: float array of shape (p,).")
      .def_property_readonly(
          "covariance",
          [](const py::object& self) {
            return read_only_view(self.cast<const Result&>().result.covariance, self);
          },
          "Covariance of the parameters: float array of shape (p, p), SI, read-only, no copy; singular by "
          "the datum; of shape (0, 0) where errors are stated.")
      .def_property_readonly("u", &standard_uncertainties,
                             "Standard uncertainties of the parameters: float array of shape (p,), SI.")
      .def_property_readonly(
          "residuals", &residuals_of,
          "One record per observation: structured array of shape (m,), SI, read-only, no copy. Fields: setup "
          "(index into "
          "`setups`), row, channel, source_line, reading, predicted, sigma (total standard deviation), "
          "redundancy, w "
          "(normalised residual), flagged, removed, left_out. Empty in a result read from files.")
      .def_property_readonly(
          "sigma0", [](const Result& result) { return result.result.sigma0; },
          "sqrt(chi2 / dof) with the stated noise.")
      .def_property_readonly(
          "chi2", [](const Result& result) { return result.result.chi2; },
          "Sum of squares of the residuals over the stated standard deviations.")
      .def_property_readonly(
          "dof", [](const Result& result) { return result.result.dof; },
          "Degrees of freedom: observations less what the parameters take.");
}

void define_words(py::class_<Result>& type) {
  type.def_property_readonly(
          "status", [](const Result& result) { return std::string(to_string(result.result.status)); },
          "\"ok\", \"lack_of_fit\", \"rank_deficient\" or \"not_converged\".")
      .def_property_readonly(
          "findings", [](const Result& result) { return findings_of(result.result.findings); },
          "Warnings and explanations.")
      .def_property_readonly(
          "invisible", [](const Result& result) { return findings_of(result.result.rank.invisible); },
          "Errors that the readings do not show, each with the reason and what to measure.")
      .def_property_readonly(
          "setups",
          [](const Result& result) {
            py::list names;
            for (const SetupSummary& each : result.result.setups) names.append(text_of(each.name));
            return names;
          },
          "Names of the setups, which the field `setup` of the residuals counts.")
      .def_property_readonly(
          "machine", [](const Result& result) { return result.result.machine; },
          "The machine that was identified.")
      .def_property_readonly(
          "model",
          [](const Result& result) {
            return Model{result.result.identified, result.result.machine};
          },
          "The identified model, with its coefficients.")
      .def_property_readonly(
          "provenance", &provenance_dict,
          "\"version\" of volcal, \"date\" (UTC), \"command\": which program made it, when and how.");
}

void define_outputs(py::class_<Result>& type) {
  type.def("error_table", &error_table_of, py::arg("positions") = 0, py::arg("zero") = "mean",
           "The errors over the travel, as error_tables.csv has them: arrays of shape (r,) by column. "
           "symbol, axis "
           "(\"\" of squareness), position (m, rad; nan of squareness), direction (0 mean of both, -1, 1), "
           "value, u "
           "(standard) and U95 (expanded uncertainty), m or rad as `unit` says, extrapolated.\n\n"
           "positions: rows per function, 0 = round steps, 21 to 51 rows. zero: \"mean\" of both directions "
           "is zero at "
           "home, or the \"plus\" direction. Raises InputError.")
      .def("errors_at", &errors_at, py::kw_only(), py::arg("tool") = "", py::arg("approach") = py::dict(),
           py::arg("conditions") = py::dict(), py::arg("within_readings") = false,
           "Volumetric errors at n commanded positions, given by axis: errors_at(x_mm=[0, 100], y_mm=[50, "
           "50]), arrays "
           "of shape (n,), mm and deg, axes not named at home. Returns \"value\" and \"u\" (standard "
           "uncertainty), float "
           "arrays of shape (n, 6): ex ey ez (m), ea eb ec (rad), and \"extrapolated\", a bool array of "
           "shape (n,).\n\n"
           "tool: by name, \"\" = the machine's first. approach: direction of approach by axis, {\"X\": 1}; "
           "others: mean "
           "of both. conditions: {\"T_air\": 23.3, \"time_s\": 3600, \"feed_mm_min\": 1000}. "
           "within_readings: refuse "
           "points and conditions beyond the measured ones. Raises InputError.")
      .def(
          "to_json", [](const Result& result) { return text_of(result_json(result.result)); },
          "result.json as `write` writes it.")
      .def(
          "to_dict", [](const Result& result) { return from_json(result_json(result.result)); },
          "result.json as dicts and lists, SI.")
      .def(
          "to_frame", [](const Result& result) { return frame_of(error_table_of(result, 0, "mean")); },
          "error_table() as a pandas DataFrame. Raises ImportError without pandas.")
      .def(
          "residual_frame",
          [](const py::object& self) {
            return py::module_::import("pandas").attr("DataFrame")(residuals_of(self));
          },
          "The residuals as a pandas DataFrame of m rows, SI. Raises ImportError without pandas.")
      .def("write", &write_result, py::arg("path"), py::arg("report") = true,
           "Writes the folder that `volcal fit` writes: result.json, tables, residuals, identified.toml, and "
           "report.html "
           "unless `report` is False. Raises InputError, also for a result read from files.")
      .def(
          "report_html", [](const Result& result) { return without_lock([&] { return report_of(result); }); },
          "The whole report as one HTML page. Raises RuntimeError where volcal was built without it.")
      .def("__str__",
           [](const Result& result) { return text_of(with_arguments(fit_summary_text(result.result))); })
      .def("__repr__",
           [](const Result& result) {
             return text_of("<volcal.Result of " + result.result.machine.name + ", " +
                            std::string(to_string(result.result.status)) + ", " +
                            std::to_string(result.result.parameters.size()) + " parameters>");
           })
      .def(
          "_repr_html_", [](const Result& result) { return text_of(result_html(result)); },
          "The errors as a table with small plots, for notebooks.");
}

}  // namespace

py::array residual_view(const std::vector<ResidualRecord>& residuals, const py::handle& owner) {
  return read_only_view(residual_type(), {static_cast<py::ssize_t>(residuals.size())},
                        {static_cast<py::ssize_t>(sizeof(ResidualRecord))}, residuals.data(), owner);
}

Provenance provenance_of(const std::string& python) {
  return {.version = VOLCAL_VERSION, .date = present_time_text(), .command = python};
}

void define_result(py::module_& module) {
  py::class_<Result> type(
      module, "Result",
      "What an identification found: p parameters with their covariance, every residual, what the "
      "readings could and could not determine. Arrays of it are SI.");
  define_numbers(type);
  define_words(type);
  define_outputs(type);
  module.def(
      "read_result",
      [](const std::filesystem::path& path) {
        return without_lock([&] { return Result{read_result(path.string()), nullptr, path.string()}; });
      },
      py::arg("path"),
      "Result of a folder that `volcal fit` or Result.write wrote, or of its result.json; without residuals, "
      "which are in "
      "residuals.csv. Raises InputError.");
}

}  // namespace volcal::python
