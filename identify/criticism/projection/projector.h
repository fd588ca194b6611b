#pragma once
/// What remains of candidate effects once the model has been allowed to imitate them.
///
/// With Sigma = L L^T, J_w = L^-1 J, prior precision P and A = J_w^T J_w + P, the columns g of a candidate
/// become, projected off the model, g~ with
///
///   g~^T g~ = g_w^T g_w - b^T A^-1 b,    g~^T r~ = g_w^T r_w - b^T A^-1 (J_w^T r_w + P m),    b = J_w^T g_w
///
/// (added variables in generalised least squares; the prior counts as further observations). Nothing of size
/// N x N and no orthogonal basis is formed. Where the problem tells which columns are local (local_rows.h),
/// their part of b is J^T (Sigma^-1 g), knot cell by knot cell, equal to rounding, and no whitened row of
/// them is kept: hundreds of megabytes at 10^5 readings.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "volcal/identify/criticism/projection/local_product.h"
#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/noise/restricted_likelihood.h"

namespace volcal {

/// Columns that are best made and projected at once: a product with them fills a cache, their rows fit it.
inline constexpr Eigen::Index kBlockColumns = 256;

/// Columns of candidates, made part by part of the observations.
struct CandidateColumns {
  Eigen::Index count = 0;
  std::vector<Eigen::Index> groups;  ///< widths: neighbours that are tested together
  /// Rows of a part.
  std::function<void(std::size_t part, Eigen::Ref<Eigen::MatrixXd> rows)> fill;
};

/// Columns of candidates after projection; k columns.
struct ProjectedColumns {
  Eigen::VectorXd score;               ///< g~^T r~
  Eigen::VectorXd norm;                ///< |g_w|: what would be seen if everything else were known
  std::vector<Eigen::Index> first;     ///< column of each group
  std::vector<Eigen::MatrixXd> grams;  ///< g~^T g~ of each group

  Eigen::Index count() const { return score.size(); }
  /// g~^T g~ of a stretch of columns of one group.
  Eigen::MatrixXd gram(Eigen::Index begin, Eigen::Index columns) const;
};

class Projector {
 public:
  /// `data` may leave out observations of the problem (infinite sigma). `parts`: boundaries 0 ... N of
  /// stretches of observations that hold whole sequences; empty = one part.
  Projector(const NoiseProblem& problem, const NoiseData& data, std::span<const NoiseParameters> noise,
            int threads, std::vector<Eigen::Index> parts = {});

  /// On the caller's thread; may be called from several at once. Memory: the columns of the largest part.
  ProjectedColumns project(const CandidateColumns& candidates) const;
  /// One group.
  ProjectedColumns project(const Eigen::MatrixXd& columns) const;
  /// Parameters of the model, accepted columns last, with which it imitates columns best; parameters x k.
  Eigen::MatrixXd imitation(const Eigen::MatrixXd& columns) const;
  /// Takes columns into the model, without prior: their products alone are made, and the rows that they add
  /// to the factor. A copy shares the rows of the model with its original.
  void accept(const Eigen::MatrixXd& columns);
  /// Of the same columns with other residuals, of all observations; equal to rounding to what is made of them
  /// anew.
  Projector with_residual(const Eigen::VectorXd& residual) const;
  /// Sigma^-1 (columns - J times their imitation), of all observations, 0 where they are left out: with
  /// columns g their products are g~^T times these columns after projection.
  Eigen::MatrixXd weighed_projection(const Eigen::MatrixXd& columns) const;

  /// Correction of the model's parameters, accepted columns last, from the observations in use.
  Eigen::VectorXd solution() const;
  /// Sigma^-1 (y - J x) at the solution x, of all observations, 0 where they are left out: its products with
  /// columns g are g~^T r~.
  Eigen::VectorXd weighed_residual() const;
  /// C^-1 rows^T with A = C C^T, parameters x rows (derivatives to all parameters, accepted ones last): the
  /// products of its columns are rows A^-1 rows^T.
  Eigen::MatrixXd rotated_rows(const Eigen::MatrixXd& rows) const;
  /// D, parameters x count: rows D is the transpose of the last `count` rows of rotated_rows(), what columns
  /// that were accepted last add to products.
  Eigen::MatrixXd last_directions(Eigen::Index count) const;
  /// Variance of predictions, one per row of `rows`.
  Eigen::VectorXd prediction_variance(const Eigen::MatrixXd& rows) const;
  /// Covariance of the accepted columns' amplitudes.
  Eigen::MatrixXd accepted_covariance() const;
  /// |r~|^2: what the model leaves, in units of the noise.
  double residual_squares() const;
  /// [J y]^T Sigma^-1 [J y], accepted columns last but for y; without prior.
  const Eigen::MatrixXd& gram() const { return gram_; }
  /// log|Sigma| of the observations in use.
  double log_determinant() const { return whitener_->log_determinant(); }
  std::size_t observations() const { return whitener_->observations(); }
  Eigen::Index parameters() const { return base_parameters_ + accepted(); }
  /// Readings and priors determine all parameters; else they are held where they are, weakly.
  bool is_regular() const { return is_regular_; }
  int threads() const { return threads_; }
  Eigen::Index accepted() const { return accepted_.front().cols(); }

 private:
  /// Products of columns with the model's, while parts are added.
  struct PartialProducts {
    Eigen::MatrixXd with_others;  ///< base columns that are not local
    Eigen::MatrixXd with_residual;
    Eigen::MatrixXd with_accepted;
    std::vector<Eigen::MatrixXd> with_local;  ///< of kColumnBlock columns each
  };

  /// Whitened rows of a part, in columns that do not vanish there, as those of other setups' own parameters
  /// do.
  struct PartRows {
    std::vector<Eigen::Index> column;  ///< among the model's, ascending
    Eigen::MatrixXd rows;
  };

  void set_local(const NoiseProblem& problem);
  PartRows whitened_with(const Eigen::MatrixXd& residual, std::size_t part) const;
  PartRows others_of(const PartRows& part) const;
  void add_to_gram(const PartRows& part, const Eigen::MatrixXd& gram);
  void add_products_with(const PartRows& others, const Eigen::MatrixXd& whitened,
                         Eigen::MatrixXd& products) const;
  void whiten_model(const Eigen::VectorXd& residual);
  void replace_residual(const Eigen::VectorXd& residual);
  void factorise();
  void rotate_residual();
  bool extend_factor(Eigen::Index more);
  /// `whitened` rows of a part less L^-1 of the model's rows times `at`.
  Eigen::MatrixXd left_of_part(std::size_t part, const Eigen::MatrixXd& whitened,
                               const Eigen::MatrixXd& at) const;
  /// Puts whitened rows of a part at their observations.
  void put_in_place(std::size_t part, const Eigen::MatrixXd& rows, Eigen::MatrixXd& all) const;
  /// L^-1 rows of a part of all observations.
  Eigen::MatrixXd whitened_part(std::size_t part, const Eigen::MatrixXd& columns) const;
  PartialProducts zero_products(Eigen::Index columns) const;
  /// Products of all columns, those with the residual last, parts added up; a part's whitened columns go to
  /// `visit(part, whitened)`, from several threads at once.
  Eigen::MatrixXd products_of(const Eigen::MatrixXd& columns,
                              const std::function<void(std::size_t, Eigen::MatrixXd)>& visit) const;
  /// Adds the products with a part's rows; gives L^-1 rows.
  Eigen::MatrixXd add_products(std::size_t part, const Eigen::MatrixXd& rows,
                               PartialProducts& products) const;
  /// (parameters + 1) x columns, those with the residual last.
  Eigen::MatrixXd combined(const PartialProducts& products, Eigen::Index columns) const;
  Eigen::Index local_columns() const { return local_product_ ? local_product_->columns() : 0; }
  Eigen::Index other_columns() const { return base_parameters_ - local_columns(); }
  std::size_t part_count() const { return parts_.size() - 1; }
  Eigen::Index part_rows(std::size_t part) const { return parts_[part + 1] - parts_[part]; }

  std::shared_ptr<const Whitener> whitener_;
  int threads_;
  std::shared_ptr<const LocalProduct> local_product_;
  Eigen::Index base_parameters_;
  std::vector<Eigen::Index> parts_;
  SharedMatrix jacobian_;
  std::shared_ptr<const std::vector<PartRows>> others_;           ///< per part, columns that are not local
  std::shared_ptr<const std::vector<Eigen::MatrixXd>> residual_;  ///< per part, one column
  std::vector<Eigen::MatrixXd> accepted_;                         ///< per part, the same of accepted columns
  Eigen::MatrixXd precision_;                                     ///< of the base parameters, not scaled
  Eigen::VectorXd pull_;                                          ///< P m, base parameters
  double prior_squares_ = 0.0;
  double residual_squares_ = 0.0;
  Eigen::MatrixXd gram_;
  Eigen::VectorXd scale_;
  bool is_regular_ = true;
  Eigen::MatrixXd lower_;    ///< C of the columns times scale_
  Eigen::VectorXd rotated_;  ///< C^-1 (J_w^T r_w + P m)
};

}  // namespace volcal
