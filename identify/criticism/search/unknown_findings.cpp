#include "volcal/identify/criticism/search/unknown_findings.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <string>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"

namespace volcal {
namespace {

constexpr std::size_t kMostUnknown = 10;

/// Of those that stand out nearly as much as the most improbable one, the first of the simplest.
void put_simplest_first(const SearchRules& rules, std::vector<const GenericTest*>& order) {
  if (order.empty() || !rules.follows(SearchRule::SimplestFirst)) return;
  const double nearly = (1.0 - kThresholds.nearly_as_improbable) * order.front()->log10_p;
  const auto end =
      std::ranges::find_if(order, [nearly](const GenericTest* test) { return test->log10_p > nearly; });
  const auto simplest = std::ranges::min_element(order.begin(), end, {}, [](const GenericTest* test) {
    return complexity_rank(test->variables, test->direction.value());
  });
  if (simplest == order.begin()) return;
  rules.tell(SearchRule::SimplestFirst);
  std::rotate(order.begin(), simplest, simplest + 1);
}

/// What exceeds under names that are none, and no scan sees for itself.
std::vector<UnknownFinding> rejected_findings(const ModelState& reached, const Reasons& rejected) {
  const SearchSetting& setting = reached.setting();
  std::vector<UnknownFinding> unknown;
  for (const auto& each : rejected) {
    const FamilyTest& test = reached.tests().families[each.first];
    const Family& family = setting.families[each.first];
    if (reached.has(each.first) || setting.family_wise_log10_p(test) > log10_family_risk()) continue;
    const Eigen::VectorXd moved = displacement(reached.model(), family, test);
    unknown.push_back({scan_variables_of(family.name()),
                       {},
                       direction_of_change(reached.model(), moved),
                       {},
                       moved.norm() / std::sqrt(static_cast<double>(moved.size())),
                       setting.family_wise_log10_p(test)});
  }
  std::ranges::sort(unknown, {}, &UnknownFinding::log10_p);
  return unknown;
}

}  // namespace

ScanDirection direction_of_change(const LinearModel& model, const Eigen::VectorXd& moved) {
  ScanDirection nearest = ScanDirection::X;
  double best = -1.0;
  for (const ScanDirection direction : kScanDirections) {
    const Eigen::VectorXd along = model.direction(direction);
    const double likeness = moved.cwiseAbs().dot(along.cwiseAbs()) / std::max(1e-300, along.norm());
    if (likeness <= best) continue;
    best = likeness;
    nearest = direction;
  }
  return nearest;
}

void report_what_is_certain(std::vector<UnknownFinding>& unknown) {
  if (unknown.empty()) return;
  UnknownFinding& leading = unknown.front();
  if (leading.variables.size() < 2) return;
  const double nearly = leading.log10_p + std::max(kThresholds.same_second_variable,
                                                   -kThresholds.same_second_variable_share * leading.log10_p);
  std::vector<Variable> common = leading.variables, others = leading.variables;
  for (const UnknownFinding& other : unknown) {
    if (other.variables.size() < 2 || other.log10_p > nearly) continue;
    const auto is_in_other = [&other](const Variable& variable) {
      return std::ranges::find(other.variables, variable) != other.variables.end();
    };
    std::erase_if(common, std::not_fn(is_in_other));
    for (const Variable& variable : other.variables) {
      if (std::ranges::find(others, variable) == others.end()) others.push_back(variable);
    }
  }
  if (common.size() != 1) return;
  std::erase(others, common.front());
  leading.variables = common;
  leading.with_one_of = others;
}

/// One per set of variables.
std::vector<UnknownFinding> unknown_findings(const ModelState& reached, const Reasons& rejected) {
  std::vector<const GenericTest*> order = reached.tests().exceeding_scans();
  std::ranges::sort(order, {}, &GenericTest::log10_p);
  const SearchRules& rules = reached.setting().rules;
  put_simplest_first(rules, order);
  std::set<std::vector<Variable>> seen;
  std::vector<UnknownFinding> unknown;
  for (const GenericTest* scan : order) {
    if (!seen.insert(scan->variables).second || unknown.size() == kMostUnknown) continue;
    unknown.push_back({scan->variables,
                       {},
                       scan->direction.value(),
                       scan->rotation,
                       scan->rms,
                       reached.tests().family_wise_log10_p(*scan),
                       scan->period});
  }
  if (unknown.empty()) return rejected_findings(reached, rejected);
  if (!rules.follows(SearchRule::CertainVariable)) return unknown;
  report_what_is_certain(unknown);
  if (!unknown.front().with_one_of.empty()) rules.tell(SearchRule::CertainVariable);
  return unknown;
}

}  // namespace volcal
