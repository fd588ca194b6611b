#include "volcal/identify/io/results/known_errors.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/errors/alignment.h"
#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/io/campaign/machine_difference.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

constexpr const char* kErrorTables = "error_tables.csv";
constexpr const char* kMetadata = "metadata.csv";
constexpr double kSameReversal = 1e-9;  // m or rad

/// Rows of one error, by position.
struct ErrorRows {
  std::map<double, double> forward, backward;
};

TableFile table_file(const std::filesystem::path& folder, const char* name) {
  const std::string path = (folder / name).string();
  return {path, read_text_file(path)};
}

/// Half the difference of the directions as b0 + b1 (q - home).
void add_reversal(ErrorSymbol symbol, const ErrorRows& rows, double home, const std::string& file,
                  ModelSpec& model) {
  double count = 0.0, q_sum = 0.0, b_sum = 0.0;
  for (const auto& [q, value] : rows.forward) {
    count += 1.0;
    q_sum += q - home;
    b_sum += value - rows.backward.at(q);
  }
  double moment = 0.0, spread = 0.0;
  for (const auto& [q, value] : rows.forward) {
    const double from_mean = q - home - q_sum / count;
    moment += from_mean * (value - rows.backward.at(q));
    spread += from_mean * from_mean;
  }
  const double slope = spread > 0.0 ? moment / spread : 0.0;
  const double at_home = b_sum / count - slope * q_sum / count;
  for (const auto& [q, value] : rows.forward) {
    if (std::abs(value - rows.backward.at(q) - at_home - slope * (q - home)) < kSameReversal) continue;
    throw InputError({file, 0},
                     symbol.name() +
                         ": the directions of approach differ by more than a reversal that changes "
                         "in proportion to the position",
                     "use the result or the model that the tables were written from");
  }
  if (std::abs(at_home) > kSameReversal)
    model.effects.push_back(effect_spec("reversal", {{"symbol", symbol.name()}, {"amplitude", at_home}}));
  if (std::abs(slope) > kSameReversal)
    model.effects.push_back(
        effect_spec("position-reversal", {{"symbol", symbol.name()}, {"amplitude", slope}}));
}

void add_function(ErrorSymbol symbol, const ErrorRows& rows, const std::string& file, ModelSpec& model) {
  if (rows.forward.size() < 2 || rows.forward.size() != rows.backward.size())
    throw InputError({file, 0}, symbol.name() + " has less than two positions in a direction",
                     "give both directions at the same positions, or direction 0 alone");
  FunctionSpec& spec = model.functions[symbol];
  spec.basis = "bspline";
  spec.degree = 1;
  spec.knots = KnotChoice::Explicit;
  for (const auto& [q, value] : rows.forward) {
    const auto other = rows.backward.find(q);
    if (other == rows.backward.end())
      throw InputError({file, 0}, symbol.name() + " has other positions in the two directions",
                       "give both directions at the same positions, or direction 0 alone");
    spec.breakpoints.push_back(q);
    spec.coefficients.push_back(0.5 * (value + other->second));
  }
}

/// Up to the first row of any error that is marked as extrapolated: rows in between hold what was measured.
class MeasuredRows {
 public:
  void add(AxisName axis, const ErrorTableRow& row) {
    if (row.extrapolated) {
      beyond_[axis].push_back(row.position);
    } else {
      const auto [place, is_new] = measured_.emplace(axis, std::pair(row.position, row.position));
      auto& [first, last] = place->second;
      first = std::min(first, row.position);
      last = std::max(last, row.position);
    }
  }
  std::map<AxisName, std::pair<double, double>> ranges() const {
    std::map<AxisName, std::pair<double, double>> ranges;
    for (const auto& [axis, positions] : beyond_) {
      const auto measured = measured_.find(axis);
      if (measured == measured_.end()) continue;
      auto [first, last] = measured->second;
      double below = -std::numeric_limits<double>::infinity(), above = -below;
      for (const double q : positions) {
        if (q < first) below = std::max(below, q);
        if (q > last) above = std::min(above, q);
      }
      ranges[axis] = {std::isfinite(below) ? below : first, std::isfinite(above) ? above : last};
    }
    return ranges;
  }

 private:
  std::map<AxisName, std::vector<double>> beyond_;
  std::map<AxisName, std::pair<double, double>> measured_;
};

FitResult result_of_tables(const std::filesystem::path& folder) {
  const TableMetadata metadata = read_table_metadata(table_file(folder, kMetadata));
  ModelSpec model;
  model.default_function.basis = "zero";
  std::map<ErrorSymbol, ErrorRows> functions;
  MeasuredRows measured;
  const TableFile errors = table_file(folder, kErrorTables);
  for (const ErrorTableRow& row : read_function_table(errors, TableContent::Errors)) {
    if (const auto location = row.symbol.location()) model.locations[*location] = row.value;
    const auto symbol = row.symbol.motion();
    if (!symbol) continue;
    measured.add(symbol->axis, row);
    if (row.direction >= 0) functions[*symbol].forward[row.position] = row.value;
    if (row.direction <= 0) functions[*symbol].backward[row.position] = row.value;
  }
  for (const auto& [symbol, rows] : functions) {
    if (!metadata.machine.has_axis(symbol.axis))
      throw InputError({errors.name, 0}, symbol.name() + " belongs to an axis that the machine lacks",
                       "take metadata.csv of the same run");
    add_function(symbol, rows, errors.name, model);
    add_reversal(symbol, rows, metadata.machine.axis(symbol.axis).home, errors.name, model);
  }
  model.measured = metadata.measured.empty() ? measured.ranges() : metadata.measured;
  model.conditions = metadata.conditions;
  model.tool_errors = metadata.tool_errors;
  for (const auto& [tool, displaced] : metadata.tool_effects) {
    Eigen::Vector3d& error = model.tool_errors.emplace(tool, Eigen::Vector3d::Zero()).first->second;
    error += displaced;
  }
  FitResult result = stated_result(metadata.machine, model);
  result.alignment = metadata.alignment;
  add_finding_of_tables(metadata.made_for, result);
  return result;
}

FitResult result_of_model(const std::string& path, const SourcePlace& named_at) {
  const ModelFile model = read_model_with_machine(path, named_at);
  require_stated_errors(model.spec);
  return stated_result(model.machine, model.spec);
}

}  // namespace

std::optional<Campaign> readings_for(const Campaign& campaign, const FitResult& errors,
                                     const SourcePlace& place) {
  std::optional<Campaign> aligned;
  if (is_in_other_frame(errors, campaign.machine)) adopt_alignment(aligned.emplace(campaign), errors);
  const std::string difference =
      machine_difference(errors.machine, aligned ? aligned->machine : campaign.machine);
  if (!difference.empty())
    throw InputError(place, "the errors are those of another machine than the campaign: " + difference,
                     "give errors and a campaign of the same machine");
  return aligned;
}

bool is_tables_folder(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) && !is_result(path) &&
         std::filesystem::exists(std::filesystem::path(path) / kErrorTables, ignored);
}

FitResult read_known_errors(const std::string& path, const SourcePlace& named_at) {
  if (is_tables_folder(path)) return result_of_tables(path);
  std::error_code ignored;
  const std::filesystem::path place(path);
  if (!std::filesystem::is_directory(place, ignored) && place.extension() == ".toml")
    return result_of_model(path, named_at);
  return read_result(path, named_at);
}

ModelSpec read_starting_model(const std::string& path, const Machine& machine) {
  if (path.empty()) return {};
  return is_result(path) ? read_result(path).identified : read_model(path, machine);
}

}  // namespace volcal
