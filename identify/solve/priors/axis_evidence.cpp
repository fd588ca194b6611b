#include "volcal/identify/solve/priors/axis_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {
namespace {

constexpr int kAmplitudeSteps = 4;
constexpr int kAmplitudesInADecade = 4;
constexpr double kRounding = 1e-10;  // of a precision that holds what a surface may not imitate at zero
constexpr double kMostRounding = 1e-6;
constexpr double kLeastLeft = 1e-14;  // of a precision, when others are integrated out: below is rounding

}  // namespace

AxisEvidence::AxisEvidence(const Quadratic& all, const Eigen::VectorXd& z0,
                           const std::vector<Stretch>& stretches) {
  std::vector<bool> is_mine(static_cast<std::size_t>(z0.size()), false);
  std::vector<int> mine;
  for (const Stretch& stretch : stretches) {
    stretches_.push_back({stretch.term, static_cast<int>(mine.size())});
    const int n = static_cast<int>(stretch.term->precision().rows());
    for (int i = stretch.offset; i < stretch.offset + n; ++i) {
      mine.push_back(i);
      is_mine[static_cast<std::size_t>(i)] = true;
    }
  }
  std::vector<int> others;
  for (int i = 0; i < z0.size(); ++i) {
    if (!is_mine[static_cast<std::size_t>(i)]) others.push_back(i);
  }
  z0_ = z0(mine);
  cost_.precision = all.precision(mine, mine);
  cost_.gradient = all.gradient(mine);
  if (others.empty()) return;
  const Eigen::MatrixXd across = all.precision(others, mine);
  Eigen::MatrixXd precision = all.precision(others, others);
  auto factor = cholesky_lower(precision);
  for (double rounding = kRounding; !factor && rounding <= kMostRounding; rounding *= 100.0) {
    precision.diagonal() *= 1.0 + rounding;
    factor = cholesky_lower(precision);
  }
  if (!factor)
    throw std::runtime_error("maximise_evidence: the posterior precision is not positive definite");
  const Eigen::MatrixXd half = factor->triangularView<Eigen::Lower>().solve(across);
  const Eigen::VectorXd half_gradient =
      factor->triangularView<Eigen::Lower>().solve(Eigen::VectorXd(all.gradient(others)));
  const Eigen::VectorXd before = cost_.precision.diagonal();
  cost_.precision -= half.transpose() * half;
  cost_.precision.diagonal() = cost_.precision.diagonal().cwiseMax(kLeastLeft * before);
  cost_.gradient -= half.transpose() * half_gradient;
}

double AxisEvidence::log_evidence(const Prior& prior, double lambda) const {
  return posterior(cost_, z0_, stretches_, {prior}, {lambda}).log_evidence;
}

AxisEvidence::Choice AxisEvidence::with_shape(std::size_t shape, std::vector<double> lambda) const {
  std::vector<Prior> priors;
  for (const Stretch& stretch : stretches_) priors.push_back(stretch.term->shapes()[shape]);
  Posterior now = posterior(cost_, z0_, stretches_, priors, lambda);
  for (int step = 0; step < kAmplitudeSteps; ++step) {
    for (std::size_t t = 0; t < lambda.size(); ++t)
      lambda[t] = updated_lambda(stretches_[t], *priors[t], lambda[t], now);
    now = posterior(cost_, z0_, stretches_, priors, lambda);
  }
  return {shape, std::move(lambda), now.log_evidence};
}

double widened_lambda(const AxisEvidence& evidence, const Prior& prior) {
  const auto height = [&](double log_amplitude) {
    const double amplitude = std::pow(10.0, log_amplitude);
    return evidence.log_evidence(prior, 1.0 / (amplitude * amplitude)) + std::log(amplitude) -
           amplitude / kUsualAmplitude;
  };
  const double from = -0.5 * std::log10(kMostLambda), to = -0.5 * std::log10(kLeastLambda);
  const int steps = static_cast<int>(std::lround((to - from) * kAmplitudesInADecade));
  double best = from, highest = -std::numeric_limits<double>::infinity();
  const auto take_if_higher = [&](double log_amplitude) {
    const double at = height(log_amplitude);
    if (at <= highest) return;
    highest = at;
    best = log_amplitude;
  };
  for (int i = 0; i <= steps; ++i) take_if_higher(from + static_cast<double>(i) / kAmplitudesInADecade);
  for (double step = 0.5 / kAmplitudesInADecade; step > 0.01; step *= 0.5) {
    const double middle = best;
    take_if_higher(middle - step);
    take_if_higher(middle + step);
  }
  return std::pow(10.0, -2.0 * best);
}

AxisShapes::AxisShapes(AxisEvidence evidence, std::size_t shape, const std::vector<double>& lambda)
    : evidence_(std::move(evidence)), best_(evidence_.with_shape(shape, lambda)) {
  tried_.emplace(shape, best_);
  for (int kind = 0; kind < kRoughnessKinds; ++kind) climb(kind, static_cast<int>(shape % kPriorLengths));
}

const AxisEvidence::Choice& AxisShapes::with(std::size_t shape) {
  const auto found = tried_.find(shape);
  if (found != tried_.end()) return found->second;
  const auto& choice = tried_.emplace(shape, evidence_.with_shape(shape, best_.lambda)).first->second;
  if (choice.log_evidence > best_.log_evidence) best_ = choice;
  return choice;
}

double AxisShapes::log_evidence(int kind, int place) {
  const int shape = kind * kPriorLengths + place;
  return with(static_cast<std::size_t>(shape)).log_evidence;
}

void AxisShapes::climb(int kind, int place) {
  for (const int step : {-1, 1}) {
    while (place + step >= 0 && place + step < kPriorLengths &&
           log_evidence(kind, place + step) > log_evidence(kind, place))
      place += step;
  }
}

std::size_t common_shape(std::vector<AxisShapes>& axes, int threads) {
  std::set<std::size_t> candidates;
  for (const AxisShapes& axis : axes) {
    for (const auto& [shape, choice] : axis.tried()) candidates.insert(shape);
  }
  run_parallel(axes.size(), threads, [&](std::size_t axis) {
    for (const std::size_t shape : candidates) axes[axis].with(shape);
  });
  std::size_t common = 0;
  double highest = -std::numeric_limits<double>::infinity();
  for (const std::size_t shape : candidates) {
    double sum = 0.0;
    for (AxisShapes& axis : axes) {
      const double shared = axis.with(shape).log_evidence;
      sum += std::max(shared, axis.best().log_evidence - kWorthADeparture);
    }
    if (sum <= highest) continue;
    highest = sum;
    common = shape;
  }
  return common;
}

}  // namespace volcal
