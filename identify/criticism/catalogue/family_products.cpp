#include "volcal/identify/criticism/catalogue/family_products.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/identify/statistics/log_gamma.h"

namespace volcal {
namespace {

constexpr double kNothingLeft = 1e-13;  // of |a_w|^2: rounding of the projection

/// Probability that the largest LM of a scan exceeds `lm` by chance, against that of one shape: the bound by
/// the total variation of sqrt(LM) over the scan (Davies 1987, Biometrika 74, 33, eq. 3.4), and no more than
/// the number of shapes.
double scan_multiplicity(const std::vector<double>& lm_of_shapes, double lm, int dof) {
  if (lm_of_shapes.size() < 2 || dof == 0 || !(lm > 0.0)) return 1.0;
  double variation = 0.0;
  for (std::size_t i = 1; i < lm_of_shapes.size(); ++i) {
    variation += std::abs(std::sqrt(lm_of_shapes[i]) - std::sqrt(lm_of_shapes[i - 1]));
  }
  const double half = 0.5 * dof;
  const double log10_crossings =
      (0.5 * (dof - 1) * std::log(lm) - 0.5 * lm - half * std::numbers::ln2 - log_gamma(half)) /
          std::numbers::ln10 +
      std::log10(std::max(variation, 1e-300));
  const double multiplicity = 1.0 + std::pow(10.0, log10_crossings - log10_chi_squared_exceedance(lm, dof));
  return std::min(multiplicity, static_cast<double>(lm_of_shapes.size()));
}

std::vector<Hypothesis> all_shapes(const std::vector<Family>& families,
                                   const std::vector<std::size_t>& which) {
  std::vector<Hypothesis> all;
  for (const std::size_t family : which) {
    for (const Eigen::VectorXd& shape : families[family].scan) all.push_back({family, shape});
  }
  return all;
}

/// Of the first columns alone, the amplitudes of the others zero.
ScoreTest score_of_first(const ProjectedColumns& projected, Eigen::Index first, Eigen::Index count,
                         const Eigen::VectorXd& largest) {
  const Eigen::Index all = largest.size();
  ScoreTest test = score_test(projected, first, count, largest.head(count));
  test.amplitude.conservativeResizeLike(Eigen::VectorXd::Zero(all));
  test.covariance.conservativeResizeLike(Eigen::MatrixXd::Zero(all, all));
  test.gram.conservativeResizeLike(Eigen::MatrixXd::Zero(all, all));
  test.score.conservativeResizeLike(Eigen::VectorXd::Zero(all));
  return test;
}

/// The order of the greatest gain.
FamilyTest at_best_order(const ProjectedColumns& projected, const Family& family, std::size_t place,
                         Eigen::Index first, const Projector& projector) {
  FamilyTest best;
  const Eigen::VectorXd largest = family.largest_amplitudes();
  for (const Eigen::Index order : family.orders) {
    FamilyTest test;
    test.family = place;
    test.multiplicity = static_cast<double>(family.orders.size());
    update_test(test, family, Eigen::VectorXd::Constant(1, static_cast<double>(order)),
                score_of_first(projected, first, order, largest), projector);
    if (order == family.orders.front() || test.gain > best.gain) best = std::move(test);
  }
  return best;
}

FamilyTest at_best_shape(const ProjectedColumns& projected, const Family& family, std::size_t place,
                         Eigen::Index first, const Projector& projector) {
  if (!family.orders.empty()) return at_best_order(projected, family, place, first, projector);
  const Eigen::Index columns = family.amplitudes();
  const Eigen::VectorXd largest = family.largest_amplitudes();
  FamilyTest best;
  best.family = place;
  best.shape = family.scan.front();
  std::vector<double> lm;
  for (std::size_t i = 0; i < family.scan.size(); ++i) {
    const ScoreTest test =
        family_score(family, projected, first + static_cast<Eigen::Index>(i) * columns, largest);
    lm.push_back(test.lm);
    if (i > 0 && test.lm <= best.score.lm) continue;
    best.score = test;
    best.shape = family.scan[i];
  }
  best.multiplicity = scan_multiplicity(lm, best.score.lm, best.score.dof);
  update_test(best, family, best.shape, best.score, projector);
  return best;
}

/// What columns are apart from the model, and how they move its products.
class Acceptance {
 public:
  Acceptance(const Eigen::MatrixXd& columns, const Projector& projector)
      : weighed_(projector.weighed_projection(columns)) {
    const ProjectedColumns own = projector.project(columns);
    const Eigen::VectorXd scale =
        own.norm.unaryExpr([](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
    const SymmetricEigen eigen =
        eigen_decomposition(scale.asDiagonal() * own.gram(0, columns.cols()) * scale.asDiagonal());
    root_.resize(columns.cols(), 0);
    for (Eigen::Index k = 0; k < columns.cols(); ++k) {
      if (eigen.values[k] < kNothingLeft) continue;
      root_.conservativeResize(Eigen::NoChange, root_.cols() + 1);
      root_.rightCols(1) = scale.cwiseProduct(eigen.vectors.col(k)) / std::sqrt(eigen.values[k]);
    }
    score_ = root_.transpose() * own.score;
  }

  /// Of all observations: g^T weighed() = g~^T a~.
  const Eigen::MatrixXd& weighed() const { return weighed_; }

  /// `cross`: g~^T a~ of all columns of `products`.
  void move(const Eigen::MatrixXd& cross, ProjectedColumns& products) const {
    const Eigen::MatrixXd along = cross * root_;
    products.score -= along * score_;
    for (std::size_t group = 0; group < products.grams.size(); ++group) {
      Eigen::MatrixXd& gram = products.grams[group];
      const auto own = along.middleRows(products.first[group], gram.rows());
      gram -= own * own.transpose();
    }
  }

 private:
  Eigen::MatrixXd weighed_;
  Eigen::MatrixXd root_;   ///< R R^T = (a~^T a~)^-1, without directions of which nothing is left
  Eigen::VectorXd score_;  ///< R^T a~^T r~
};

/// Of the columns of families at all their shapes, transposed, with `weighed`.
Eigen::MatrixXd cross_products(const LinearModel& model, const std::vector<Family>& families,
                               const std::vector<Hypothesis>& hypotheses, Eigen::Index columns,
                               const Eigen::MatrixXd& weighed) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns, weighed.cols());
  const std::vector<Eigen::Index>& parts = model.parts();
  for (std::size_t part = 0; part + 1 < parts.size(); ++part) {
    const auto rows = weighed.middleRows(parts[part], parts[part + 1] - parts[part]);
    Eigen::Index at = 0;
    for (const Hypothesis& each : hypotheses) {
      const Family& family = families[each.family];
      add_family_products(model, family, each.shape, part, rows, sum.middleRows(at, family.amplitudes()));
      at += family.amplitudes();
    }
  }
  return sum;
}

}  // namespace

/// Widest first.
std::vector<FamilyProducts::Block> FamilyProducts::blocks(const std::vector<Family>& families,
                                                          std::size_t from) {
  std::vector<Block> all;
  for (std::size_t family = from; family < families.size(); ++family) {
    const Eigen::Index columns =
        static_cast<Eigen::Index>(families[family].scan.size()) * families[family].amplitudes();
    if (all.empty() || all.back().columns + columns > kBlockColumns) all.emplace_back();
    all.back().family.push_back(family);
    all.back().columns += columns;
  }
  std::ranges::stable_sort(all, std::greater{}, &Block::columns);
  return all;
}

void FamilyProducts::add(std::vector<Block> more, const LinearModel& model,
                         const std::vector<Family>& families, const Projector& projector, int threads) {
  run_parallel(more.size(), threads, [&](std::size_t i) {
    more[i].products = std::make_shared<const ProjectedColumns>(
        projector.project(columns_of(model, families, all_shapes(families, more[i].family))));
  });
  for (Block& block : more) blocks_.push_back(std::move(block));
  count_ = families.size();
}

FamilyProducts::FamilyProducts(const LinearModel& model, const std::vector<Family>& families,
                               const Projector& projector, int threads) {
  add(blocks(families, 0), model, families, projector, threads);
}

FamilyProducts FamilyProducts::with_more(const LinearModel& model, const std::vector<Family>& families,
                                         const Projector& projector, int threads) const {
  FamilyProducts all = *this;
  all.add(blocks(families, count_), model, families, projector, threads);
  return all;
}

FamilyProducts FamilyProducts::accepting(const Eigen::MatrixXd& columns, const LinearModel& model,
                                         const std::vector<Family>& families, const Projector& projector,
                                         int threads) const {
  const Acceptance acceptance(columns, projector);
  FamilyProducts after = *this;
  run_parallel(after.blocks_.size(), threads, [&](std::size_t i) {
    Block& block = after.blocks_[i];
    auto products = std::make_shared<ProjectedColumns>(*block.products);
    acceptance.move(cross_products(model, families, all_shapes(families, block.family), block.columns,
                                   acceptance.weighed()),
                    *products);
    block.products = std::move(products);
  });
  return after;
}

std::vector<FamilyTest> FamilyProducts::tests(const std::vector<Family>& families, const Projector& projector,
                                              int threads, std::size_t from) const {
  std::vector<FamilyTest> tests(count_ - from);
  run_parallel(blocks_.size(), threads, [&](std::size_t i) {
    Eigen::Index first = 0;
    for (const std::size_t family : blocks_[i].family) {
      if (family >= from)
        tests[family - from] =
            at_best_shape(*blocks_[i].products, families[family], family, first, projector);
      first += static_cast<Eigen::Index>(families[family].scan.size()) * families[family].amplitudes();
    }
  });
  return tests;
}

}  // namespace volcal
