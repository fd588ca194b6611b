#include "volcal/identify/numeric/bounded_minimum.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

namespace volcal {
namespace {

constexpr double kDifference = 1e-4;
constexpr double kCurvatureDifference = 1e-2;
constexpr double kLeastCurvature = 0.5;
constexpr double kLongestStep = 2.0;
constexpr double kSufficient = 1e-4;  // of the promised decrease
constexpr int kHalvings = 10;

using Function = std::function<double(const Eigen::VectorXd&)>;

/// One-sided differences, or central ones where the box has room.
Eigen::VectorXd gradient(const Function& function, const Minimum& now, const Box& box, bool central) {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(now.at.size());
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    if (box.lower(i) >= box.upper(i)) continue;
    const bool above = now.at(i) + kDifference <= box.upper(i);
    const bool below = now.at(i) - kDifference >= box.lower(i);
    Eigen::VectorXd moved = now.at;
    moved(i) += above ? kDifference : -kDifference;
    const double value = function(moved);
    slope(i) = (value - now.value) / (moved(i) - now.at(i));
    if (!central || !above || !below) continue;
    moved(i) = now.at(i) - kDifference;
    slope(i) = (value - function(moved)) / (2.0 * kDifference);
  }
  return slope;
}

Eigen::MatrixXd first_hessian(const Function& function, const Minimum& now, const Box& box) {
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(now.at.size(), now.at.size());
  for (Eigen::Index i = 0; i < now.at.size(); ++i) {
    if (box.lower(i) >= box.upper(i)) continue;
    Eigen::VectorXd one = now.at, other = now.at;  // either side, or one and two steps away from the bound
    const bool inside = now.at(i) - kCurvatureDifference >= box.lower(i);
    one(i) += kCurvatureDifference;
    other(i) += inside ? -kCurvatureDifference : 2.0 * kCurvatureDifference;
    const double first = function(one), second = function(other);
    const double bend = inside ? first - 2.0 * now.value + second : now.value - 2.0 * first + second;
    hessian(i, i) = std::max(std::abs(bend) / (kCurvatureDifference * kCurvatureDifference), kLeastCurvature);
  }
  return hessian;
}

/// Newton step of the variables that may move.
Eigen::VectorXd direction(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& slope, const Minimum& now,
                          const Box& box) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    const bool held = box.lower(i) >= box.upper(i) || (now.at(i) <= box.lower(i) && slope(i) > 0.0) ||
                      (now.at(i) >= box.upper(i) && slope(i) < 0.0);
    if (!held) free.push_back(i);
  }
  Eigen::VectorXd step = Eigen::VectorXd::Zero(slope.size());
  if (free.empty()) return step;
  step(free) = -Eigen::MatrixXd(hessian(free, free)).ldlt().solve(Eigen::VectorXd(slope(free)));
  const double longest = step.cwiseAbs().maxCoeff();
  return longest > kLongestStep ? Eigen::VectorXd(step * (kLongestStep / longest)) : step;
}

/// Powell's damping keeps the matrix positive definite.
void update(const Eigen::VectorXd& step, const Eigen::VectorXd& change, Eigen::MatrixXd& hessian) {
  const Eigen::VectorXd expected = hessian * step;
  const double expected_bend = step.dot(expected), bend = step.dot(change);
  if (!(expected_bend > 0.0)) return;
  const double share = bend >= 0.2 * expected_bend ? 1.0 : 0.8 * expected_bend / (expected_bend - bend);
  const Eigen::VectorXd damped = share * change + (1.0 - share) * expected;
  hessian += damped * damped.transpose() / step.dot(damped) - expected * expected.transpose() / expected_bend;
}

}  // namespace

Minimum bounded_minimum(const Function& function, const Eigen::VectorXd& start, const Box& box,
                        double tolerance, int most_iterations) {
  Minimum now{start.cwiseMax(box.lower).cwiseMin(box.upper), 0.0};
  now.value = function(now.at);
  Eigen::MatrixXd hessian = first_hessian(function, now, box);
  bool central = false;
  Eigen::VectorXd slope = gradient(function, now, box, central);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    const Eigen::VectorXd step = direction(hessian, slope, now, box);
    Minimum next;
    bool better = false;
    double share = 1.0;
    const bool promising = -slope.dot(step) >= tolerance;
    for (int halving = 0; promising && halving < kHalvings && !better; ++halving, share *= 0.5) {
      next.at = (now.at + share * step).cwiseMax(box.lower).cwiseMin(box.upper);
      next.value = function(next.at);
      better = next.value < now.value + kSufficient * slope.dot(next.at - now.at);
    }
    if (!better && central) break;
    if (!better) {
      central = true;
      slope = gradient(function, now, box, central);
      continue;
    }
    const Eigen::VectorXd next_slope = gradient(function, next, box, central);
    update(next.at - now.at, next_slope - slope, hessian);
    now = next;
    slope = next_slope;
  }
  return now;
}

}  // namespace volcal
