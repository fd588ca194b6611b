#include "volcal/identify/montecarlo/weak_parameters.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "volcal/identify/solve/adjustment.h"

namespace volcal {
namespace {

constexpr double kHardlyDetermined = 0.05;  // of the variance before the readings
constexpr double kFelt = 0.01;  // second-order change at one standard deviation, in units of the noise
constexpr std::size_t kMost = 24;
constexpr int kMostSteps = 30;
constexpr double kSettled = 1e-9;
constexpr double kShortestShare = 1e-3;

struct WeakParameter {
  Eigen::Index reduced = 0;
  int raw = 0;
  double u = 0.0;
  double share = 0.0;  ///< of the variance before the readings
};

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

/// Derivatives of all observations to one raw parameter.
Eigen::VectorXd derivative(const RepeatedCampaign& campaign, const Eigen::VectorXd& parameters, int raw) {
  const MeasurementModel& model = campaign.linear_model().model();
  Eigen::VectorXd column(campaign.observations());
  RowJacobian row;
  for (std::size_t i = 0; i < campaign.linear_model().size(); ++i) {
    const ObservationPlace& place = campaign.linear_model().observations()[i];
    if (place.channel == 0) model.linearize(place.setup, place.row, parameters, row);
    column[static_cast<Eigen::Index>(i)] = dense_row(model.layout(), row, place.channel)[raw];
  }
  return column;
}

Eigen::VectorXd second_derivative(const RepeatedCampaign& campaign, const WeakParameter& parameter) {
  Eigen::VectorXd above = campaign.result().parameters, below = above;
  above[parameter.raw] += parameter.u;
  below[parameter.raw] -= parameter.u;
  return (derivative(campaign, above, parameter.raw) - derivative(campaign, below, parameter.raw)) /
         (2.0 * parameter.u);
}

}  // namespace

/// Of a draw: the weak parameters' deviations w, and c^T d.
struct WeakParameters::Unknowns {
  Eigen::VectorXd w;
  Eigen::VectorXd s;

  double norm() const { return std::sqrt(w.squaredNorm() + s.squaredNorm()); }
};

WeakParameters::WeakParameters(const RepeatedCampaign& campaign) : campaign_(campaign) {
  std::vector<Eigen::VectorXd> second, weighed;
  for (const WeakParameter& parameter : hardly_determined(campaign)) {
    Eigen::VectorXd own = second_derivative(campaign, parameter);
    Eigen::VectorXd own_weighed = campaign.whitener().weigh(own);
    const double felt = 0.5 * parameter.u * parameter.u * std::sqrt(std::max(0.0, own.dot(own_weighed)));
    if (!(felt > kFelt)) continue;
    which_.push_back(parameter.reduced);
    second.push_back(std::move(own));
    weighed.push_back(std::move(own_weighed));
  }
  const Eigen::Index count = size();
  if (count == 0) return;
  weighed_.resize(campaign.observations(), count);
  strength_.resize(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    weighed_.col(a) = weighed[static_cast<std::size_t>(a)];
    for (Eigen::Index b = 0; b < count; ++b)
      strength_(a, b) = weighed[static_cast<std::size_t>(a)].dot(second[static_cast<std::size_t>(b)]);
  }
  coupling_ = campaign.linear_model().problem().jacobian.transpose() * weighed_;
  of_unknowns_.resize(campaign.parameters(), 2 * count);
  of_unknowns_.leftCols(count) = campaign.gain()(Eigen::all, which_);
  of_unknowns_.rightCols(count) = campaign.gain() * coupling_;
  among_.resize(2 * count, 2 * count);
  among_.topRows(count) = of_unknowns_(which_, Eigen::all);
  among_.bottomRows(count) = coupling_.transpose() * of_unknowns_;
}

/// What is left of d = linear - C (1/2 sum w^2 c + sum w h e), h = s + 1/2 D^T Sigma^-1 D w^2 - D^T Sigma^-1
/// e, in the unknowns.
WeakParameters::Unknowns WeakParameters::error_of(const Unknowns& at, const Unknowns& start,
                                                  const Eigen::VectorXd& of_errors) const {
  const Eigen::Index count = size();
  const Eigen::VectorXd half = 0.5 * at.w.cwiseAbs2();
  const Eigen::VectorXd h = at.s + strength_ * half - of_errors;
  Eigen::VectorXd load(2 * count);
  load << at.w.cwiseProduct(h), half;
  const Eigen::VectorXd moved = among_ * load;
  return {at.w - start.w + moved.head(count), at.s - start.s + moved.tail(count)};
}

/// Of error_of() to the unknowns.
Eigen::MatrixXd WeakParameters::slope_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const {
  const Eigen::Index count = 2 * size();
  return Eigen::MatrixXd::Identity(count, count) + among_ * curvature_at(at, of_errors);
}

/// What the second order adds to the curvature, on [e c].
Eigen::MatrixXd WeakParameters::curvature_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const {
  const Eigen::Index count = size();
  const Eigen::VectorXd h = at.s + 0.5 * strength_ * at.w.cwiseAbs2() - of_errors;
  Eigen::MatrixXd added = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  added.topLeftCorner(count, count) = at.w.asDiagonal() * strength_ * at.w.asDiagonal();
  added.topLeftCorner(count, count).diagonal() += h;
  added.topRightCorner(count, count) = at.w.asDiagonal();
  added.bottomLeftCorner(count, count) = at.w.asDiagonal();
  return added;
}

WeakParameters::Solution WeakParameters::solve(const CampaignDraw& draw,
                                               const Eigen::VectorXd& linear) const {
  const Eigen::Index count = size();
  if (count == 0) return {linear, {}};
  const Eigen::VectorXd of_errors = weighed_.transpose() * draw.errors;
  const Unknowns start{linear(which_), coupling_.transpose() * linear};
  Unknowns at = start, error = error_of(at, start, of_errors);
  const double first = error.norm();
  for (int step = 0; step < kMostSteps && error.norm() > kSettled * first; ++step) {
    Eigen::VectorXd right(2 * count);
    right << error.w, error.s;
    const Eigen::VectorXd move = -slope_at(at, of_errors).partialPivLu().solve(right);
    Unknowns next;
    double share = 1.0;
    for (;; share *= 0.5) {
      next = {at.w + share * move.head(count), at.s + share * move.tail(count)};
      const Unknowns left = error_of(next, start, of_errors);
      if (left.norm() < error.norm() || share < kShortestShare) {
        error = left;
        break;
      }
    }
    at = next;
    if (share < kShortestShare) break;
  }
  if (!(error.norm() < first)) return {linear, {}};
  Eigen::VectorXd load(2 * count);
  const Eigen::VectorXd half = 0.5 * at.w.cwiseAbs2();
  load << at.w.cwiseProduct(at.s + strength_ * half - of_errors), half;
  const Eigen::MatrixXd added = curvature_at(at, of_errors);
  return {linear - of_unknowns_ * load, slope_at(at, of_errors).transpose().partialPivLu().solve(added)};
}

Eigen::VectorXd WeakParameters::inverse_curvature(const Solution& solution,
                                                  const Eigen::VectorXd& gradient) const {
  Eigen::VectorXd moved = campaign_.gain() * gradient;
  if (solution.correction.size() == 0) return moved;
  return moved - of_unknowns_ * (solution.correction * (of_unknowns_.transpose() * gradient));
}

}  // namespace volcal
