#pragma once
/// Evidence of the shapes that the functions of one axis may have (evidence.h), all other parameters
/// integrated out.

#include <Eigen/Core>
#include <map>
#include <vector>

#include "volcal/identify/solve/priors/smoothed_posterior.h"

namespace volcal {

/// Of log evidence, for an axis to have another shape than the others: very strong evidence (Kass and Raftery
/// 1995, JASA 90, 773).
inline constexpr double kWorthADeparture = 5.0;

/// The functions of one axis, all other parameters integrated out with their hyperparameters held.
class AxisEvidence {
 public:
  struct Choice {
    std::size_t shape = 0;
    std::vector<double> lambda;
    double log_evidence = 0.0;
  };

  /// `all`: everything but the smoothing of these functions; `stretches` within `all`.
  AxisEvidence(const Quadratic& all, const Eigen::VectorXd& z0, const std::vector<Stretch>& stretches);

  const Quadratic& cost() const { return cost_; }
  const Eigen::VectorXd& z0() const { return z0_; }
  const std::vector<Stretch>& stretches() const { return stretches_; }

  /// Of the one function that it is about.
  double log_evidence(const Prior& prior, double lambda) const;

  /// A shape with its amplitudes, from those given.
  Choice with_shape(std::size_t shape, std::vector<double> lambda) const;

 private:
  std::vector<Stretch> stretches_;
  Eigen::VectorXd z0_;
  Quadratic cost_;
};

/// Amplitude at which evidence and a prior on it, a exp(-a / kUsualAmplitude), are highest together; lambda.
double widened_lambda(const AxisEvidence& evidence, const Prior& prior);

/// Shapes tried for one axis: around the best length of every kind, and those asked for.
class AxisShapes {
 public:
  AxisShapes(AxisEvidence evidence, std::size_t shape, const std::vector<double>& lambda);

  const AxisEvidence::Choice& best() const { return best_; }
  const std::map<std::size_t, AxisEvidence::Choice>& tried() const { return tried_; }

  /// Amplitudes start from those of the best shape so far.
  const AxisEvidence::Choice& with(std::size_t shape);

 private:
  double log_evidence(int kind, int place);
  /// From a place to the nearest length that is better than its neighbours.
  void climb(int kind, int place);

  AxisEvidence evidence_;
  AxisEvidence::Choice best_;
  std::map<std::size_t, AxisEvidence::Choice> tried_;
};

/// The shape that most becomes all axes when each may depart from it at the price of kWorthADeparture.
std::size_t common_shape(std::vector<AxisShapes>& axes, int threads);

}  // namespace volcal
