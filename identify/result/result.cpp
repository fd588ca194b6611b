#include "volcal/identify/result/result.h"

#include <algorithm>

#include "volcal/model/description/finding_codes.h"

namespace volcal {

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

ModelSpec model_with_measured_travel(const FitResult& result) {
  constexpr double kSameEnd = 1e-6;  // m or rad
  ModelSpec model = result.identified;
  if (!model.effects.empty()) model.conditions = result.conditions;
  for (const auto& [axis, ends] : measured_positions(result)) {
    if (!result.machine.has_axis(axis)) continue;
    const Axis& travel = result.machine.axis(axis);
    if (ends.first > travel.travel_min + kSameEnd || ends.second < travel.travel_max - kSameEnd)
      model.measured[axis] = ends;
  }
  return model;
}

}  // namespace volcal
