#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/search/model_tests.h"
#include "volcal/identify/session/session_effects.h"
#include "volcal/identify/session/session_tree.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr std::size_t kPreviewedAtOnce = 12;  // of the ranking

double rms_of_heldout(const ModelState& state, const Eigen::VectorXd& residual) {
  const std::vector<bool>& heldout = state.setting().heldout;
  const std::vector<double>& sigma = state.model().problem().data.sigma;
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < heldout.size(); ++i) {
    if (!heldout[i] || !std::isfinite(sigma[i])) continue;
    const double value = residual[static_cast<Eigen::Index>(i)];
    squares += value * value;
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

/// By its name, or by its label: an expression may say what an effect of the catalogue says.
void require_not_in_model(const std::vector<EffectFinding>& effects, const Effect& effect) {
  const auto known =
      std::ranges::find_if(effects, [name = effect.name(), label = effect_label(effect)](const auto& each) {
        return each.name == name || each.label == label;
      });
  if (known == effects.end()) return;
  throw InputError({}, "the model has " + known->label + " already",
                   "take it out first; a second one with a parameter that is estimated is written with "
                   "another letter, q in place of p");
}

bool have_same_values(const EffectSpec& one, const EffectSpec& other) {
  constexpr std::array kValues = {"p", "p_sigma", "q", "q_sigma"};
  return std::ranges::all_of(
      kValues, [&](const char* key) { return one.options.number(key) == other.options.number(key); });
}

/// Residuals if each of the families were added, its amplitudes as tested and the rest of the model adjusted;
/// a column each.
Eigen::MatrixXd residuals_with(const ModelState& state, const Eigen::VectorXd& before,
                               const std::vector<const FamilyTest*>& tests) {
  const LinearModel& model = state.model();
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(model.size()), static_cast<Eigen::Index>(tests.size()));
  for (std::size_t k = 0; k < tests.size(); ++k)
    moved.col(static_cast<Eigen::Index>(k)) =
        displacement(model, state.setting().families[tests[k]->family], *tests[k]);
  const Eigen::MatrixXd imitated = state.projector().imitation(moved);
  Eigen::Index at = model.problem().jacobian.cols();
  Eigen::MatrixXd change = moved;
  Eigen::MatrixXd by_model = Eigen::MatrixXd::Zero(moved.rows(), moved.cols());
  by_model.noalias() += model.problem().jacobian * imitated.topRows(at);
  change -= by_model;
  for (const AddedEffect& added : state.added()) {
    change -= added.columns * imitated.middleRows(at, added.columns.cols());
    at += added.columns.cols();
  }
  return (-change).colwise() + before;
}

}  // namespace

/// Of the leading effects of the catalogue, made together: one pass over the model's columns.
void Session::preview_leading() {
  std::vector<const FamilyTest*> leading = ranked();
  const std::vector<Family>& families = node().recipe.setting->families;
  const std::size_t listed = families.size() - node().recipe.setting->own;
  std::erase_if(leading, [&](const FamilyTest* test) {
    return families[test->family].effect == nullptr || test->family >= listed;
  });
  leading.resize(std::min(leading.size(), kPreviewedAtOnce));
  if (leading.empty() || node().previewed.contains(families[leading.front()->family].name())) return;
  const Eigen::MatrixXd residuals = residuals_with(node().state(), residual(), leading);
  for (std::size_t k = 0; k < leading.size(); ++k)
    node().previewed[families[leading[k]->family].name()] = residuals.col(static_cast<Eigen::Index>(k));
}

Eigen::VectorXd Session::previewed_residual(const FamilyTest& test) {
  preview_leading();
  const EffectName name = node().recipe.setting->families[test.family].name();
  if (const auto known = node().previewed.find(name); known != node().previewed.end()) return known->second;
  return residuals_with(node().state(), residual(), {&test}).col(0);
}

EffectPreview Session::preview(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  Eigen::VectorXd residual = previewed_residual(test);
  const double rms = rms_of_heldout(node().state(), residual);
  return {finding(*node().recipe.setting, test), std::move(residual), rms};
}

Eigen::VectorXd Session::driver(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  const ModelState& state = node().state();
  return family_columns(state.model(), state.setting().families[test.family], test.shape).rowwise().sum();
}

EffectPreview Session::formula(const EffectSpec& custom) {
  const EffectKind* kind = find_effect(custom.kind);
  if (kind == nullptr) throw std::invalid_argument(custom.kind + " is not a kind of effect");
  const auto effect = kind->make(custom, {});
  const EffectName name = effect->name();
  effect->check(campaign(), {});
  require_not_in_model(node().effects, *effect);
  require_drivers(custom, *effect);
  tests();  // so that the new one is tested after the others, whatever was asked before
  const auto last =
      std::find_if(own_.rbegin(), own_.rend(), [&](const EffectSpec& spec) { return name_of(spec) == name; });
  if (last != own_.rend() && have_same_values(*last, custom)) return preview(name);
  own_.push_back(custom);
  try {
    renew_setting();
  } catch (...) {
    own_.pop_back();
    throw;
  }
  return preview(name);
}

/// Throws InputError where they are not finite, or so large that their products are not.
void Session::require_drivers(const EffectSpec& custom, const Effect& effect) const {
  const Eigen::VectorXd sigma = this->sigma(current_);
  const std::vector<Family> written = own_families(linear(), std::span(&custom, 1));
  const Eigen::MatrixXd columns = family_columns(linear(), written.front(), effect.shape_values());
  const double squares = (columns.array().colwise() / sigma.array()).square().sum();
  if (!std::isfinite(squares * squares))
    throw InputError({}, effect_label(effect) + " moves the readings by more than can be computed",
                     "write it with smaller numbers, about 1 where it acts most");
}

SelectionSummary Session::summary(const std::vector<bool>& selected) const {
  const Eigen::VectorXd& left = residual();
  const std::vector<double>& variance = node().recipe.variance();
  SelectionSummary out;
  double sum = 0.0, variances = 0.0, positive = 0.0;
  for (std::size_t i = 0; i < std::min(selected.size(), variance.size()); ++i) {
    if (!selected[i] || !std::isfinite(variance[i])) continue;
    const double value = left[static_cast<Eigen::Index>(i)];
    ++out.readings;
    sum += value;
    variances += variance[i];
    positive += value > 0.0 ? 1.0 : 0.0;
  }
  if (out.readings == 0) return out;
  const auto count = static_cast<double>(out.readings);
  out.mean = sum / count;
  out.u = std::sqrt(variances) / count;
  out.share_positive = positive / count;
  return out;
}

}  // namespace volcal
