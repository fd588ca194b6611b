#include "volcal/identify/result/result.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/result/identified_expansions.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/parameter_names.h"

namespace volcal {
namespace {

/// Without what is assumed or holds for tables.
RecordedConditions of_campaign(RecordedConditions conditions) {
  const auto is_other = [](const RecordedRange& range) { return range.origin != ConditionOrigin::Campaign; };
  std::erase_if(conditions.temperature_degC, [&](const auto& entry) { return is_other(entry.second); });
  if (conditions.time && is_other(*conditions.time)) conditions.time.reset();
  if (conditions.feed && is_other(*conditions.feed)) conditions.feed.reset();
  return conditions;
}

}  // namespace

std::string_view to_string(FitStatus status) {
  switch (status) {
    case FitStatus::Ok:
      return "ok";
    case FitStatus::LackOfFit:
      return "lack_of_fit";
    case FitStatus::RankDeficient:
      return "rank_deficient";
    case FitStatus::NotConverged:
      return "not_converged";
  }
  return "";
}

double parameter_variance(const FitResult& result, Eigen::Index parameter) {
  return result.covariance.size() == 0 ? 0.0 : std::max(0.0, result.covariance(parameter, parameter));
}

Eigen::MatrixXd covariance_of(const FitResult& result, const std::vector<int>& parameters) {
  const auto size = static_cast<Eigen::Index>(parameters.size());
  if (result.covariance.size() == 0) return Eigen::MatrixXd::Zero(size, size);
  return result.covariance(parameters, parameters);
}

std::vector<Finding> contradictions(const FitResult& result) {
  std::vector<Finding> findings;
  for (const Finding& each : result.findings) {
    const bool contradicts = each.code == FindingCode::FitLackOfFit ||
                             each.code == FindingCode::ModelContradicted ||
                             each.code == FindingCode::FitNotConverged;
    if (contradicts) findings.push_back(each);
  }
  return findings;
}

std::map<AxisName, std::pair<double, double>> measured_positions(const FitResult& result) {
  std::map<AxisName, std::pair<double, double>> positions;
  for (const FunctionSummary& function : result.functions) {
    if (!(function.measured_min <= function.measured_max)) continue;
    const auto [place, is_new] =
        positions.emplace(function.symbol.axis, std::pair(function.measured_min, function.measured_max));
    auto& [first, last] = place->second;
    first = std::min(first, function.measured_min);
    last = std::max(last, function.measured_max);
  }
  return positions;
}

ModelSpec model_of_result(const FitResult& result) {
  constexpr double kSameEnd = 1e-6;  // m or rad
  ModelSpec model = result.identified;
  for (const Tool& tool : result.machine.tools) {
    if (const ParameterBlock* block = result.layout.find_block(tool_parameter(tool.name)))
      model.tool_errors[tool.name] = result.parameters.segment<3>(block->offset);
  }
  for (const IdentifiedExpansion& expansion : identified_expansions(result))
    model.expansions[expansion.axis] = expansion.per_kelvin;
  if (!model.effects.empty()) model.conditions = of_campaign(result.conditions);
  for (const auto& [axis, ends] : measured_positions(result)) {
    if (!result.machine.has_axis(axis)) continue;
    const Axis& travel = result.machine.axis(axis);
    if (ends.first > travel.travel_min + kSameEnd || ends.second < travel.travel_max - kSameEnd)
      model.measured[axis] = ends;
  }
  for (const auto& [axis, position] : result.standing) {
    if (std::abs(position - result.machine.axis(axis).home) > kSameEnd)
      model.measured.emplace(axis, std::pair(position, position));
  }
  return model;
}

}  // namespace volcal
