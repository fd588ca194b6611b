#include "volcal/identify/montecarlo/weak_parameters.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/adjustment.h"

namespace volcal {

struct WeakParameter {
  Eigen::Index reduced = 0;
  int raw = 0;
  double u = 0.0;
  double share = 0.0;  ///< of the variance before the readings
};

/// What the derivatives of the observations change for a raw parameter: half of the difference at one
/// standard deviation above and below, over the deviation. Reduced parameters; observations that change.
struct SecondDerivatives {
  std::vector<Eigen::Index> rows;
  Eigen::MatrixXd of_row;  ///< rows x parameters
};

namespace {

constexpr double kHardlyDetermined = 0.05;  // of the variance before the readings
constexpr double kFelt = 0.01;        // second-order change at one standard deviation, in units of the noise
constexpr double kMixedFelt = 0.002;  // the same of a pattern of mixed derivatives
constexpr std::size_t kMost = 24;
constexpr Eigen::Index kMostPatterns = 10;  // of a weak parameter
constexpr Eigen::Index kMostPivots = 40;
constexpr std::size_t kMostMixed =
    40;  // patterns of all weak parameters: a draw's linear systems have twice as many unknowns
constexpr int kMostSteps = 30;
constexpr double kSettled = 1e-5;  // of a step, standard deviations
constexpr double kNear = 1.0;      // of the last step, for a solution to be taken
constexpr double kLost = 1e3;
constexpr double kShortestShare = 1e-3;

/// Those with a statement that the readings hardly improve, the least determined first.
std::vector<WeakParameter> hardly_determined(const RepeatedCampaign& campaign) {
  std::vector<WeakParameter> weak;
  const Eigen::VectorXd stated = campaign.result().adjustment->prior.precision.diagonal();
  for (const auto& block : campaign.datum().blocks()) {
    for (int k = 0; k < block.size; ++k) {
      const Eigen::Index at = block.offset + k;
      const double variance = campaign.gain()(at, at), share = variance * stated[at];
      if (share > kHardlyDetermined) weak.push_back({at, block.raw_offset + k, std::sqrt(variance), share});
    }
  }
  std::ranges::stable_sort(weak, std::greater{}, &WeakParameter::share);
  if (weak.size() > kMost) weak.resize(kMost);
  std::ranges::sort(weak, {}, &WeakParameter::reduced);
  return weak;
}

SecondDerivatives second_derivatives(const RepeatedCampaign& campaign, const WeakParameter& parameter) {
  const MeasurementModel& model = campaign.linear_model().model();
  Eigen::VectorXd above = campaign.result().parameters, below = above;
  above[parameter.raw] += parameter.u;
  below[parameter.raw] -= parameter.u;
  std::vector<Eigen::VectorXd> changes;
  SecondDerivatives second;
  RowJacobian row_above, row_below;
  for (std::size_t i = 0; i < campaign.linear_model().size(); ++i) {
    const ObservationPlace& place = campaign.linear_model().observations()[i];
    if (place.channel == 0) {
      model.linearize(place.setup, place.row, above, row_above);
      model.linearize(place.setup, place.row, below, row_below);
    }
    const Eigen::VectorXd change = dense_row(model.layout(), row_above, place.channel) -
                                   dense_row(model.layout(), row_below, place.channel);
    if (change.isZero(0.0)) continue;
    second.rows.push_back(static_cast<Eigen::Index>(i));
    changes.push_back(change / (2.0 * parameter.u));
  }
  Eigen::MatrixXd raw(static_cast<Eigen::Index>(changes.size()), model.layout().size);
  for (std::size_t i = 0; i < changes.size(); ++i) raw.row(static_cast<Eigen::Index>(i)) = changes[i];
  second.of_row = campaign.datum().reduce_rows(raw);
  return second;
}

/// Columns whose products with their transpose are the covariance rows C rows^T but for `rest`, the trace of
/// what is left: principal axes, the largest first.
Eigen::MatrixXd principal_patterns(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& covariance,
                                   double rest) {
  const Eigen::MatrixXd moved = product(rows, covariance);
  Eigen::VectorXd left = (moved.array() * rows.array()).rowwise().sum();
  const Eigen::Index most = std::min(kMostPivots, rows.rows());
  Eigen::MatrixXd factor(rows.rows(), most);
  Eigen::Index count = 0;
  for (; count < most && left.cwiseMax(0.0).sum() > rest; ++count) {
    Eigen::Index pivot = 0;
    const double largest = left.maxCoeff(&pivot);
    if (!(largest > 0.0)) break;
    Eigen::VectorXd column = rows * moved.row(pivot).transpose();
    column -= factor.leftCols(count) * factor.row(pivot).head(count).transpose();
    factor.col(count) = column / std::sqrt(largest);
    left -= factor.col(count).cwiseAbs2();
  }
  const Eigen::MatrixXd kept = factor.leftCols(count);
  return (kept * eigen_decomposition(kept.transpose() * kept).vectors).rowwise().reverse();
}

}  // namespace

/// Of a draw: x and G^T d.
struct WeakParameters::Unknowns {
  Eigen::VectorXd x;
  Eigen::VectorXd s;
};

/// One of the products: what it does to all observations, and its second factor.
struct WeakParameters::Pattern {
  Eigen::VectorXd observations;  ///< column of Q
  Eigen::VectorXd weighed;
  Eigen::VectorXd feature;  ///< column of F
  Eigen::Index owner = 0;

  double felt() const { return std::sqrt(std::max(0.0, observations.dot(weighed))); }
};

struct WeakParameters::Terms {
  std::vector<WeakParameter> parameters;
  std::vector<SecondDerivatives> second;
  std::vector<Pattern> squares;
  std::vector<Pattern> mixed;
};

WeakParameters::WeakParameters(const RepeatedCampaign& campaign) : campaign_(campaign) {
  Terms terms;
  for (const WeakParameter& parameter : hardly_determined(campaign)) {
    SecondDerivatives second = second_derivatives(campaign, parameter);
    Pattern square{Eigen::VectorXd::Zero(campaign.observations()), {}, {}, size()};
    square.observations(second.rows) = parameter.u * parameter.u * second.of_row.col(parameter.reduced);
    square.weighed = campaign.whitener().weigh(square.observations);
    if (!(0.5 * square.felt() > kFelt)) continue;
    square.feature = Eigen::VectorXd::Unit(campaign.parameters(), parameter.reduced) / parameter.u;
    which_.push_back(parameter.reduced);
    terms.parameters.push_back(parameter);
    terms.second.push_back(std::move(second));
    terms.squares.push_back(std::move(square));
  }
  if (which_.empty()) return;
  for (Eigen::Index weak = 0; weak < size(); ++weak) add_mixed(weak, terms);
  keep(std::move(terms));
}

/// The patterns of mixed derivatives of one weak parameter.
void WeakParameters::add_mixed(Eigen::Index weak, Terms& terms) const {
  const auto at = static_cast<std::size_t>(weak);
  const WeakParameter& parameter = terms.parameters[at];
  const SecondDerivatives& second = terms.second[at];
  const Pattern& square = terms.squares[at];
  Eigen::MatrixXd rows = second.of_row;
  rows(Eigen::all, which_) *= 0.5;
  rows.col(parameter.reduced).setZero();
  // Of a number that a reading changes by, how far it is felt, in units of the noise.
  const double felt =
      parameter.u * std::sqrt(square.observations.dot(square.weighed) / square.observations.squaredNorm());
  const double enough = std::pow(kMixedFelt / felt, 2);
  const Eigen::MatrixXd patterns = principal_patterns(rows, campaign_.gain(), enough);
  for (Eigen::Index k = 0; k < std::min(patterns.cols(), kMostPatterns); ++k) {
    const double squared = patterns.col(k).squaredNorm();
    if (squared < enough) break;
    Pattern mixed{Eigen::VectorXd::Zero(campaign_.observations()), {}, {}, weak};
    mixed.feature = rows.transpose() * patterns.col(k) / squared;  // of unit variance, as C is the covariance
    mixed.observations(second.rows) = parameter.u * patterns.col(k);
    mixed.weighed = campaign_.whitener().weigh(mixed.observations);
    terms.mixed.push_back(std::move(mixed));
  }
}

void WeakParameters::keep(Terms terms) {
  std::ranges::stable_sort(terms.mixed, std::greater{}, &Pattern::felt);
  if (terms.mixed.size() > kMostMixed) terms.mixed.erase(terms.mixed.begin() + kMostMixed, terms.mixed.end());
  std::vector<Pattern>& all = terms.squares;
  std::ranges::move(terms.mixed, std::back_inserter(all));
  const auto count = static_cast<Eigen::Index>(all.size());
  Eigen::MatrixXd whole(campaign_.observations(), count);
  features_.resize(campaign_.parameters(), count);
  strength_.resize(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    const Pattern& one = all[static_cast<std::size_t>(a)];
    owner_.push_back(one.owner);
    whole.col(a) = one.weighed;
    features_.col(a) = one.feature;
    for (Eigen::Index b = 0; b < count; ++b)
      strength_(a, b) = one.weighed.dot(all[static_cast<std::size_t>(b)].observations);
  }
  for (Eigen::Index row = 0; row < whole.rows(); ++row) {
    if (!whole.row(row).isZero(0.0)) rows_.push_back(row);
  }
  weighed_ = whole(rows_, Eigen::all);
  coupling_ = campaign_.linear_model().problem().jacobian.transpose() * whole;
  Eigen::MatrixXd both(campaign_.parameters(), 2 * count);
  both << features_, coupling_;
  of_unknowns_ = product(campaign_.gain(), both);
  among_ = both.transpose() * of_unknowns_;
}

/// phi.
Eigen::VectorXd WeakParameters::products(const Eigen::VectorXd& x) const {
  Eigen::VectorXd products = x(owner_).cwiseProduct(x);
  products.head(size()) *= 0.5;
  return products;
}

/// Of phi to x.
Eigen::MatrixXd WeakParameters::slopes(const Eigen::VectorXd& x) const {
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(x.size(), x.size());
  slopes.diagonal() = x(owner_);
  for (Eigen::Index k = size(); k < x.size(); ++k) slopes(k, owner_[static_cast<std::size_t>(k)]) = x[k];
  return slopes;
}

/// What the equations of a draw have on [F G]: d = linear - C [F G] load.
Eigen::VectorXd WeakParameters::load_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const {
  const Eigen::VectorXd phi = products(at.x);
  Eigen::VectorXd load(2 * phi.size());
  load << slopes(at.x).transpose() * (at.s + strength_ * phi - of_errors), phi;
  return load;
}

/// What is left of d = linear - C [F G] load, in the unknowns.
WeakParameters::Unknowns WeakParameters::error_of(const Unknowns& at, const Unknowns& start,
                                                  const Eigen::VectorXd& of_errors) const {
  const Eigen::Index count = at.x.size();
  const Eigen::VectorXd moved = among_ * load_at(at, of_errors);
  return {at.x - start.x + moved.head(count), at.s - start.s + moved.tail(count)};
}

/// Of error_of() to the unknowns.
Eigen::MatrixXd WeakParameters::slope_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const {
  Eigen::MatrixXd slope = among_ * curvature_at(at, of_errors);
  slope.diagonal().array() += 1.0;
  return slope;
}

/// What the second order adds to the curvature, on [F G].
Eigen::MatrixXd WeakParameters::curvature_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const {
  const Eigen::Index count = at.x.size();
  const Eigen::VectorXd h = at.s + strength_ * products(at.x) - of_errors;
  const Eigen::MatrixXd slope = slopes(at.x);
  Eigen::MatrixXd added = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  added.topLeftCorner(count, count) = slope.transpose() * strength_ * slope;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index owner = owner_[static_cast<std::size_t>(k)];
    added(owner, k) += h[k];
    if (owner != k) added(k, owner) += h[k];
  }
  added.topRightCorner(count, count) = slope.transpose();
  added.bottomLeftCorner(count, count) = slope;
  return added;
}

/// The move that makes an error vanish to first order.
WeakParameters::Unknowns WeakParameters::solved(const Eigen::PartialPivLU<Eigen::MatrixXd>& slope,
                                                const Unknowns& error) {
  const Eigen::Index count = error.x.size();
  Eigen::VectorXd both(2 * count);
  both << error.x, error.s;
  both = slope.solve(both).eval();
  return {both.head(count), both.tail(count)};
}

WeakParameters::Solution WeakParameters::solve(const CampaignDraw& draw,
                                               const Eigen::VectorXd& linear) const {
  if (which_.empty()) return {linear, {}, 0.0};
  const Eigen::VectorXd of_errors = weighed_.transpose() * draw.errors(rows_);
  const Unknowns start{features_.transpose() * linear, coupling_.transpose() * linear};
  const Eigen::Index count = start.x.size();
  // The valley of a wide parameter bends by many standard deviations: the others follow it before the first
  // step.
  Unknowns at{start.x, start.s - among_.bottomRightCorner(count, count) * products(start.x)};
  Unknowns error = error_of(at, start, of_errors);
  double length = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps && length > kSettled; ++step) {
    const Eigen::PartialPivLU<Eigen::MatrixXd> slope(slope_at(at, of_errors));
    const Unknowns move = solved(slope, error);
    length = move.x.norm();
    double share = 1.0, next_length = 0.0;
    Unknowns next;
    for (;; share *= 0.5) {
      next = {at.x - share * move.x, at.s - share * move.s};
      error = error_of(next, start, of_errors);
      next_length = solved(slope, error).x.norm();
      if (next_length <= (1.0 - 0.5 * share) * length || share < kShortestShare || length < kSettled) break;
    }
    if (!(next_length < kLost * (length + 1.0))) return {linear, {}, 0.0};
    at = std::move(next);
  }
  if (!(length < kNear)) return {linear, {}, 0.0};
  const Eigen::MatrixXd added = curvature_at(at, of_errors);
  const Eigen::VectorXd load = load_at(at, of_errors);
  return {linear - of_unknowns_ * load, slope_at(at, of_errors).transpose().partialPivLu().solve(added),
          std::sqrt(std::max(0.0, load.dot(among_ * load)))};
}

Eigen::VectorXd WeakParameters::inverse_curvature(const Solution& solution, const Eigen::VectorXd& gradient,
                                                  Eigen::VectorXd moved) const {
  if (solution.correction.size() == 0) return moved;
  return moved - of_unknowns_ * (solution.correction * (of_unknowns_.transpose() * gradient));
}

}  // namespace volcal
