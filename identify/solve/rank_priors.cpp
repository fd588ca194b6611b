#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/priors/basis_prior.h"
#include "volcal/identify/solve/priors/rotary_gauge.h"
#include "volcal/identify/solve/rank.h"

namespace volcal {
namespace {

// m or rad: nothing says how rough what is not seen is; more than any machine, and little enough to compute
constexpr double kUnseenAmplitude = 1e-4;
constexpr double kWideDisplacement = 1e-3;
constexpr double kWideRotation = 1e-3;
constexpr double kWideSquareness = 1e-3;
constexpr double kNoiseOfMachineTools = 2e-6;  // m or rad: what these widths are wide beside
constexpr double kWideNuisance = 1.0;
constexpr double kSmallestPivot = 1e-13;    // beside its diagonal
constexpr double kHeldInformation = 1e-12;  // of a parameter's own
constexpr double kHeldSurface = 1e-9;       // what a surface could hide of the errors belongs to them

/// Standard deviations of the wide prior.
class WideSigma {
 public:
  WideSigma(const PriorWidths& stated, std::vector<double> sigma) : stated_(stated) {
    std::erase_if(sigma, [](double each) { return !std::isfinite(each); });
    if (sigma.empty()) return;
    const auto middle = sigma.begin() + static_cast<std::ptrdiff_t>(sigma.size() / 2);
    std::ranges::nth_element(sigma, middle);
    wider_ = std::max(1.0, *middle / kNoiseOfMachineTools);
  }

  double of(ErrorSymbol symbol) const {
    return is_rotation(symbol.component) ? stated_.rotation.value_or(wider_ * kWideRotation)
                                         : stated_.displacement.value_or(wider_ * kWideDisplacement);
  }
  double of(const ParameterBlock& block) const {
    if (block.location) {
      return is_rotation(block.location->component)
                 ? stated_.squareness.value_or(wider_ * kWideSquareness)
                 : stated_.displacement.value_or(wider_ * kWideDisplacement);
    }
    if (block.kind == ParameterKind::Effect || block.kind == ParameterKind::Expansion) return wider_ * 1e-3;
    if (block.kind == ParameterKind::EffectShape) return 10.0 * block.prior_sigma[0];
    return kWideNuisance;
  }

 private:
  PriorWidths stated_;
  double wider_ = 1.0;
};

}  // namespace

GaussianPrior wide_prior(const MeasurementModel& model, const DatumSpace& datum, const Eigen::VectorXd& z,
                         const std::vector<double>& sigma) {
  const WideSigma wide_sigma(model.spec().priors, sigma);
  GaussianPrior prior = GaussianPrior::none(datum.size());
  prior.mean = z;
  for (const auto& function : datum.functions()) {
    if (function.size() == 0) continue;
    const Basis& basis =
        *model.layout().groups[static_cast<std::size_t>(model.layout().find(function.symbol)->group)].basis;
    const Eigen::MatrixXd roughness =
        wide_precision(basis, model.campaign().machine.axis(function.symbol.axis),
                       is_smoothed(model.spec().function(function.symbol), basis));
    prior.precision.block(function.offset, function.offset, function.size(), function.size()) =
        function.basis.transpose() * roughness * function.basis / std::pow(wide_sigma.of(function.symbol), 2);
    prior.mean.segment(function.offset, function.size()).setZero();
  }
  for (const auto& block : datum.blocks()) {
    const ParameterBlock& source = model.layout().blocks[block.block];
    const double width = is_surface(source) ? kHeldSurface : wide_sigma.of(source);
    for (int k = 0; k < block.size; ++k)
      prior.precision(block.offset + k, block.offset + k) = 1.0 / (width * width);
    if (source.location || source.kind == ParameterKind::Effect)
      prior.mean.segment(block.offset, block.size).setZero();
  }
  return prior;
}

GaussianPrior above_rounding(const Eigen::MatrixXd& data, GaussianPrior wide) {
  if (data.rows() == 0) return wide;
  const Eigen::MatrixXd total = data + wide.precision;
  const auto factor = cholesky_lower(total);
  const auto pivots = [&] { return factor->diagonal().array().square() / total.diagonal().array(); };
  if (factor && pivots().minCoeff() > kSmallestPivot) return wide;
  wide.precision.diagonal() = wide.precision.diagonal().cwiseMax(kHeldInformation * data.diagonal());
  return wide;
}

GaussianPrior stated_priors(const MeasurementModel& model, const DatumSpace& datum) {
  const ParameterLayout& layout = model.layout();
  GaussianPrior prior = GaussianPrior::none(datum.size());
  for (const auto& block : datum.blocks()) {
    const ParameterBlock& source = layout.blocks[block.block];
    for (int k = 0; k < block.size; ++k) {
      const double sigma = source.prior_sigma[k];
      if (sigma == 0.0) continue;
      prior.precision(block.offset + k, block.offset + k) = 1.0 / (sigma * sigma);
      prior.mean[block.offset + k] = source.prior_mean[k];
    }
  }
  prior.precision += rotary_gauge(model, datum);
  return prior;
}

void hold_undetermined(const RankAnalysis& rank, const GaussianPrior& wide, GaussianPrior& prior) {
  if (rank.report.rank >= rank.report.parameters) return;
  prior.mean = (prior.precision.diagonal().array() > 0.0).select(prior.mean, wide.mean);
  Eigen::MatrixXd held = rank.deficient ? rank.on_invisible : wide.precision;
  for (const int coefficient : rank.of_surfaces) {
    held.row(coefficient).setZero();
    held.col(coefficient).setZero();
  }
  prior.precision += held;
}

void hold_invisible(const RankAnalysis& rank, std::vector<SmoothingTerm>& terms, GaussianPrior& prior) {
  const auto is_visible = [&](const SmoothingTerm& term) {
    return !term.is_function() ||
           std::ranges::find(rank.invisible_functions, term.symbol) == rank.invisible_functions.end();
  };
  const auto unseen = std::stable_partition(terms.begin(), terms.end(), is_visible);
  std::vector<SmoothingTerm> held(unseen, terms.end());
  terms.erase(unseen, terms.end());
  for (SmoothingTerm& term : held) term.lambda = 1.0 / (kUnseenAmplitude * kUnseenAmplitude);
  add_smoothing(held, prior);
}

}  // namespace volcal
