#pragma once
/// Small tables of every format, to be damaged.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "volcal/identify/compensation/table_format.h"

namespace volcal::testing {

/// 1 m cube with errors in X and Y, two tools and reversal.
inline const FitResult& small_result() {
  static const FitResult result = [] {
    Machine machine = testing_support::machine_of("w X' b Y Z t");
    machine.name = "small, with a \"name\"";
    machine.tools = {{"short", Eigen::Vector3d(0.0, 0.0, -0.15), 0.0}, {"side", {0.1, 0.0, -0.2}, 0.0}};
    machine.axes[0].reference_point = {0.1, -0.2, 0.3};
    FitResult made = result_with(machine,
                                 {.functions = {{"EXX", [](double q) { return 10e-6 * q; }},
                                                {"EYX", [](double q) { return 4e-6 * q * (1.0 - q); }},
                                                {"EBY", [](double q) { return 12e-6 * q; }}},
                                  .locations = {{"EC0Y", 30e-6}, {"EA0Z", -10e-6}},
                                  .reversals = {{"EXX", 2e-6}, {"EBY", 3e-6}}},
                                 4);
    made.covariance = 1e-14 * Eigen::MatrixXd::Identity(made.layout.size, made.layout.size);
    return made;
  }();
  return result;
}

/// Every setting at its example.
inline std::map<std::string, std::string> example_settings(const TableFormat& format) {
  std::map<std::string, std::string> settings;
  for (const TableSetting& setting : format.settings)
    settings[std::string(setting.name)] = std::string(setting.example);
  return settings;
}

/// Whether a type can be had alone.
inline bool holds(const TableFormat& format, CompensationType type) {
  return format.indivisible ? type == format.supported : format.supported.contains(type);
}

/// At steps of 0.5 m; `type` of the format when none is given.
inline std::vector<TableFile> sample_tables(const TableFormat& format,
                                            std::optional<CompensationType> type = {}) {
  TableFormatOptions options;
  options.type = type.value_or(format.supported);
  options.step = 0.5;
  options.grid_per_axis = 2;
  options.settings = example_settings(format);
  return write_tables(format, small_result(), options);
}

}  // namespace volcal::testing
