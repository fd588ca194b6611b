#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/session/session_tree.h"
#include "volcal/identify/session/session_work.h"

namespace volcal {
namespace {

constexpr double kNotLinear = 0.01;  // of a reading's noise: less is left to the derivatives
constexpr double kMovedShape = 1e-3;

/// Largest difference of residuals, in units of the noise.
double largest_difference(const Eigen::VectorXd& one, const Eigen::VectorXd& other,
                          const std::vector<double>& variance) {
  double largest = 0.0;
  for (std::size_t i = 0; i < variance.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    largest = std::max(largest, std::abs(one[at] - other[at]) / std::sqrt(variance[i]));
  }
  return largest;
}

bool any_shape_moved(const std::vector<FamilyTest>& before, const std::vector<FamilyTest>& after) {
  for (std::size_t i = 0; i < before.size(); ++i) {
    if ((before[i].shape - after[i].shape).norm() > kMovedShape * before[i].shape.norm()) return true;
  }
  return false;
}

}  // namespace

/// The noise first, about the preview's amplitudes, and smoothing under it; then, at these, what is not
/// linear in the parameters and in the shapes of effects, and which readings are no outliers any more.
Session::RefittedModel Session::refitted(const Recipe& preview, const ModelState& state,
                                         const SessionProgress& progress) {
  Recipe recipe = preview;
  /// `plain`, `all`: without effects, with the residuals of the fit.
  const auto make = [&recipe](const ModelState& plain, Projector all, const Refit& refit) {
    recipe.refit = std::make_shared<const Refit>(refit);
    const bool own = refit.residual.size() > 0;
    ModelState made = recipe.with_effects(own ? plain.with_residual(refit.residual) : plain);
    if (own) all = all.with_residual(refit.residual);
    for (const AddedEffect& effect : made.added()) all.accept(effect.columns);
    return RefittedModel{recipe, std::move(made), std::make_shared<const Projector>(std::move(all))};
  };
  const auto with_variance = [](RefittedModel made) {
    Refit refit = *made.recipe.refit;
    refit.variance = noise_variance(made.state.model().problem().data, made.state.noise());
    made.recipe.refit = std::make_shared<const Refit>(std::move(refit));
    return made;
  };

  Refit refit;
  refit.noise = state.readjusted_noise(*preview.projector_without_effects());
  if (preview.refit) {
    refit.smoothing = preview.refit->smoothing;
    refit.residual = preview.refit->residual;
    refit.reinstated = preview.refit->reinstated;
  }
  recipe.refit = std::make_shared<const Refit>(refit);
  if (!state.model().smoothing().empty()) {
    report_stage(progress, "smoothing", 0.2);
    const ModelState at_noise = recipe.make();
    const Projector& projector = at_noise.projector();
    refit.smoothing = at_noise.model()
                          .smoothed(projector.gram(), projector.observations(), at_noise.setting().threads)
                          .smoothing();
    recipe.refit = std::make_shared<const Refit>(refit);
  }
  report_stage(progress, "the model at this noise", 0.4);
  const ModelState plain = recipe.with_residuals_of_fit();
  const auto all = plain.projector_of_all_readings();
  const RefittedModel found = make(plain, *all, refit);
  report_stage(progress, "the exact model", 0.6);
  const LinearModel& model = found.state.model();
  std::vector<FamilyTest> moved = found.state.moved_effects(*found.all_readings);
  const std::vector<std::size_t> explained = found.state.explained_outliers();
  Eigen::VectorXd exact =
      model.exact_residual_at(found.all_readings->solution().head(model.problem().jacobian.cols()));
  const std::vector<double> variance = noise_variance(model.problem().data, found.state.noise());
  const bool is_linear = largest_difference(exact, model.problem().residual, variance) < kNotLinear;
  if (is_linear && explained.empty() && !any_shape_moved(recipe.added, moved)) return with_variance(found);
  if (!is_linear) refit.residual = std::move(exact);
  refit.reinstated.insert(refit.reinstated.end(), explained.begin(), explained.end());
  recipe.added = std::move(moved);
  if (explained.empty()) return with_variance(make(plain, *all, refit));
  recipe.refit = std::make_shared<const Refit>(refit);
  const ModelState more_readings = recipe.with_residuals_of_fit();
  return with_variance(make(more_readings, *more_readings.projector_of_all_readings(), refit));
}

}  // namespace volcal
