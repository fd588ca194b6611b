#include "volcal/identify/result/largest_value.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace volcal {
namespace {

constexpr int kPerPiece = 8;  // places; of three variables half as many
constexpr int kPerSide = 9;   // places for the median of u
constexpr double kMostTimesMedian = 3.0;
constexpr int kHalvings = 10;
constexpr double kRounding = 1e-12;  // a value is no larger within it

using Place = std::vector<double>;

double place_of(const TensorBasis::Side& side, int i, int count) {
  return i == count - 1 ? side.to : side.from + (side.to - side.from) * i / (count - 1.0);
}

/// Equally spaced, the last variable first.
std::vector<Place> places(const TensorBasis& basis, const std::vector<int>& counts) {
  std::vector<Place> all = {{}};
  for (std::size_t k = 0; k < counts.size(); ++k) {
    std::vector<Place> longer;
    longer.reserve(all.size() * static_cast<std::size_t>(counts[k]));
    for (const Place& place : all) {
      for (int i = 0; i < counts[k]; ++i) {
        longer.push_back(place);
        longer.back().push_back(place_of(basis.sides()[k], i, counts[k]));
      }
    }
    all = std::move(longer);
  }
  return all;
}

class LargestSearch {
 public:
  LargestSearch(const TensorBasis& basis, const Eigen::VectorXd& coefficients,
                const Eigen::MatrixXd& covariance)
      : basis_(basis), coefficients_(coefficients), covariance_(covariance) {
    find_limit();
  }

  LargestValue run() {
    const int per_piece = basis_.sides().size() > 2 ? kPerPiece / 2 : kPerPiece;
    std::vector<int> counts;
    for (const TensorBasis::Side& side : basis_.sides()) counts.push_back(per_piece * side.pieces + 1);
    Place at = best_of(places(basis_, counts));
    std::vector<double> steps;
    for (std::size_t k = 0; k < counts.size(); ++k)
      steps.push_back((basis_.sides()[k].to - basis_.sides()[k].from) / (counts[k] - 1.0));
    refine(at, std::move(steps));
    LargestValue largest;
    largest.row = basis_.row(at);
    largest.value = largest.row.dot(coefficients_);
    largest.u = uncertainty(largest.row);
    largest.at = std::move(at);
    return largest;
  }

 private:
  double magnitude(const Place& place) const { return std::abs(basis_.row(place).dot(coefficients_)); }

  /// Of few coefficients that are not zero there.
  double uncertainty(const Eigen::VectorXd& row) const {
    if (covariance_.size() == 0) return 0.0;
    std::vector<Eigen::Index> acting;
    for (Eigen::Index i = 0; i < row.size(); ++i) {
      if (row[i] != 0.0) acting.push_back(i);
    }
    double variance = 0.0;
    for (const Eigen::Index i : acting) {
      for (const Eigen::Index j : acting) variance += row[i] * covariance_(i, j) * row[j];
    }
    return std::sqrt(std::max(0.0, variance));
  }

  void find_limit() {
    std::vector<double> u;
    for (const Place& place : places(basis_, std::vector<int>(basis_.sides().size(), kPerSide)))
      u.push_back(uncertainty(basis_.row(place)));
    const auto middle = u.begin() + static_cast<std::ptrdiff_t>(u.size() / 2);
    std::nth_element(u.begin(), middle, u.end());
    limit_ = kMostTimesMedian * *middle;
  }

  bool is_measured(const Place& place) const { return uncertainty(basis_.row(place)) <= limit_; }

  Place best_of(const std::vector<Place>& all) const {
    std::size_t best = all.size();
    double largest = -1.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double value = magnitude(all[i]);
      if (value <= largest * (1.0 + kRounding) || !is_measured(all[i])) continue;
      largest = value;
      best = i;
    }
    return all[best < all.size() ? best : 0];
  }

  void refine(Place& at, std::vector<double> steps) const {
    double largest = magnitude(at);
    for (int halving = 0; halving < kHalvings; ++halving) {
      for (double& step : steps) step *= 0.5;
      while (move(at, steps, largest)) {
      }
    }
  }

  /// To the first neighbour along a variable that is larger.
  bool move(Place& at, const std::vector<double>& steps, double& largest) const {
    for (std::size_t k = 0; k < steps.size(); ++k) {
      for (const double step : {-steps[k], steps[k]}) {
        Place next = at;
        next[k] = std::clamp(at[k] + step, basis_.sides()[k].from, basis_.sides()[k].to);
        const double value = magnitude(next);
        if (value <= largest * (1.0 + kRounding) || !is_measured(next)) continue;
        largest = value;
        at = std::move(next);
        return true;
      }
    }
    return false;
  }

  const TensorBasis& basis_;
  const Eigen::VectorXd& coefficients_;
  const Eigen::MatrixXd& covariance_;
  double limit_ = 0.0;
};

}  // namespace

LargestValue largest_value(const TensorBasis& basis, const Eigen::VectorXd& coefficients,
                           const Eigen::MatrixXd& covariance) {
  return LargestSearch(basis, coefficients, covariance).run();
}

}  // namespace volcal
