#include "volcal/identify/criticism/effect_findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/catalogue/detectable.h"
#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr std::size_t kListed = 40;

/// Amplitudes and shape of a finding into its specification, the shape in words. An amplitude that no model
/// file takes is left open.
void state_values(const Family& family, const Eigen::VectorXd& shape, const Eigen::VectorXd& u,
                  EffectFinding& out) {
  const auto& amplitudes = family.effect->amplitudes();
  for (std::size_t k = 0; k < out.amplitudes.size(); ++k) {
    const double value = out.amplitudes[k].value;
    if (std::abs(value) <= largest_amplitude(*family.effect, amplitudes[k]))
      out.spec.options.set(std::string(stem_of_key(amplitudes[k].key)), value);
  }
  const auto& shapes = family.effect->shapes();
  out.shape_text.clear();
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const double si = shapes[k].si_per_unit();
    out.spec.options.set(std::string(stem_of_key(shapes[k].key)), shape[at]);
    out.shape_text += fmt::format("{}{} {:.4g}", k > 0 ? ", " : "", shapes[k].word(), shape[at] / si);
    if (u[at] > 0.0) out.shape_text += fmt::format(" +- {:.2g}", kCoverageFactor * u[at] / si);
    out.shape_text += " " + shapes[k].unit();
  }
}

EffectFinding estimated(const ModelState& state, const AddedEffect& added, const Eigen::VectorXd& values,
                        const Eigen::VectorXd& u) {
  const Family& family = state.family_of(added);
  EffectFinding out = finding(state.setting(), added.test);
  if (!family.effect) return out;
  for (std::size_t k = 0; k < out.amplitudes.size(); ++k) {
    out.amplitudes[k].value = values[static_cast<Eigen::Index>(k)];
    out.amplitudes[k].u = u[static_cast<Eigen::Index>(k)];
  }
  Eigen::VectorXd shape = added.test.shape, shape_u = Eigen::VectorXd::Zero(shape.size());
  if (values.size() > family.amplitudes()) {
    for (Eigen::Index k = 0; k < shape.size(); ++k) {
      const EffectShape& own = family.effect->shapes()[static_cast<std::size_t>(k)];
      const double moved = shape[k] + values.tail(shape.size())[k];
      shape[k] = own.scan_min < own.scan_max ? std::clamp(moved, own.scan_min, own.scan_max) : moved;
    }
    shape_u = u.tail(shape.size());
  }
  state_values(family, shape, shape_u, out);
  return out;
}

void list(const ModelState& state, const AddedEffect& added, const EffectFinding& own, Diagnosis& diagnosis) {
  if (added.rivals.empty()) {
    (own.resolution ? diagnosis.model_changes : diagnosis.effects).push_back(own);
    return;
  }
  std::vector<EffectFinding> set{own};
  for (const FamilyTest& rival : added.rivals) set.push_back(finding(state.setting(), rival));
  if (diagnosis.one_of.empty()) {
    diagnosis.one_of = std::move(set);
  } else {
    diagnosis.further_one_of.push_back(std::move(set));
  }
}

/// By the amplitude that is hardest to find.
DetectableEffect detectable(const EffectFinding& found, const Effect& effect, const Eigen::VectorXd& shape,
                            bool visible, const FunctionalPointLevers& levers) {
  std::size_t hardest = 0;
  for (std::size_t k = 1; k < found.amplitudes.size(); ++k) {
    if (!(found.amplitudes[k].mdb <= found.amplitudes[hardest].mdb)) hardest = k;
  }
  const AmplitudeFigure& amplitude = found.amplitudes[hardest];
  return {found.name,     found.label,           found.shape_text,
          amplitude.unit, amplitude.si_per_unit, found.visible_fraction,
          visible,        amplitude.mdb,         amplitude.mdb * levers.rms(effect, shape, hardest)};
}

/// An effect that the user thought of: the place of the added effect that it is, or for which it stands as
/// well; beside all of them otherwise.
struct PlaceOfTried {
  const FamilyTest* test;
  std::optional<std::size_t> added = {};
  bool is_rival = false;
};

/// A rival is judged in the place of what was added: beside it nothing is left for it.
PlaceOfTried place_of(std::size_t family, const ModelState& reached) {
  const std::vector<AddedEffect>& added = reached.added();
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (added[i].test.family == family) return {&added[i].test, i};
  }
  for (std::size_t i = 0; i < added.size(); ++i) {
    const auto rival = std::ranges::find(added[i].rivals, family, &FamilyTest::family);
    if (rival != added[i].rivals.end()) return {&*rival, i, true};
  }
  return {&reached.tests().families[family]};
}

/// What held-out readings are left with once the user's effect is in the model reached.
MemberFinding heldout_errors_with(const ModelState& reached, const PlaceOfTried& tried) {
  if (tried.test->score.dof == 0) return {};
  const LadderStep step = tried.is_rival ? ladder_step_with(reached, *tried.added, *tried.test)
                          : tried.added  ? last_step_of(reached)
                                         : ladder_step_beside(reached, *tried.test);
  return {.rms_heldout = step.rms_heldout,
          .systematic = step.systematic,
          .systematic_low = step.systematic_low,
          .systematic_high = step.systematic_high};
}

}  // namespace

EffectFinding finding(const SearchSetting& setting, const FamilyTest& test) {
  const Family& family = setting.families[test.family];
  EffectFinding out;
  out.name = family.name();
  out.label = family.label();
  out.spec = family.spec;
  out.log10_p = setting.family_wise_log10_p(test);
  out.lm = test.score.lm;
  out.dof = test.score.dof;
  out.gain = test.gain;
  out.visible_fraction = test.score.visible_fraction;
  out.resolution = family.resolution.has_value();
  if (!family.effect) return out;
  const double found_from = std::sqrt(setting.detectable_noncentrality(test.score.dof));
  const auto& amplitudes = family.effect->amplitudes();
  const std::size_t count =
      family.orders.empty() ? amplitudes.size() : static_cast<std::size_t>(test.shape[0]);
  for (const EffectAmplitude& amplitude : std::span(amplitudes).first(count)) {
    const auto at = static_cast<Eigen::Index>(out.amplitudes.size());
    const double u = std::sqrt(std::max(0.0, test.score.covariance(at, at)));
    out.amplitudes.push_back({amplitude.label, test.score.amplitude[at], u,
                              u > 0.0 ? u * found_from : std::nan(""), amplitude.unit(),
                              amplitude.si_per_unit()});
  }
  if (!family.orders.empty()) state_order(static_cast<Eigen::Index>(test.shape[0]), out.spec);
  state_values(family, test.shape, Eigen::VectorXd::Zero(test.shape.size()), out);
  return out;
}

std::vector<EffectFinding> added_findings(const ModelState& state, const Projector& projector) {
  const Eigen::VectorXd solution = projector.solution();
  const Eigen::MatrixXd covariance = projector.accepted_covariance();
  std::vector<EffectFinding> findings;
  Eigen::Index at = 0;
  for (const AddedEffect& added : state.added()) {
    const Eigen::Index count = added.columns.cols();
    const Eigen::VectorXd values = solution.segment(solution.size() - covariance.rows() + at, count);
    const Eigen::VectorXd u = covariance.diagonal().segment(at, count).cwiseMax(0.0).cwiseSqrt();
    at += count;
    findings.push_back(estimated(state, added, values, u));
  }
  return findings;
}

void list_added(const ModelState& reached, Diagnosis& diagnosis) {
  if (reached.added().empty()) return;
  const std::vector<EffectFinding> findings = added_findings(reached, *reached.projector_of_all_readings());
  for (std::size_t i = 0; i < findings.size(); ++i) list(reached, reached.added()[i], findings[i], diagnosis);
}

void list_detectable(const ModelState& given, Diagnosis& diagnosis) {
  const FunctionalPointLevers levers(given.model());
  for (const FamilyTest& test : given.tests().families) {
    const Family& family = given.setting().families[test.family];
    if (family.resolution) continue;
    const EffectFinding found = finding(given.setting(), test);
    const bool visible = test.score.dof > 0 && test.score.visible_fraction >= kThresholds.visible_fraction;
    if (!visible) diagnosis.not_visible.push_back(found);
    diagnosis.detectable.push_back(detectable(found, *family.effect, test.shape, visible, levers));
  }
}

void list_tried(const ModelState& reached, std::span<const EffectSpec> own, Diagnosis& diagnosis) {
  const std::vector<Family>& families = reached.setting().families;
  for (const EffectSpec& spec : own) {
    const EffectName name = find_effect(spec.kind)->make(spec, {})->name();
    const auto family =
        static_cast<std::size_t>(std::ranges::find(families, name, &Family::name) - families.begin());
    if (family == families.size()) continue;  // the model has it
    const PlaceOfTried place = place_of(family, reached);
    diagnosis.tried.push_back(finding(reached.setting(), *place.test));
    diagnosis.tried_errors.push_back(heldout_errors_with(reached, place));
  }
}

void list_ranking(const ModelState& reached, Diagnosis& diagnosis) {
  std::vector<const FamilyTest*> order;
  for (const FamilyTest& test : reached.tests().families) {
    if (test.score.dof > 0 && !reached.has(test.family)) order.push_back(&test);
  }
  std::ranges::sort(order, std::greater{}, &FamilyTest::gain);
  for (std::size_t i = 0; i < std::min(kListed, order.size()); ++i)
    diagnosis.ranking.push_back(finding(reached.setting(), *order[i]));
}

}  // namespace volcal
