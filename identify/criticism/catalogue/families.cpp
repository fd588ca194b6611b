#include "volcal/identify/criticism/catalogue/families.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/legendre_polynomials.h"

namespace volcal {
namespace {

constexpr int kLowestExtraDegree = 4;
constexpr int kHighestExtraDegree = 11;

/// Higher polynomials of an axis' own position: what a function with too few knots leaves.
void resolution_columns(const LinearModel& model, ErrorSymbol symbol, std::size_t setup,
                        Eigen::Ref<Eigen::MatrixXd> columns) {
  const Campaign& campaign = model.campaign();
  const MeasuredRange range = measured_range(campaign, symbol.axis);
  const int target =
      disturbance_of({.kind = TargetKind::Motion, .symbol = symbol, .component = 0}, campaign.machine);
  const auto& position = campaign.setups[setup].readings.position[index_of(symbol.axis)];
  const Eigen::Index first = model.parts()[setup];
  std::array<double, kHighestExtraDegree + 1> polynomials;
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const double q = position[model.observations()[static_cast<std::size_t>(first + i)].row];
    write_legendre_polynomials(kHighestExtraDegree, range.scaled(q), polynomials.data());
    for (int degree = kLowestExtraDegree; degree <= kHighestExtraDegree; ++degree) {
      columns(i, degree - kLowestExtraDegree) =
          polynomials[static_cast<std::size_t>(degree)] * model.sensitivity(first + i, target);
    }
  }
}

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
      (0.5 * (dof - 1) * std::log(lm) - 0.5 * lm - half * std::numbers::ln2 - std::lgamma(half)) /
          std::numbers::ln10 +
      std::log10(std::max(variation, 1e-300));
  const double multiplicity = 1.0 + std::pow(10.0, log10_crossings - log10_chi_squared_exceedance(lm, dof));
  return std::min(multiplicity, static_cast<double>(lm_of_shapes.size()));
}

/// Families that are tested together, and the columns of all their shapes.
struct FamilyBlock {
  std::vector<std::size_t> family;
  Eigen::Index columns = 0;
};

class FamilyTester {
 public:
  FamilyTester(const LinearModel& model, const std::vector<Family>& families, const Projector& projector)
      : model_(model), families_(families), projector_(projector) {
    tests_.resize(families.size());
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
    std::vector<Hypothesis> all;
    for (const std::size_t family : block.family) {
      for (const Eigen::VectorXd& shape : families_[family].scan) all.push_back({family, shape});
    }
    const ProjectedColumns projected = projector_.project(columns_of(model_, families_, std::move(all)));
    Eigen::Index first = 0;
    for (const std::size_t family : block.family) {
      tests_[family] = best_shape(projected, family, first, families_[family].amplitudes());
      first += shapes(family) * families_[family].amplitudes();
    }
  }

  FamilyTest best_shape(const ProjectedColumns& projected, std::size_t family, Eigen::Index first,
                        Eigen::Index columns) const {
    const auto& scan = families_[family].scan;
    FamilyTest best;
    best.family = family;
    best.shape = scan.front();
    std::vector<double> lm;
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const ScoreTest test = score_test(projected, first + static_cast<Eigen::Index>(i) * columns, columns);
      lm.push_back(test.lm);
      if (i > 0 && test.lm <= best.score.lm) continue;
      best.score = test;
      best.shape = scan[i];
    }
    best.multiplicity = scan_multiplicity(lm, best.score.lm, best.score.dof);
    update_test(best, families_[family], best.shape, best.score, projector_);
    return best;
  }

  const LinearModel& model_;
  const std::vector<Family>& families_;
  const Projector& projector_;
  std::vector<FamilyTest> tests_;
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

bool Family::independent_components() const {
  if (resolution || amplitudes() < 2) return false;
  std::set<int> components;
  const auto& all = effect->amplitudes();
  for (const EffectAmplitude& amplitude : all) {
    if (amplitude.target.kind == TargetKind::Motion || amplitude.target.kind == TargetKind::Reading)
      return false;
    components.insert(amplitude.target.component);
  }
  return components.size() == all.size();
}

EffectName Family::name() const {
  if (!resolution) return effect->name();
  return resolution_name(*resolution);
}

namespace {

std::set<EffectName> effects_of(const LinearModel& model) {
  std::set<EffectName> present;
  for (const EffectBinding& effect : model.model().binding().effects) present.insert(effect.effect->name());
  return present;
}

}  // namespace

std::vector<Family> families(const LinearModel& model, std::span<const EffectSpec> own) {
  const std::set<EffectName> present = effects_of(model);
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
  std::ranges::move(own_families(model, own), std::back_inserter(all));
  return all;
}

std::vector<Family> own_families(const LinearModel& model, std::span<const EffectSpec> own) {
  std::set<EffectName> present = effects_of(model);
  std::vector<Family> all;
  for (const EffectSpec& spec : own) {
    std::unique_ptr<Effect> effect = find_effect(spec.kind)->make(spec, {});
    if (!present.insert(effect->name()).second) continue;
    effect->check(model.campaign(), {});
    std::vector<Eigen::VectorXd> scan = effect->scan(model.campaign());
    all.push_back({spec, std::move(effect), std::nullopt, std::move(scan)});
  }
  return all;
}

namespace {

/// LM less its price in dof, of the components that are worth it.
double best_of_components(const ScoreTest& score, double price) {
  const auto count = static_cast<int>(score.score.size());
  double best = score.lm - score.dof * price;
  for (int subset = 1; subset + 1 < 1 << count; ++subset) {
    std::vector<Eigen::Index> which;
    for (int k = 0; k < count; ++k) {
      if ((subset >> k & 1) != 0) which.push_back(k);
    }
    best = std::max(best, score.lm_of(which) - static_cast<double>(which.size()) * price);
  }
  return best;
}

}  // namespace

void update_test(FamilyTest& test, const Family& family, const Eigen::VectorXd& shape, const ScoreTest& score,
                 const Projector& projector) {
  const double price = std::log(static_cast<double>(projector.observations()));
  const double shapes = family.scan.size() > 1 ? static_cast<double>(shape.size()) : 0.0;
  test.shape = shape;
  test.score = score;
  test.log10_p = std::min(0.0, score.log10_p + std::log10(test.multiplicity));
  const bool components = family.independent_components() && score.dof > 1;
  test.gain = (components ? best_of_components(score, price) : score.lm - score.dof * price) - shapes * price;
}

void family_columns(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape,
                    std::size_t setup, Eigen::Ref<Eigen::MatrixXd> out) {
  if (family.resolution) {
    resolution_columns(model, *family.resolution, setup, out);
  } else {
    model.columns(*family.effect, shape, setup, out);
  }
}

Eigen::MatrixXd family_columns(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(model.size()), family.amplitudes());
  const auto& parts = model.parts();
  for (std::size_t setup = 0; setup + 1 < parts.size(); ++setup) {
    family_columns(model, family, shape, setup,
                   columns.middleRows(parts[setup], parts[setup + 1] - parts[setup]));
  }
  return columns;
}

CandidateColumns columns_of(const LinearModel& model, const std::vector<Family>& families,
                            std::vector<Hypothesis> hypotheses) {
  CandidateColumns columns;
  for (const Hypothesis& each : hypotheses) {
    columns.groups.push_back(families[each.family].amplitudes());
    columns.count += columns.groups.back();
  }
  columns.fill = [&model, &families, all = std::move(hypotheses)](std::size_t setup,
                                                                  Eigen::Ref<Eigen::MatrixXd> rows) {
    Eigen::Index at = 0;
    for (const Hypothesis& each : all) {
      const Family& family = families[each.family];
      family_columns(model, family, each.shape, setup, rows.middleCols(at, family.amplitudes()));
      at += family.amplitudes();
    }
  };
  return columns;
}

Eigen::VectorXd displacement(const LinearModel& model, const Family& family, const FamilyTest& test) {
  return family_columns(model, family, test.shape) * test.score.amplitude;
}

std::vector<FamilyTest> test_families(const LinearModel& model, const std::vector<Family>& families,
                                      const Projector& projector, int threads) {
  return FamilyTester(model, families, projector).run(threads);
}

}  // namespace volcal
