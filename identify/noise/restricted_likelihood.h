#pragma once
/// Restricted likelihood of a noise model: what the readings say about the noise once the linear model has
/// been allowed to explain all it can.
///
/// y = J x + e, e ~ N(0, Sigma), x ~ N(m, P^-1) where P is regular and free elsewhere. With x integrated out
/// (Patterson and Thompson 1971, Biometrika 58, 545; Harville 1977, JASA 72, 320)
///
///   -2 l = log|Sigma| + log|J^T Sigma^-1 J + P| - log|P|_+ + min_x (|y - J x|^2_Sigma + |x - m|^2_P)
///          + (N - p + rank P) log 2 pi
///
/// The values hold for given columns of J: models with different columns cannot be compared by them. What
/// neither the readings nor the prior determine is left out of x, and p counts what remains. Directions to
/// which white readings contribute less than kMinInformation of the information are held where white readings
/// and the prior put them: the prior decides, whatever the noise. With white noise as stated nothing changes
/// by it; with other noise each changes l by the order of kMinInformation times the ratio of its variance to
/// the stated.

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "volcal/identify/noise/local_rows.h"
#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/numeric/shared_matrix.h"

namespace volcal {

inline constexpr double kMinInformation = 1e-3;

/// The linear model about the current adjustment.
struct NoiseProblem {
  SharedMatrix jacobian;  ///< N x p
  /// The first columns of `jacobian` once more; null = not known to be local. Only makes projections faster.
  std::shared_ptr<const LocalRows> local;
  Eigen::VectorXd residual;         ///< N, reading minus prediction, m or rad
  Eigen::MatrixXd prior_precision;  ///< p x p, positive semidefinite; empty = none
  Eigen::VectorXd prior_mean;       ///< p, of the correction x; empty = 0
  NoiseData data;
  /// Point visited, per observation, negative = none; empty = no repeated points. Only starts the search.
  std::vector<std::int64_t> point;
};

class RestrictedLikelihood {
 public:
  /// Copies what it needs (N x p once). Errors: std::invalid_argument for sizes that do not agree.
  RestrictedLikelihood(const NoiseProblem& problem, int threads);

  /// Sums [J y]^T Sigma^-1 [J y] of one or more groups, in the variables of the class.
  struct Share {
    Eigen::MatrixXd gram;
    double log_determinant = 0.0;  ///< of Sigma
  };
  struct Solution {
    Eigen::VectorXd at;            ///< minimum, in the variables of the class
    double log_information = 0.0;  ///< log|J^T Sigma^-1 J + P|, same variables
    double quadratic = 0.0;        ///< at the minimum
  };

  /// `problem`: the one of the constructor with other residuals. O(N p) in place of O(N p^2 + p^3), and equal
  /// to rounding to what is made anew: variables and information are those of the columns.
  void set_residual(const NoiseProblem& problem);

  std::size_t groups() const { return groups_.size(); }
  Eigen::Index variables() const { return transform_.cols(); }
  Share prior() const { return prior_; }
  /// The first ones that were asked for are kept: searches for other residuals begin at the same noise.
  Share share(std::size_t group, const NoiseParameters& noise);
  /// The residuals of a group were the solution `at`, in the order of group_data().
  Eigen::VectorXd residual(std::size_t group, const Eigen::VectorXd& at) const;
  /// log|Sigma_g| + r^T Sigma_g^-1 r of several noise models, faster together.
  std::vector<double> misfits(std::size_t group, std::span<const NoiseParameters> noises,
                              const Eigen::VectorXd& residual);
  /// Infinite quadratic when the sum is not positive definite.
  static Solution solve(const Eigen::MatrixXd& gram);

  /// Log restricted likelihood from the total of all shares and the prior.
  double log_likelihood(const Share& total) const;
  double log_likelihood(const std::vector<NoiseParameters>& noise);
  /// x of the problem.
  Eigen::VectorXd coefficients(const Eigen::VectorXd& at) const { return first_ + transform_ * at; }

  /// Observations of a group that are not left out.
  const NoiseData& group_data(std::size_t group) const { return groups_[group].data; }
  const std::vector<std::int64_t>& group_points(std::size_t group) const { return groups_[group].point; }

 private:
  struct Group {
    NoiseData data;                        ///< group 0 of its own
    std::vector<std::size_t> observation;  ///< of the problem
    std::vector<std::int64_t> point;
    Eigen::MatrixXd rows;  ///< the first variables + 1 x observations: J^T and y^T
    Eigen::Index variables = 0;
    std::vector<Whitener> whitener;  ///< one; empty until the data are there

    auto own_rows() const { return rows.topRows(variables + 1); }
  };
  void split(const NoiseProblem& problem);
  void transform(const NoiseProblem& problem);
  void carry_rows();
  void set_pull(const Eigen::MatrixXd& precision, const Eigen::VectorXd& mean);
  Share with_present_residual(std::size_t group, const NoiseParameters& noise, Share share);
  Eigen::MatrixXd prior_in_variables(const Eigen::MatrixXd& precision) const;
  void hold_what_the_prior_decides(const Eigen::MatrixXd& precision);

  /// A share that was asked for, and of which residuals.
  struct KnownShare {
    std::size_t group;
    NoiseParameters noise;
    std::size_t residual;
    Share share;
  };

  std::vector<Group> groups_;
  Eigen::MatrixXd transform_;  ///< x = first + transform at
  Eigen::MatrixXd all_;        ///< transform before what the prior decides was held
  Eigen::VectorXd first_;      ///< estimate with white noise
  Share prior_;
  double constant_ = 0.0;
  int threads_;
  std::size_t residual_ = 0;       ///< counts those that were set
  std::vector<KnownShare> known_;  ///< the first ones: where searches begin
};

}  // namespace volcal
