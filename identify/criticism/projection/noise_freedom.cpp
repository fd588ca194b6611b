#include "volcal/identify/criticism/projection/noise_freedom.h"

#include <array>
#include <cmath>

#include "volcal/identify/solve/correlated_adjustment.h"

namespace volcal {
namespace {

constexpr double kShift = 0.1;  // of a logarithm

/// In the order of InstrumentNoise::log_covariance.
constexpr std::array<double NoiseParameters::*, 5> kParameters = {
    &NoiseParameters::white, &NoiseParameters::drift, &NoiseParameters::tau, &NoiseParameters::line,
    &NoiseParameters::per_metre};

/// |m|^2 of every column.
Eigen::ArrayXd information(const Projector& projector, const Eigen::MatrixXd& moved) {
  return projector.project(moved).gram(0, moved.cols()).diagonal();
}

}  // namespace

std::vector<double> noise_freedom(
    const Eigen::MatrixXd& moved, const Projector& projector, const NoiseEstimate& estimate,
    const std::function<std::unique_ptr<Projector>(const std::vector<NoiseParameters>& noise)>&
        projector_of) {
  Eigen::ArrayXd variance = Eigen::ArrayXd::Zero(moved.cols());  // r^T W r
  if (is_more_than_white(estimate)) {
    const Eigen::ArrayXd own = information(projector, moved);
    const std::vector<NoiseParameters> noise = estimate.parameters();
    for (std::size_t group = 0; group < noise.size(); ++group) {
      const auto& covariance = estimate.instruments[group].log_covariance;
      Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(covariance.rows(), moved.cols());
      for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
        if (!(covariance(k, k) > 0.0)) continue;
        std::vector<NoiseParameters> other = noise;
        other[group].*kParameters[static_cast<std::size_t>(k)] *= std::exp(kShift);
        slope.row(k) = (information(*projector_of(other), moved) / own).log() / kShift;
      }
      variance += slope.cwiseProduct(covariance * slope).colwise().sum().transpose().array();
    }
  }
  std::vector<double> freedom;
  for (const double each : variance) freedom.push_back(2.0 / each);
  return freedom;
}

}  // namespace volcal
