#include "volcal/identify/criticism/catalogue/shape_refinement.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {
namespace {

constexpr int kGoldenSteps = 12;
constexpr double kGolden = 0.6180339887498949;
constexpr double kRoundingOfLm = 1e-11;
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

/// By more than rounding: between two readings a moment is as good as the next.
bool is_better(const ScoreTest& one, const ScoreTest& other) {
  return one.lm > other.lm * (1.0 + kRoundingOfLm);
}

/// The search of one shape, which says at which values it wants to know what the readings see.
class ShapeSearch {
 public:
  ShapeSearch(const Family& family, FamilyTest& test)
      : family_(family), test_(test), largest_(family.largest_amplitudes()) {
    if (family.scan.size() < 2 || test.shape.size() != 1 || test.score.dof == 0) return;
    const auto [low, high] = neighbours(family, test.shape[0]);
    low_ = low;
    high_ = high;
    wanted_ = {test.shape[0]};
    for (const double neighbour : {low, high}) {
      if (neighbour != test.shape[0]) wanted_.push_back(neighbour);
    }
  }

  const Family& family() const { return family_; }
  /// Nothing: the search is over.
  const std::vector<double>& wanted() const { return wanted_; }
  Eigen::Index columns() const { return family_.amplitudes() * static_cast<Eigen::Index>(wanted_.size()); }

  /// Columns of the values that were wanted, from `first` on in a group of their own.
  void take(const ProjectedColumns& projected, Eigen::Index first, const Projector& projector) {
    const auto score = [&](Eigen::Index k) {
      return family_score(family_, projected, first + k * family_.amplitudes(), largest_);
    };
    if (!begun_) return begin(projected.gram(first, columns()));
    if (wanted_.size() == 2) {
      at_left_ = score(0);
      at_right_ = score(1);
    } else {
      (left_is_wanted_ ? at_left_ : at_right_) = score(0);
    }
    if (++steps_ > kGoldenSteps) return end(projector);
    step();
  }

 private:
  /// Neighbours that have nothing to do with a shape lead nowhere. `gram`: of that shape and of its
  /// neighbours.
  void begin(const Eigen::MatrixXd& gram) {
    const Eigen::Index count = family_.amplitudes();
    const Eigen::VectorXd scale = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd cosine = scale.asDiagonal() * gram * scale.asDiagonal();
    for (Eigen::Index at = count; at < cosine.cols(); at += count) {
      if (cosine.block(0, at, count, count).cwiseAbs().maxCoeff() >= kThresholds.related_neighbours) continue;
      wanted_.clear();
      return;
    }
    begun_ = true;
    left_ = high_ - kGolden * (high_ - low_);
    right_ = low_ + kGolden * (high_ - low_);
    wanted_ = {left_, right_};
  }

  void step() {
    left_is_wanted_ = is_better(at_left_, at_right_);
    if (left_is_wanted_) {
      high_ = std::exchange(right_, left_);
      at_right_ = at_left_;
      left_ = high_ - kGolden * (high_ - low_);
    } else {
      low_ = std::exchange(left_, right_);
      at_left_ = at_right_;
      right_ = low_ + kGolden * (high_ - low_);
    }
    wanted_ = {left_is_wanted_ ? left_ : right_};
  }

  void end(const Projector& projector) {
    wanted_.clear();
    const bool left_wins = is_better(at_left_, at_right_);
    const ScoreTest& best = left_wins ? at_left_ : at_right_;
    if (is_better(best, test_.score))
      update_test(test_, family_, one(left_wins ? left_ : right_), best, projector);
  }

  const Family& family_;
  FamilyTest& test_;
  Eigen::VectorXd largest_;
  std::vector<double> wanted_;
  bool begun_ = false, left_is_wanted_ = false;
  int steps_ = 0;
  double low_ = 0.0, high_ = 0.0, left_ = 0.0, right_ = 0.0;
  ScoreTest at_left_, at_right_;
};

/// What all of them want, projected together.
void take_together(const LinearModel& model, const Projector& projector,
                   const std::vector<ShapeSearch*>& searches) {
  CandidateColumns columns;
  for (const ShapeSearch* search : searches) {
    columns.groups.push_back(search->columns());
    columns.count += search->columns();
  }
  columns.fill = [&](std::size_t part, Eigen::Ref<Eigen::MatrixXd> rows) {
    Eigen::Index at = 0;
    for (const ShapeSearch* search : searches) {
      const Eigen::Index width = search->family().amplitudes();
      for (const double shape : search->wanted()) {
        family_columns(model, search->family(), one(shape), part, rows.middleCols(at, width));
        at += width;
      }
    }
  };
  const ProjectedColumns projected = projector.project(columns);
  for (std::size_t i = 0; i < searches.size(); ++i)
    searches[i]->take(projected, projected.first[i], projector);
}

/// Of searches that are not over, as many as are projected at the price of one.
std::vector<std::vector<ShapeSearch*>> in_blocks(std::vector<ShapeSearch>& searches) {
  std::vector<std::vector<ShapeSearch*>> blocks;
  Eigen::Index columns = 0;
  for (ShapeSearch& search : searches) {
    if (search.wanted().empty()) continue;
    if (blocks.empty() || columns + search.columns() > kColumnBlock) {
      blocks.emplace_back();
      columns = 0;
    }
    columns += search.columns();
    blocks.back().push_back(&search);
  }
  return blocks;
}

}  // namespace

void refine_shapes(const LinearModel& model, const std::vector<Family>& families, const Projector& projector,
                   int threads, const std::vector<FamilyTest*>& tests) {
  std::vector<ShapeSearch> searches;
  for (FamilyTest* test : tests) searches.emplace_back(families[test->family], *test);
  for (auto blocks = in_blocks(searches); !blocks.empty(); blocks = in_blocks(searches)) {
    run_parallel(blocks.size(), threads, [&](std::size_t i) { take_together(model, projector, blocks[i]); });
  }
}

void refine_shape(const LinearModel& model, const Family& family, const Projector& projector,
                  FamilyTest& test) {
  ShapeSearch search(family, test);
  while (!search.wanted().empty()) take_together(model, projector, {&search});
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
