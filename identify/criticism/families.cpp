#include "volcal/identify/criticism/families.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "volcal/identify/criticism/left_out.h"
#include "volcal/identify/criticism/parallel.h"
#include "volcal/identify/solve/resolution.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr Eigen::Index kBlockColumns = 256;
constexpr int kLowestExtraDegree = 4;
constexpr int kHighestExtraDegree = 11;

/// Legendre polynomials on [-1, 1] by their recurrence (Abramowitz and Stegun 22.7.10).
double legendre(int degree, double x) {
  double before = 1.0, value = x;
  if (degree == 0) return before;
  for (int n = 1; n < degree; ++n) {
    const double next = ((2.0 * n + 1.0) * x * value - n * before) / (n + 1.0);
    before = value;
    value = next;
  }
  return value;
}

/// Higher polynomials of an axis' own position: what a function with too few knots leaves.
void resolution_columns(const LinearModel& model, ErrorSymbol symbol, std::size_t setup,
                        Eigen::Ref<Eigen::MatrixXd> columns) {
  const Campaign& campaign = model.campaign();
  const MeasuredRange range = measured_range(campaign, symbol.axis);
  const int target =
      disturbance_of({.kind = TargetKind::Motion, .symbol = symbol, .component = 0}, campaign.machine);
  const auto& position = campaign.setups[setup].readings.position[index_of(symbol.axis)];
  const Eigen::Index first = model.parts()[setup];
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double q = position[model.observations()[static_cast<std::size_t>(first + i)].row];
    const double x =
        std::clamp(2.0 * (q - range.min) / std::max(1e-12, range.max - range.min) - 1.0, -1.0, 1.0);
    for (int degree = kLowestExtraDegree; degree <= kHighestExtraDegree; ++degree) {
      columns(i, degree - kLowestExtraDegree) = legendre(degree, x) * model.sensitivity(first + i, target);
    }
  }
}

/// Effective number of independent directions among unit vectors with this Gram matrix: (sum l)^2 / sum l^2
/// of its eigenvalues.
double effective_number(const Eigen::MatrixXd& gram) {
  const double squares = gram.squaredNorm();
  const double trace = gram.trace();
  return squares > 0.0 ? std::max(1.0, trace * trace / squares) : 1.0;
}

/// Multiplicity of a scan from the projected columns of its shapes, amplitude by amplitude.
double scan_multiplicity(const ProjectedColumns& projected, Eigen::Index first, Eigen::Index shapes,
                         Eigen::Index amplitudes) {
  if (shapes < 2) return 1.0;
  Eigen::MatrixXd gram = projected.gram(first, shapes * amplitudes);
  const Eigen::VectorXd scale = gram.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr(
      [](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
  gram = scale.asDiagonal() * gram * scale.asDiagonal();
  return effective_number(gram);
}

/// Families that are tested together, and the columns of all their shapes.
struct FamilyBlock {
  std::vector<std::size_t> family;
  Eigen::Index columns = 0;
};

void fill_columns(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape,
                  std::size_t setup, Eigen::Ref<Eigen::MatrixXd> out) {
  if (family.resolution) {
    resolution_columns(model, *family.resolution, setup, out);
  } else {
    model.columns(*family.effect, shape, setup, out);
  }
}

class FamilyTester {
 public:
  FamilyTester(const LinearModel& model, const std::vector<Family>& families, const Projector& projector)
      : model_(model), families_(families), projector_(projector) {
    tests_.resize(families.size());
    log_count_ = std::log(static_cast<double>(projector.observations()));
  }

  std::vector<FamilyTest> run(int threads) {
    const std::vector<FamilyBlock> all = blocks();
    run_parallel(all.size(), threads, [&](std::size_t i) { test(all[i]); });
    return std::move(tests_);
  }

 private:
  Eigen::Index shapes(std::size_t family) const {
    return static_cast<Eigen::Index>(families_[family].scan.size());
  }

  /// Widest first.
  std::vector<FamilyBlock> blocks() const {
    std::vector<FamilyBlock> all;
    for (std::size_t family = 0; family < families_.size(); ++family) {
      const Eigen::Index columns = shapes(family) * families_[family].amplitudes();
      if (all.empty() || all.back().columns + columns > kBlockColumns) all.emplace_back();
      all.back().family.push_back(family);
      all.back().columns += columns;
    }
    std::ranges::stable_sort(all, std::greater{}, &FamilyBlock::columns);
    return all;
  }

  void test(const FamilyBlock& block) {
    CandidateColumns candidates{block.columns, {}, [&](std::size_t setup, Eigen::Ref<Eigen::MatrixXd> rows) {
                                  fill(block, setup, rows);
                                }};
    for (const std::size_t family : block.family) {
      candidates.groups.push_back(shapes(family) * families_[family].amplitudes());
    }
    const ProjectedColumns projected = projector_.project(candidates);
    for (std::size_t i = 0; i < block.family.size(); ++i) {
      const std::size_t family = block.family[i];
      tests_[family] = best_shape(projected, family, projected.first[i], families_[family].amplitudes());
    }
  }

  void fill(const FamilyBlock& block, std::size_t setup, Eigen::Ref<Eigen::MatrixXd> rows) const {
    Eigen::Index at = 0;
    for (const std::size_t family : block.family) {
      const Eigen::Index amplitudes = families_[family].amplitudes();
      for (const Eigen::VectorXd& shape : families_[family].scan) {
        fill_columns(model_, families_[family], shape, setup, rows.middleCols(at, amplitudes));
        at += amplitudes;
      }
    }
  }

  FamilyTest best_shape(const ProjectedColumns& projected, std::size_t family, Eigen::Index first,
                        Eigen::Index columns) const {
    const auto& scan = families_[family].scan;
    FamilyTest best;
    best.family = family;
    best.shape = scan.front();
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const ScoreTest test = score_test(projected, first + static_cast<Eigen::Index>(i) * columns, columns);
      if (i > 0 && test.lm <= best.score.lm) continue;
      best.score = test;
      best.shape = scan[i];
    }
    best.multiplicity = scan_multiplicity(projected, first, static_cast<Eigen::Index>(scan.size()), columns);
    best.log10_p = std::min(0.0, best.score.log10_p + std::log10(best.multiplicity));
    const double shapes = scan.size() > 1 ? static_cast<double>(best.shape.size()) : 0.0;
    best.gain = best.score.lm - (best.score.dof + shapes) * log_count_;
    return best;
  }

  const LinearModel& model_;
  const std::vector<Family>& families_;
  const Projector& projector_;
  std::vector<FamilyTest> tests_;
  double log_count_ = 0.0;
};

}  // namespace

std::string Family::label() const {
  if (resolution) return resolution->name() + " finer";
  std::string label = effect->amplitudes().front().label;
  if (effect->amplitudes().size() > 1) label = label.substr(0, label.rfind(' '));
  return label;
}

Eigen::Index Family::amplitudes() const {
  return resolution ? kHighestExtraDegree - kLowestExtraDegree + 1
                    : static_cast<Eigen::Index>(effect->amplitudes().size());
}

EffectName Family::name() const {
  if (!resolution) return effect->name();
  return {"resolution", resolution->name(), std::string(1, lower_letter_of(resolution->axis)), "finer"};
}

std::vector<Family> families(const LinearModel& model) {
  std::set<EffectName> present;
  for (const EffectBinding& effect : model.model().binding().effects) present.insert(effect.effect->name());
  std::vector<Family> all;
  for (const EffectKind* kind : effect_kinds()) {
    for (EffectSpec& spec : kind->candidates(model.campaign())) {
      std::unique_ptr<Effect> effect = kind->make(spec, {});
      if (present.contains(effect->name())) continue;
      std::vector<Eigen::VectorXd> scan = effect->scan(model.campaign());
      all.push_back({std::move(spec), std::move(effect), std::nullopt, std::move(scan)});
    }
  }
  for (LeftOutError& error : left_out_errors(model.model())) {
    all.push_back({std::move(error.spec), std::move(error.effect), std::nullopt, {Eigen::VectorXd()}});
  }
  for (const ErrorSymbol symbol : model.model().layout().symbols()) {
    all.push_back({{}, nullptr, symbol, {Eigen::VectorXd()}});
  }
  return all;
}

Eigen::MatrixXd family_columns(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(model.size()), family.amplitudes());
  const auto& parts = model.parts();
  for (std::size_t setup = 0; setup + 1 < parts.size(); ++setup) {
    fill_columns(model, family, shape, setup,
                 columns.middleRows(parts[setup], parts[setup + 1] - parts[setup]));
  }
  return columns;
}

std::vector<FamilyTest> test_families(const LinearModel& model, const std::vector<Family>& families,
                                      const Projector& projector, int threads) {
  return FamilyTester(model, families, projector).run(threads);
}

}  // namespace volcal
