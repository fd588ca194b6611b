#include "volcal/identify/criticism/search/one_cause.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/unknown_findings.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

/// What a surface in the place of an added effect is of: its variables, and the error motion that it moves.
/// Nothing for what moves no single error motion, or several at once.
std::optional<UnknownFinding> finding_of(const ModelState& state, const AddedEffect& added) {
  const Family& family = state.family_of(added);
  if (!family.effect || family.effect->terms().size() != 1) return std::nullopt;
  const EffectTarget& target = family.effect->amplitudes().front().target;
  if (target.kind != TargetKind::Motion) return std::nullopt;
  const Eigen::VectorXd moved = displacement(state.model(), family, added.test);
  UnknownFinding finding;
  finding.variables = names_of(scan_variables_of(family.name()));
  const auto is_direction = [](const std::string& name) { return name.starts_with("dir_"); };
  if (std::ranges::all_of(finding.variables, is_direction)) return std::nullopt;
  finding.direction = direction_of_change(state.model(), moved);
  finding.rotation = target.symbol.name();
  finding.rms = moved.norm() / std::sqrt(static_cast<double>(moved.size()));
  finding.log10_p = state.setting().family_wise_log10_p(added.test);
  return finding;
}

/// Whether the second belongs to the function that a surface of the first is of: a backlash, and one that
/// grows along the travel, are two names of one function already.
bool is_part_of(const Family& first, const Family& second) {
  if (first.name().target != second.name().target) return false;
  const std::vector<Variable> all = scan_variables_of(first.name());
  return std::ranges::all_of(scan_variables_of(second.name()), [&](const Variable& variable) {
    return std::ranges::find(all, variable) != all.end();
  });
}

double parameters_of(const ModelState& state, const AddedEffect& added) {
  const Family& family = state.family_of(added);
  return static_cast<double>(family.amplitudes()) +
         (family.scan.size() > 1 ? static_cast<double>(added.test.shape.size()) : 0.0);
}

class OneCauseSearch {
 public:
  explicit OneCauseSearch(const ModelState& state)
      : state_(state),
        log_count_(std::log(static_cast<double>(state.projector().observations()))),
        log_families_(std::numbers::ln10 * state.setting().log10_families) {}

  std::optional<OneCause> run() {
    for (std::size_t i = 0; i < state_.added().size(); ++i) {
      const auto finding = finding_of(state_, state_.added()[i]);
      if (!finding) continue;
      const std::vector<EffectSpec> specs = surfaces_for(state_.model(), *finding);
      if (specs.empty()) continue;
      for (std::size_t k = 0; k < state_.added().size(); ++k) {
        if (k != i && may_be_one(i, k)) try_pair(i, k, specs.front(), *finding);
      }
    }
    return std::move(best_);
  }

 private:
  bool may_be_one(std::size_t first, std::size_t second) const {
    const Family &one = state_.family_of(state_.added()[first]),
                 &other = state_.family_of(state_.added()[second]);
    return !other.resolution && !is_part_of(one, other);
  }

  /// `spec`: of all drivers of the first.
  void try_pair(std::size_t first, std::size_t second, const EffectSpec& spec,
                const UnknownFinding& finding) {
    std::shared_ptr<const Effect> effect = find_effect(spec.kind)->make(spec, {});
    if (state_.has_surface(effect->name())) return;
    const auto without = state_.projector_without({first, second});
    const double lm = without->residual_squares() - state_.projector().residual_squares();
    const double parameters =
        parameters_of(state_, state_.added()[first]) + parameters_of(state_, state_.added()[second]);
    const double of_names = 0.5 * lm - 0.5 * parameters * log_count_ - 2.0 * log_families_;
    const double evidence = surface_evidence(state_.model(), *without, *effect);
    const double margin = evidence - log_families_ - of_names;
    if (evidence < kThresholds.surface_evidence || margin <= best_margin_) return;
    best_margin_ = margin;
    best_ = OneCause{{spec, std::move(effect), finding, evidence}, {first, second}};
  }

  const ModelState& state_;
  double log_count_;
  double log_families_;
  double best_margin_ = 0.5 * kThresholds.indistinguishable_gain;
  std::optional<OneCause> best_;
};

}  // namespace

std::optional<OneCause> one_cause_of_two(const ModelState& state) { return OneCauseSearch(state).run(); }

}  // namespace volcal
