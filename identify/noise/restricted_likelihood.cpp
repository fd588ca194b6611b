#include "volcal/identify/noise/restricted_likelihood.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {
namespace {

constexpr double kSingular = 1e-12;            // of the largest eigenvalue, columns scaled to one
constexpr Eigen::Index kCarried = 4096;        // observations at once
constexpr std::size_t kKnownShares = 12;       // of a group
constexpr Eigen::Index kWorthThreads = 10000;  // observations: one column of fewer is done before threads are

void require_consistent(bool condition, const char* problem) {
  if (!condition) throw std::invalid_argument(std::string("restricted likelihood: ") + problem);
}

Eigen::MatrixXd prior_precision(const NoiseProblem& problem) {
  const Eigen::Index p = problem.jacobian.cols();
  return problem.prior_precision.size() > 0 ? problem.prior_precision : Eigen::MatrixXd::Zero(p, p);
}

struct LogPseudoDeterminant {
  double value = 0.0;
  int rank = 0;
};

LogPseudoDeterminant log_pseudo_determinant(const Eigen::MatrixXd& symmetric) {
  LogPseudoDeterminant result;
  if (symmetric.size() == 0 || symmetric.isZero(0.0)) return result;
  const Eigen::VectorXd values = eigen_decomposition(symmetric).values;
  for (const double value : values) {
    if (value <= kSingular * values.maxCoeff()) continue;
    result.value += std::log(value);
    ++result.rank;
  }
  return result;
}

}  // namespace

RestrictedLikelihood::RestrictedLikelihood(const NoiseProblem& problem, int threads) : threads_(threads) {
  const Eigen::Index n = problem.jacobian.rows(), p = problem.jacobian.cols();
  const auto count = static_cast<std::size_t>(n);
  require_consistent(problem.residual.size() == n && problem.data.sigma.size() == count,
                     "one residual and sigma per row");
  require_consistent(problem.point.empty() || problem.point.size() == count, "one point per row, or none");
  require_consistent(problem.prior_precision.size() == 0 ||
                         (problem.prior_precision.rows() == p && problem.prior_precision.cols() == p),
                     "the prior precision is p x p, or empty");
  require_consistent(problem.prior_mean.size() == 0 || problem.prior_mean.size() == p,
                     "the prior mean has p elements");
  use_single_threaded_blas();
  split(problem);
  transform(problem);
}

void RestrictedLikelihood::split(const NoiseProblem& problem) {
  for (const NoiseSequence& sequence : problem.data.sequences) {
    if (sequence.group >= groups_.size()) groups_.resize(sequence.group + 1);
    Group& group = groups_[sequence.group];
    NoiseSequence own;
    for (std::size_t k = 0; k < sequence.observation.size(); ++k) {
      const std::size_t i = sequence.observation[k];
      require_consistent(i < problem.data.sigma.size(),
                         "a sequence names an observation that does not exist");
      if (!std::isfinite(problem.data.sigma[i])) continue;
      own.observation.push_back(group.observation.size());
      if (!sequence.time.empty()) own.time.push_back(sequence.time[k]);
      if (!sequence.line.empty()) own.line.push_back(sequence.line[k]);
      group.observation.push_back(i);
      group.data.sigma.push_back(problem.data.sigma[i]);
      if (!problem.data.length.empty()) group.data.length.push_back(problem.data.length[i]);
      if (!problem.point.empty()) group.point.push_back(problem.point[i]);
    }
    group.data.sequences.push_back(std::move(own));
  }
  const Eigen::Index p = problem.jacobian.cols();
  for (Group& group : groups_) {
    group.rows.resize(p + 1, static_cast<Eigen::Index>(group.observation.size()));
    group.variables = p;
    for (Eigen::Index k = 0; k < group.rows.cols(); ++k) {
      const auto i = static_cast<Eigen::Index>(group.observation[static_cast<std::size_t>(k)]);
      group.rows.col(k).head(p) = problem.jacobian.row(i).transpose();
      group.rows(p, k) = problem.residual(i);
    }
    group.whitener.emplace_back(group.data, std::vector<NoiseParameters>(1));
  }
}

Eigen::MatrixXd RestrictedLikelihood::prior_in_variables(const Eigen::MatrixXd& precision) const {
  Eigen::MatrixXd carried = Eigen::MatrixXd::Zero(precision.rows(), variables());
  add_transposed_product(precision, transform_, carried);
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(variables(), variables());
  add_transposed_product(transform_, carried, prior);
  return prior;
}

/// From variables in which the information of white noise is the identity to those of them that the readings
/// speak about: the share of the prior in each is an eigenvalue of its precision there.
void RestrictedLikelihood::hold_what_the_prior_decides(const Eigen::MatrixXd& precision) {
  if (precision.isZero(0.0) || transform_.cols() == 0) return;
  const SymmetricEigen share = eigen_decomposition(prior_in_variables(precision));
  const auto kept = static_cast<Eigen::Index>((share.values.array() <= 1.0 - kMinInformation).count());
  const Eigen::MatrixXd all = transform_.transpose();
  transform_.setZero(precision.rows(), kept);
  add_transposed_product(all, share.vectors.leftCols(kept), transform_);
}

/// Variables in which the information of white noise is the identity, measured from their white estimate.
void RestrictedLikelihood::transform(const NoiseProblem& problem) {
  const Eigen::Index p = problem.jacobian.cols();
  const Eigen::MatrixXd precision = prior_precision(problem);
  Eigen::MatrixXd information = precision;
  for (std::size_t g = 0; g < groups_.size(); ++g) information += share(g, {}).gram.topLeftCorner(p, p);
  const Eigen::VectorXd scale =
      information.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
  const SymmetricEigen eigen = eigen_decomposition(scale.asDiagonal() * information * scale.asDiagonal());
  const double least = p > 0 ? kSingular * eigen.values.maxCoeff() : 0.0;
  const auto kept = static_cast<Eigen::Index>((eigen.values.array() > least).count());
  transform_ = scale.asDiagonal() * eigen.vectors.rightCols(kept) *
               eigen.values.tail(kept).cwiseSqrt().cwiseInverse().asDiagonal();
  double log_transform = -0.5 * eigen.values.tail(kept).array().log().sum();
  for (const double s : scale) log_transform += s > 0.0 ? std::log(s) : 0.0;

  const Eigen::VectorXd mean = problem.prior_mean.size() > 0 ? problem.prior_mean : Eigen::VectorXd::Zero(p);
  Eigen::VectorXd right = precision * mean;
  for (const Group& group : groups_) {
    const Eigen::Map<const Eigen::ArrayXd> sigma(group.data.sigma.data(), group.rows.cols());
    right += group.rows.topRows(p) * (group.rows.row(p).transpose().array() / sigma.square()).matrix();
  }
  first_ = transform_ * (transform_.transpose() * right);  // the inverse of the information is T T^T
  const auto determined = static_cast<double>(kept);
  all_ = transform_;
  hold_what_the_prior_decides(precision);
  carry_rows();
  known_.clear();  // of the rows as they were

  prior_.gram.resize(variables() + 1, variables() + 1);
  prior_.gram.topLeftCorner(variables(), variables()) = prior_in_variables(precision);
  set_pull(precision, mean);

  const LogPseudoDeterminant of_prior = log_pseudo_determinant(precision);
  auto freedom = static_cast<double>(of_prior.rank) - determined;
  for (const Group& group : groups_) freedom += static_cast<double>(group.observation.size());
  constant_ = freedom * std::log(2.0 * std::numbers::pi) - of_prior.value - 2.0 * log_transform;
}

/// What the prior says of the residuals.
void RestrictedLikelihood::set_pull(const Eigen::MatrixXd& precision, const Eigen::VectorXd& mean) {
  const Eigen::VectorXd pull = mean - first_;
  prior_.gram.col(variables()).head(variables()) = transform_.transpose() * (precision * pull);
  prior_.gram.row(variables()).head(variables()) = prior_.gram.col(variables()).head(variables()).transpose();
  prior_.gram(variables(), variables()) = pull.dot(precision * pull);
}

void RestrictedLikelihood::set_residual(const NoiseProblem& problem) {
  require_consistent(
      problem.jacobian.cols() == all_.rows() && problem.residual.size() == problem.jacobian.rows(),
      "other residuals are of the same problem");
  const Eigen::Index p = problem.jacobian.cols();
  const Eigen::MatrixXd precision = prior_precision(problem);
  const Eigen::VectorXd mean = problem.prior_mean.size() > 0 ? problem.prior_mean : Eigen::VectorXd::Zero(p);
  Eigen::VectorXd weighed = Eigen::VectorXd::Zero(problem.residual.size());
  for (const Group& group : groups_) {
    for (std::size_t k = 0; k < group.observation.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(group.observation[k]);
      weighed(i) = problem.residual(i) / (group.data.sigma[k] * group.data.sigma[k]);
    }
  }
  const Eigen::VectorXd right = precision * mean + problem.jacobian.transpose() * weighed;
  first_ = all_ * (all_.transpose() * right);
  const Eigen::VectorXd left = problem.residual - problem.jacobian * first_;
  for (Group& group : groups_) {
    for (std::size_t k = 0; k < group.observation.size(); ++k)
      group.rows(group.variables, static_cast<Eigen::Index>(k)) =
          left(static_cast<Eigen::Index>(group.observation[k]));
  }
  set_pull(precision, mean);
  ++residual_;
}

/// Observations in the variables, residuals from the white estimate; in place, since they are large.
void RestrictedLikelihood::carry_rows() {
  const Eigen::Index p = transform_.rows(), kept = transform_.cols();
  Eigen::MatrixXd carry = Eigen::MatrixXd::Zero(p + 1, kept + 1);
  carry.topLeftCorner(p, kept) = transform_;
  carry.col(kept) << -first_, 1.0;
  for (Group& group : groups_) {
    const Eigen::Index count = group.rows.cols();
    run_parallel(static_cast<std::size_t>((count + kCarried - 1) / kCarried), threads_,
                 [&](std::size_t block) {
                   const Eigen::Index first = static_cast<Eigen::Index>(block) * kCarried;
                   auto own = group.rows.middleCols(first, std::min(kCarried, count - first));
                   Eigen::MatrixXd carried = Eigen::MatrixXd::Zero(kept + 1, own.cols());
                   add_transposed_product(carry, own, carried);
                   own.topRows(kept + 1) = carried;
                 });
    group.variables = kept;
  }
}

RestrictedLikelihood::Share RestrictedLikelihood::share(std::size_t group, const NoiseParameters& noise) {
  const auto known = std::ranges::find_if(
      known_, [&](const KnownShare& each) { return each.group == group && each.noise == noise; });
  if (known != known_.end()) {
    if (known->residual != residual_) {
      known->share = with_present_residual(group, noise, std::move(known->share));
      known->residual = residual_;
    }
    return known->share;
  }
  Whitener& whitener = groups_[group].whitener.front();
  whitener.set_parameters({&noise, 1});
  Share found{whitener.gram(groups_[group].own_rows(), threads_), whitener.log_determinant()};
  if (known_.size() < kKnownShares * groups_.size()) known_.push_back({group, noise, residual_, found});
  return found;
}

/// Its products with the residuals anew.
RestrictedLikelihood::Share RestrictedLikelihood::with_present_residual(std::size_t group,
                                                                        const NoiseParameters& noise,
                                                                        Share share) {
  const auto rows = groups_[group].own_rows();
  const Eigen::Index p = variables();
  Whitener& whitener = groups_[group].whitener.front();
  whitener.set_parameters({&noise, 1});
  const Eigen::VectorXd whitened = whitener.whiten(Eigen::VectorXd(rows.row(p).transpose()));
  const Eigen::VectorXd weighed = whitener.whiten_transposed(whitened);
  share.gram.col(p).head(p) = rows.topRows(p) * weighed;
  share.gram.row(p).head(p) = share.gram.col(p).head(p).transpose();
  share.gram(p, p) = whitened.squaredNorm();
  return share;
}

Eigen::VectorXd RestrictedLikelihood::residual(std::size_t group, const Eigen::VectorXd& at) const {
  const auto rows = groups_[group].own_rows();
  return rows.row(at.size()).transpose() - rows.topRows(at.size()).transpose() * at;
}

std::vector<double> RestrictedLikelihood::misfits(std::size_t group, std::span<const NoiseParameters> noises,
                                                  const Eigen::VectorXd& residual) {
  Whitener& whitener = groups_[group].whitener.front();
  if (!whitener.has_open_lines())
    return whitener.misfits(noises, residual, residual.size() < kWorthThreads ? 1 : threads_);
  std::vector<double> all;
  for (const NoiseParameters& noise : noises) {
    whitener.set_parameters({&noise, 1});
    all.push_back(whitener.log_determinant() + whitener.whiten(residual).squaredNorm());
  }
  return all;
}

RestrictedLikelihood::Solution RestrictedLikelihood::solve(const Eigen::MatrixXd& gram) {
  const Eigen::Index p = gram.rows() - 1;
  const auto lower = cholesky_lower(gram);
  if (!lower) return {Eigen::VectorXd::Zero(p), 0.0, std::numeric_limits<double>::infinity()};
  const double last = (*lower)(p, p);
  return {lower->topLeftCorner(p, p).triangularView<Eigen::Lower>().transpose().solve(
              Eigen::VectorXd(lower->row(p).head(p))),
          2.0 * lower->diagonal().head(p).array().log().sum(), last * last};
}

double RestrictedLikelihood::log_likelihood(const Share& total) const {
  const Solution solution = solve(total.gram);
  return -0.5 * (total.log_determinant + solution.log_information + solution.quadratic + constant_);
}

double RestrictedLikelihood::log_likelihood(const std::vector<NoiseParameters>& noise) {
  require_consistent(noise.size() >= groups_.size(), "parameters for every group");
  Share total = prior_;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const Share own = share(g, noise[g]);
    total.gram += own.gram;
    total.log_determinant += own.log_determinant;
  }
  return log_likelihood(total);
}

}  // namespace volcal
