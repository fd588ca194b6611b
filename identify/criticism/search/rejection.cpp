#include "volcal/identify/criticism/search/rejection.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "volcal/identify/criticism/catalogue/shape_refinement.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/errors_first.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

Finding rejected(FindingCode code, const Family& family) { return {code, {{"effect", family.label()}}}; }

bool acts_in_place_of(const Family& one, const Family& other) {
  if (!one.effect || !other.effect) return false;
  const auto symbols_of = [](const Family& family) {
    std::set<ErrorSymbol> symbols;
    for (const EffectTerm& term : family.effect->terms()) {
      if (term.target.kind == TargetKind::Motion) symbols.insert(term.target.symbol);
    }
    return symbols;
  };
  const std::set<ErrorSymbol> places = symbols_of(other);
  return std::ranges::any_of(symbols_of(one),
                             [&](const ErrorSymbol& symbol) { return places.contains(symbol); });
}

/// log10 p that an effect of several places has one amplitude, in the model without `added`, which it may be,
/// and without all that acts in its places and would hide that it differs there; 0 for one of a single place.
double log10_constancy_over_places(const ModelState& state, const FamilyTest& test, std::size_t added) {
  const Family& family = state.setting().families[test.family];
  if (!acts_in_several_places(family)) return 0.0;
  std::set<std::size_t> without = {added};
  for (std::size_t i = 0; i < state.added().size(); ++i) {
    if (acts_in_place_of(state.family_of(state.added()[i]), family)) without.insert(i);
  }
  return log10_p_of_one_amplitude(state.model(), family, test.shape, *state.projector_without(without));
}

/// `first`: of its columns among the projector's parameters.
ConstancyTest constancy_of(const ModelState& state, const Family& family, const Eigen::MatrixXd& columns,
                           Eigen::Index first, const Projector& projector) {
  const Eigen::Index count = std::min(family.amplitudes(), columns.cols());
  const Eigen::VectorXd moved = columns.leftCols(count) * projector.solution().segment(first, count);
  std::vector<ScanVariable> variables = state.setting().constancy_variables;
  std::erase_if(variables,
                [&](const ScanVariable& each) { return is_held_in_few_terms(state, each.variable); });
  return least_constant(family, moved, variables, projector);
}

}  // namespace

/// Its own driver moves what an effect leaves: it has another shape, or is another effect. A wave is one
/// beside it.
bool Rejection::still_moves(const std::vector<Variable>& drivers) const {
  const auto moves = [&](const GenericTest* scan) {
    if (scan->period > 0.0) return false;
    return std::ranges::any_of(scan->variables, [&](const Variable& variable) {
      return std::ranges::find(drivers, variable) != drivers.end() && !is_held_in_few_terms(state_, variable);
    });
  };
  return rules().decide(SearchRule::DriverStillMoves,
                        [&] { return std::ranges::any_of(state_.tests().exceeding_scans(), moves); });
}

Reasons Rejection::rejection_reasons() const {
  Reasons reasons;
  for (std::size_t i = 0; i < state_.added().size(); ++i) {
    if (std::optional<Finding> own = rejection_reason(i))
      reasons[state_.added()[i].test.family] = *std::move(own);
  }
  return reasons;
}

bool Rejection::leaves_more(const AddedEffect& effect) const {
  if (state_.family_of(effect).is_left_out()) return false;
  const double own = state_.setting().family_wise_log10_p(effect.test);
  return rules().decide(SearchRule::LeavesMore, [&] {
    return std::ranges::any_of(state_.tests().exceeding_scans(), [&](const GenericTest* scan) {
      const auto is_held = [&](const Variable& each) { return is_held_in_few_terms(state_, each); };
      const bool judges = scan->variables.empty() || !std::ranges::all_of(scan->variables, is_held);
      return judges && state_.tests().family_wise_log10_p(*scan) < own;
    });
  });
}

std::optional<Finding> Rejection::rejection_reason(std::size_t added) const {
  const AddedEffect& effect = state_.added()[added];
  const Family& family = state_.family_of(effect);
  if (family.is_left_out()) return std::nullopt;
  if (leaves_more(effect)) return rejected(FindingCode::RejectedLeavesMore, family);
  const auto drivers = scan_variables_of(family.name());
  if (still_moves(drivers)) {
    Finding moved = rejected(FindingCode::RejectedDriverStillMoves, family);
    moved.data["drivers"] = names_of(drivers);
    return moved;
  }
  if (!family.effect) return std::nullopt;
  const ConstancyTest varies = constancy(added);
  if (rules().decide(SearchRule::AmplitudeVaries,
                     [&] { return varies.log10_p <= std::log10(kThresholds.constancy_risk); })) {
    Finding varying = rejected(FindingCode::RejectedAmplitudeVaries, family);
    varying.data["variable"] = varies.variable;
    varying.data["log10_p"] = FindingNumber{varies.log10_p};
    return varying;
  }
  if (!rules().decide(SearchRule::ShapeBeyondScan, [&] { return lies_beyond_its_scan(added); }))
    return std::nullopt;
  Finding beyond = rejected(FindingCode::RejectedShapeBeyondScan, family);
  beyond.data["shape"] = family.effect->shapes().front().word();
  return beyond;
}

/// The best shape stands at an end of the scan, and the readings ask for one beyond.
bool Rejection::lies_beyond_its_scan(std::size_t added) const {
  const AddedEffect& effect = state_.added()[added];
  const Family& family = state_.family_of(effect);
  if (effect.columns.cols() == family.amplitudes())
    return false;  // no shape, or none that moves the readings
  const std::optional<ScanEnd> end = end_of_scan(family, effect.test.shape[0]);
  if (!end) return false;
  const Projector& projector = state_.projector();
  const Eigen::Index column = state_.first_column(added) + family.amplitudes();
  Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, projector.parameters());
  row(0, column) = 1.0;
  const double change = projector.solution()[column];
  const double outwards = *end == ScanEnd::Lowest ? -change : change;
  return outwards > kThresholds.beyond_scan * std::sqrt(projector.prediction_variance(row)[0]);
}

ConstancyTest Rejection::constancy(std::size_t added) const {
  const AddedEffect& effect = state_.added()[added];
  const ConstancyTest least = constancy_of(state_, state_.family_of(effect), effect.columns,
                                           state_.first_column(added), state_.projector());
  const double one_amplitude = log10_constancy_over_places(state_, effect.test, added);
  return one_amplitude < least.log10_p ? ConstancyTest{"axis", one_amplitude} : least;
}

/// In the place of an added effect.
double Rejection::log10_constancy_of_rival(std::size_t added, const FamilyTest& rival) const {
  const Family& family = state_.setting().families[rival.family];
  if (!family.effect) return 0.0;
  const auto projector = state_.projector_without({added});
  const Eigen::Index first = projector->parameters();
  const Eigen::MatrixXd columns = accept(state_.model(), family, rival, *projector);
  return std::min(constancy_of(state_, family, columns, first, *projector).log10_p,
                  log10_constancy_over_places(state_, rival, added));
}

const FamilyTest* Rejection::standing_rival(std::size_t added, const Reasons& rejected) const {
  for (const FamilyTest& rival : state_.added()[added].rivals) {
    const auto stands = [&] {
      return !rejected.contains(rival.family) &&
             log10_constancy_of_rival(added, rival) > std::log10(kThresholds.plainly_constant);
    };
    if (rules().decide(SearchRule::StandingRival, stands)) return &rival;
  }
  return nullptr;
}

}  // namespace volcal
