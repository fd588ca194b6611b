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

/// One-sided differences, or central ones where the box has room.
Eigen::VectorXd gradient(const ValuesAt& function, const Minimum& now, const Box& box, bool central) {
  std::vector<Eigen::Index> variable;
  std::vector<double> step;
  std::vector<Eigen::VectorXd> places;
  const auto ask = [&](Eigen::Index i, double by) {
    Eigen::VectorXd moved = now.at;
    moved(i) += by;
    variable.push_back(i);
    step.push_back(moved(i) - now.at(i));
    places.push_back(std::move(moved));
  };
  for (Eigen::Index i = 0; i < now.at.size(); ++i) {
    if (box.lower(i) >= box.upper(i)) continue;
    const bool above = now.at(i) + kDifference <= box.upper(i);
    const bool below = now.at(i) - kDifference >= box.lower(i);
    ask(i, above ? kDifference : -kDifference);
    if (central && above && below) ask(i, -kDifference);
  }
  const std::vector<double> values = function(places);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(now.at.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const bool both = k > 0 && variable[k] == variable[k - 1];
    slope(variable[k]) =
        both ? (values[k - 1] - values[k]) / (2.0 * kDifference) : (values[k] - now.value) / step[k];
  }
  return slope;
}

Eigen::MatrixXd first_hessian(const ValuesAt& function, const Minimum& now, const Box& box) {
  struct Bend {
    Eigen::Index variable;
    bool inside;
  };
  std::vector<Bend> bends;
  std::vector<Eigen::VectorXd> places;
  for (Eigen::Index i = 0; i < now.at.size(); ++i) {
    if (box.lower(i) >= box.upper(i)) continue;
    Eigen::VectorXd one = now.at, other = now.at;  // either side, or one and two steps away from the bound
    const bool inside = now.at(i) - kCurvatureDifference >= box.lower(i);
    one(i) += kCurvatureDifference;
    other(i) += inside ? -kCurvatureDifference : 2.0 * kCurvatureDifference;
    bends.push_back({i, inside});
    places.push_back(std::move(one));
    places.push_back(std::move(other));
  }
  const std::vector<double> values = function(places);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(now.at.size(), now.at.size());
  for (std::size_t k = 0; k < bends.size(); ++k) {
    const double first = values[2 * k], second = values[2 * k + 1];
    const double bend = bends[k].inside ? first - 2.0 * now.value + second : now.value - 2.0 * first + second;
    hessian(bends[k].variable, bends[k].variable) =
        std::max(std::abs(bend) / (kCurvatureDifference * kCurvatureDifference), kLeastCurvature);
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

Minimum bounded_minimum(const std::function<double(const Eigen::VectorXd&)>& function,
                        const Eigen::VectorXd& start, const Box& box, double tolerance, int most_iterations) {
  const ValuesAt one_by_one = [&](const std::vector<Eigen::VectorXd>& places) {
    std::vector<double> values;
    for (const Eigen::VectorXd& at : places) values.push_back(function(at));
    return values;
  };
  return bounded_minimum(one_by_one, start, box, tolerance, most_iterations);
}

Minimum bounded_minimum(const ValuesAt& function, const Eigen::VectorXd& start, const Box& box,
                        double tolerance, int most_iterations) {
  Minimum now{start.cwiseMax(box.lower).cwiseMin(box.upper), 0.0};
  now.value = function({now.at}).front();
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
      next.value = function({next.at}).front();
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
