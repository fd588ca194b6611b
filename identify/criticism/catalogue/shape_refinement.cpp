#include "volcal/identify/criticism/catalogue/shape_refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"

namespace volcal {
namespace {

constexpr int kGoldenSteps = 12;
constexpr double kGolden = 0.6180339887498949;
constexpr double kDerivativeStep = 0.02;  // of the distance to the neighbours

struct Bracket {
  double low = 0.0;
  double high = 0.0;
};

/// Neighbours of a value in the scan; at an end, the value itself.
Bracket neighbours(const Family& family, double value) {
  Bracket bracket{value, value};
  for (const Eigen::VectorXd& shape : family.scan) {
    const double other = shape[0];
    if (other < value && (bracket.low == value || other > bracket.low)) bracket.low = other;
    if (other > value && (bracket.high == value || other < bracket.high)) bracket.high = other;
  }
  return bracket;
}

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

class Refiner {
 public:
  Refiner(const LinearModel& model, const Family& family, const Projector& projector)
      : model_(model), family_(family), projector_(projector) {}

  ScoreTest score(double shape) const {
    return score_test(projector_.project(family_columns(model_, family_, one(shape))), 0,
                      family_.amplitudes());
  }

  /// Largest cosine between columns of two shapes after projection.
  double relation(double a, double b) const {
    const Eigen::Index count = family_.amplitudes();
    Eigen::MatrixXd columns(static_cast<Eigen::Index>(model_.size()), 2 * count);
    columns << family_columns(model_, family_, one(a)), family_columns(model_, family_, one(b));
    const Eigen::MatrixXd gram = projector_.project(columns).gram(0, 2 * count);
    const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd cosine = scale.asDiagonal() * gram * scale.asDiagonal();
    return cosine.topRightCorner(count, count).cwiseAbs().maxCoeff();
  }

 private:
  const LinearModel& model_;
  const Family& family_;
  const Projector& projector_;
};

}  // namespace

void refine_shape(const LinearModel& model, const Family& family, const Projector& projector,
                  FamilyTest& test) {
  if (family.scan.size() < 2 || test.shape.size() != 1 || test.score.dof == 0) return;
  const Refiner refiner(model, family, projector);
  const double centre = test.shape[0];
  auto [low, high] = neighbours(family, centre);
  for (const double neighbour : {low, high}) {
    if (neighbour != centre && refiner.relation(centre, neighbour) < kThresholds.related_neighbours) return;
  }
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  ScoreTest at_left = refiner.score(left), at_right = refiner.score(right);
  for (int step = 0; step < kGoldenSteps; ++step) {
    if (at_left.lm > at_right.lm) {
      high = std::exchange(right, left);
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = refiner.score(left);
    } else {
      low = std::exchange(left, right);
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = refiner.score(right);
    }
  }
  const bool left_wins = at_left.lm > at_right.lm;
  const ScoreTest& best = left_wins ? at_left : at_right;
  if (best.lm > test.score.lm) update_test(test, family, one(left_wins ? left : right), best, projector);
}

std::optional<ScanEnd> end_of_scan(const Family& family, double shape) {
  if (family.scan.size() < 2) return std::nullopt;
  const auto [lowest, highest] =
      std::ranges::minmax(family.scan, {}, [](const Eigen::VectorXd& each) { return each[0]; });
  const auto is_end = [&](double end) {
    const auto [low, high] = neighbours(family, end);
    return std::abs(shape - end) < kThresholds.at_end_of_scan * (high - low);
  };
  if (is_end(lowest[0])) return ScanEnd::Lowest;
  if (is_end(highest[0])) return ScanEnd::Highest;
  return std::nullopt;
}

std::optional<Eigen::VectorXd> shape_derivative(const LinearModel& model, const Family& family,
                                                const Eigen::VectorXd& shape,
                                                const Eigen::VectorXd& amplitude) {
  if (family.scan.size() < 2 || shape.size() != 1) return std::nullopt;
  const auto [low, high] = neighbours(family, shape[0]);
  const double step = kDerivativeStep * (high - low);
  const auto readings = [&](double value) -> Eigen::VectorXd {
    return family_columns(model, family, one(value)) * amplitude;
  };
  const Eigen::VectorXd before = readings(shape[0] - step), after = readings(shape[0] + step);
  const Eigen::VectorXd difference = after - before;
  const Eigen::VectorXd bend = after + before - 2.0 * readings(shape[0]);
  if (difference.norm() == 0.0 || bend.norm() > kThresholds.smooth_dependence * difference.norm())
    return std::nullopt;
  return difference / (2.0 * step);
}

}  // namespace volcal
