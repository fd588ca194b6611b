#include "volcal/studies/criticism/yardstick.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/channels.h"

namespace volcal::studies {
namespace {

/// Readings of `b` less those of `a`, in the order of observations.
Eigen::VectorXd difference(const Campaign& a, const Campaign& b) {
  std::vector<double> values;
  for (std::size_t i = 0; i < a.setups.size(); ++i) {
    const Readings& before = a.setups[i].readings;
    const Readings& after = b.setups[i].readings;
    for (std::size_t row = 0; row < before.size(); ++row) {
      for (std::size_t channel = 0; channel < before.channels(); ++channel) {
        values.push_back(after.value[channel][row] - before.value[channel][row]);
      }
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

FitResult fitted(const Campaign& campaign, const ModelSpec& model) {
  FitOptions options;
  options.threads = 1;
  options.outliers = OutlierPolicy::Remove;
  options.noise = NoisePolicy::White;
  return fit(campaign, model, options);
}

sim::Study hiding(sim::Study study, const std::vector<sim::HiddenEffect>& effects) {
  study.hidden = effects;
  return study;
}

double unseen_square(const sim::SimulatedCampaign& simulated, const FitResult& result) {
  const LinearModel predicted(simulated.unseen, result);
  const Eigen::VectorXd& error = predicted.problem().residual;
  return (kPerMicro * error).squaredNorm() / static_cast<double>(error.size());
}

Yardstick::Yardstick(const sim::Study& study)
    : simulated_(sim::simulate(study)),
      result_(fitted(simulated_.campaign, {})),
      model_(simulated_.campaign, result_),
      smooth_(model_.problem(), model_.problem().data, true_noise(), 1),
      free_(model_.with_smoothing({}).problem(), model_.problem().data, true_noise(), 1) {}

Eigen::VectorXd Yardstick::change(const sim::Study& study, const sim::HiddenEffect& effect,
                                  double* amplitude) const {
  const sim::SimulatedCampaign with = sim::simulate(hiding(study, {effect}));
  *amplitude = with.hidden.front().amplitude;
  return difference(simulated_.campaign, with.campaign);
}

Yardstick::Visible Yardstick::visible(const Eigen::VectorXd& change) const {
  const ProjectedColumns projected = free_.project(change);
  const double signal = std::sqrt(std::max(0.0, projected.gram(0, 1)(0, 0)));
  return {signal, projected.norm[0] > 0.0 ? signal / projected.norm[0] : 0.0};
}

double Yardstick::signal(const Eigen::VectorXd& change) const {
  return std::sqrt(std::max(0.0, smooth_.project(change).gram(0, 1)(0, 0)));
}

Yardstick::Explained Yardstick::explained(const Eigen::VectorXd& change,
                                          const Eigen::MatrixXd& columns) const {
  return explained(change, columns, smooth_);
}

double Yardstick::share_taken(const Eigen::VectorXd& change, const Eigen::MatrixXd& columns) const {
  return explained(change, columns, free_).share;
}

Eigen::MatrixXd Yardstick::columns(const EffectFinding& finding) const {
  if (finding.resolution) return {static_cast<Eigen::Index>(model_.size()), 0};
  return columns(finding.spec);
}

Eigen::MatrixXd Yardstick::columns(const EffectSpec& spec) const {
  std::unique_ptr<Effect> effect = find_effect(spec.kind)->make(spec, {});
  const Eigen::VectorXd shape = effect->shape_values();
  return family_columns(model_, Family{spec, std::move(effect), std::nullopt, {shape}}, shape);
}

Eigen::MatrixXd Yardstick::without_imitation(const Eigen::MatrixXd& columns) const {
  return columns - model_.problem().jacobian * smooth_.imitation(columns);
}

Yardstick::Covered Yardstick::covered(const Eigen::VectorXd& change, const SurfaceFinding& surface) const {
  const Eigen::MatrixXd basis = columns(surface.spec);
  const SurfaceFigure& figure = surface.figure;
  const Eigen::VectorXd missed = without_imitation(basis * figure.coefficients - change);
  const Eigen::MatrixXd rows = without_imitation(basis);
  const Eigen::VectorXd variance = (rows * figure.covariance).cwiseProduct(rows).rowwise().sum();
  Covered covered;
  for (Eigen::Index i = 0; i < missed.size(); ++i) {
    if (basis.row(i).isZero(0.0) || !(variance[i] > 0.0)) continue;
    ++covered.of;
    if (std::abs(missed[i]) <= kCoverageFactor * std::sqrt(variance[i])) ++covered.count;
  }
  return covered;
}

Yardstick::Explained Yardstick::explained(const Eigen::VectorXd& change, const Eigen::MatrixXd& columns,
                                          const Projector& projector) {
  const Eigen::Index count = columns.cols();
  if (count == 0) return {};
  Eigen::MatrixXd all(columns.rows(), count + 1);
  all << columns, change;
  const Eigen::MatrixXd gram = projector.project(all).gram(0, count + 1);
  const Eigen::MatrixXd own = gram.topLeftCorner(count, count);
  const Eigen::VectorXd mixed = gram.topRightCorner(count, 1);
  const Eigen::VectorXd scale = own.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Explained out;
  out.amplitude = scale.cwiseProduct(
      least_squares(scale.asDiagonal() * own * scale.asDiagonal(), scale.cwiseProduct(mixed), 1e-9).solution);
  out.share = gram(count, count) > 0.0 ? mixed.dot(out.amplitude) / gram(count, count) : 0.0;
  return out;
}

std::vector<NoiseParameters> Yardstick::true_noise() const {
  std::vector<NoiseParameters> noise;
  for (const std::string& group : model_.noise_groups()) {
    const auto plan =
        std::ranges::find(simulated_.plans, instrument_of_noise_group(group), &sim::SetupPlan::instrument);
    noise.push_back({.drift = plan->noise.drift, .tau = plan->noise.drift_time, .line = plan->noise.line});
  }
  return noise;
}

}  // namespace volcal::studies
