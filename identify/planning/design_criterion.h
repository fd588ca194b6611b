#pragma once
/// What a design shall make small: the mean or the largest variance of linear functionals of the parameters.
///
/// With information M = sum of j j^T / sigma^2 over the readings, plus the precision of what is known
/// beforehand, and functionals f_k,
///
///   mean      1/K sum_k f_k^T M^-1 f_k                      A- or L-optimality; one functional: c-optimality
///   largest   (1/K sum_k (f_k^T M^-1 f_k)^q)^(1/q), q = 12   minimax, smoothed so that it has a slope
///   everywhere
///
/// (Fedorov 1972, Theory of Optimal Experiments; Atkinson, Donev and Tobias 2007, Optimum Experimental
/// Designs, with SAS, 10). Both are convex in M. A reading j lowers them at the rate j^T M^-1 B M^-1 j /
/// sigma^2, B the functionals' sum weighted by their share of the slope.

#include <Eigen/Core>
#include <optional>

namespace volcal {

enum class Aggregate { Mean, Largest };

class DesignCriterion {
 public:
  /// `functionals`: one a row, in the leading parameters; further parameters do not enter.
  DesignCriterion(Eigen::MatrixXd functionals, Aggregate aggregate);

  /// At an information matrix (upper triangle read) of at least as many parameters; nullopt when it is not
  /// positive definite.
  std::optional<double> value(const Eigen::MatrixXd& information) const;

  struct State {
    double value = 0.0;
    Eigen::MatrixXd covariance;  ///< M^-1
    Eigen::MatrixXd root;        ///< R with R R^T = M^-1 B M^-1
  };
  std::optional<State> state(const Eigen::MatrixXd& information) const;

  /// Of every functional, from the covariance of the parameters.
  Eigen::VectorXd variances(const Eigen::MatrixXd& covariance) const;
  const Eigen::MatrixXd& functionals() const { return functionals_; }
  Aggregate aggregate() const { return aggregate_; }

 private:
  double aggregated(const Eigen::VectorXd& variances) const;

  Eigen::MatrixXd functionals_;
  Aggregate aggregate_;
  Eigen::MatrixXd mean_root_;  ///< parameters x rank: B = mean_root mean_root^T of the mean
};

}  // namespace volcal
