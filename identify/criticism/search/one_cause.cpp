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
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

/// What a surface in the place of an added effect is of: its variables, and the error motion that it moves.
/// Nothing for what moves no single error motion, or several at once.
std::optional<UnknownFinding> finding_of(const ModelState& state, const AddedEffect& added) {
  const Family& family = state.family_of(added);
  if (!family.effect || family.is_left_out() || family.effect->terms().size() != 1) return std::nullopt;
  const EffectTarget& target = family.effect->amplitudes().front().target;
  if (target.kind != TargetKind::Motion) return std::nullopt;
  const Eigen::VectorXd moved = displacement(state.model(), family, added.test);
  UnknownFinding finding;
  finding.variables = scan_variables_of(family.name());
  const auto is_direction = [](const Variable& each) { return each.kind == Variable::Kind::Direction; };
  if (std::ranges::all_of(finding.variables, is_direction)) return std::nullopt;
  finding.direction = direction_of_change(state.model(), moved);
  finding.rotation = target.symbol;
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

/// What pairs are judged by: the prices of names and surfaces, and the best so far.
class OneCauseSearch {
 public:
  explicit OneCauseSearch(const ModelState& state)
      : state_(state),
        log_count_(std::log(static_cast<double>(state.projector().observations()))),
        log_families_(std::numbers::ln10 * state.setting().log10_families) {}

  std::optional<OneCause> of_names() {
    for (std::size_t i = 0; i < state_.added().size(); ++i) {
      const auto finding = finding_of(state_, state_.added()[i]);
      if (!finding) continue;
      const std::vector<EffectSpec> specs = surfaces_for(state_.model(), *finding);
      if (specs.empty()) continue;
      for (std::size_t k = 0; k < state_.added().size(); ++k) {
        if (k != i && may_be_one(i, k)) try_names(i, k, specs.front(), *finding);
      }
    }
    return std::move(best_);
  }

  std::optional<OneCause> of_surface_and_name() {
    for (std::size_t s = 0; s < state_.surfaces().size(); ++s) {
      for (std::size_t k = 0; k < state_.added().size(); ++k) {
        if (const auto finding = wider(state_.surfaces()[s], state_.added()[k])) try_surface(s, k, *finding);
      }
    }
    return std::move(best_);
  }

 private:
  bool may_be_one(std::size_t first, std::size_t second) const {
    const Family &one = state_.family_of(state_.added()[first]),
                 &other = state_.family_of(state_.added()[second]);
    return !other.resolution && !other.is_left_out() && !is_part_of(one, other);
  }

  /// What a surface of its own variable and those of the name would be drawn for.
  std::optional<UnknownFinding> wider(const AddedSurface& surface, const AddedEffect& added) const {
    if (state_.family_of(added).is_left_out()) return std::nullopt;
    const auto& options = surface.spec.options;
    const EffectTarget& target = surface.effect->amplitudes().front().target;
    if (target.kind != TargetKind::Motion || options.has("factor") || options.has("only"))
      return std::nullopt;
    std::vector<Variable> variables = scan_variables_of(surface.effect->name());
    if (variables.size() != 1) return std::nullopt;
    for (const Variable& one : scan_variables_of(state_.family_of(added).name())) {
      if (std::ranges::find(variables, one) == variables.end()) variables.push_back(one);
    }
    if (variables.size() != kVariablesTogether) return std::nullopt;
    UnknownFinding finding = surface.finding;
    finding.variables = std::move(variables);
    finding.with_one_of.clear();
    finding.rotation = target.symbol;
    return finding;
  }

  /// `spec`: of all drivers of the first.
  void try_names(std::size_t first, std::size_t second, const EffectSpec& spec,
                 const UnknownFinding& finding) {
    const auto without = state_.projector_without({first, second});
    const double lm = without->residual_squares() - state_.projector().residual_squares();
    const double parameters =
        parameters_of(state_, state_.added()[first]) + parameters_of(state_, state_.added()[second]);
    const double of_names = 0.5 * lm - 0.5 * parameters * log_count_ - 2.0 * log_families_;
    judge(*without, spec, finding, of_names, {first, second}, std::nullopt);
  }

  void try_surface(std::size_t surface, std::size_t name, const UnknownFinding& finding) {
    const std::vector<EffectSpec> specs = surfaces_for(state_.model(), finding);
    if (specs.empty()) return;
    const AddedSurface& own = state_.surfaces()[surface];
    const auto without = state_.projector_without_surface(own, {name});
    const double lm =
        state_.projector_without({name})->residual_squares() - state_.projector().residual_squares();
    const double of_name =
        0.5 * lm - 0.5 * parameters_of(state_, state_.added()[name]) * log_count_ - log_families_;
    const double of_surface = surface_evidence(state_.model(), *without, *own.effect) - log_families_;
    judge(*without, specs.front(), finding, of_surface + of_name, {name}, surface);
  }

  /// The surface over the model without the pair, against the evidence of the pair less its price.
  void judge(const Projector& without, const EffectSpec& spec, const UnknownFinding& finding, double of_pair,
             const std::set<std::size_t>& names, std::optional<std::size_t> surface) {
    std::shared_ptr<const Effect> effect = find_effect(spec.kind)->make(spec, {});
    if (state_.has_surface(effect->name()) || is_error_left_out(state_, *effect)) return;
    const double evidence = surface_evidence(state_.model(), without, *effect);
    const double margin = evidence - log_families_ - of_pair;
    if (evidence < kThresholds.surface_evidence || margin <= best_margin_) return;
    best_margin_ = margin;
    best_ = OneCause{{spec, std::move(effect), finding, evidence}, names, surface};
  }

  static constexpr std::size_t kVariablesTogether = 2;

  const ModelState& state_;
  double log_count_;
  double log_families_;
  double best_margin_ = 0.5 * kThresholds.indistinguishable_gain;
  std::optional<OneCause> best_;
};

}  // namespace

std::optional<OneCause> one_cause_of_two(const ModelState& state) { return OneCauseSearch(state).of_names(); }

std::optional<OneCause> one_cause_of_surface_and_name(const ModelState& state) {
  return OneCauseSearch(state).of_surface_and_name();
}

}  // namespace volcal
