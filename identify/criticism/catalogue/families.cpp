#include "volcal/identify/criticism/catalogue/families.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "volcal/identify/criticism/catalogue/family_products.h"
#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
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
  const MeasuredRange& range = model.measured(symbol.axis);
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

}  // namespace

std::string Family::label() const {
  if (resolution) return resolution->name() + " finer";
  return common_label(*effect);
}

bool Family::is_left_out() const { return effect && effect->name().kind == kLeftOut; }

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

Eigen::VectorXd Family::largest_amplitudes() const {
  if (resolution) return {};
  Eigen::VectorXd largest(amplitudes());
  for (Eigen::Index k = 0; k < largest.size(); ++k)
    largest[k] = largest_amplitude(*effect, effect->amplitudes()[static_cast<std::size_t>(k)]);
  return largest;
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
    all.push_back({std::move(error.spec),
                   std::move(error.effect),
                   std::nullopt,
                   {Eigen::VectorXd()},
                   std::move(error.orders)});
  }
  for (const ErrorSymbol symbol : model.model().layout().symbols()) {
    all.push_back({{}, nullptr, symbol, {Eigen::VectorXd()}});
  }
  std::ranges::move(own_families(model, own), std::back_inserter(all));
  return all;
}

/// Of several by one name the last one written.
std::vector<Family> own_families(const LinearModel& model, std::span<const EffectSpec> own) {
  std::set<EffectName> present = effects_of(model);
  std::vector<Family> all;
  for (auto written = own.rbegin(); written != own.rend(); ++written) {
    const EffectSpec& spec = *written;
    std::unique_ptr<Effect> effect = find_effect(spec.kind)->make(spec, {});
    if (!present.insert(effect->name()).second) continue;
    effect->check(model.campaign(), {});
    std::vector<Eigen::VectorXd> scan = effect->scan(model.campaign());
    all.push_back({spec, std::move(effect), std::nullopt, std::move(scan)});
  }
  std::ranges::reverse(all);
  return all;
}

namespace {

/// Is each of the amplitudes seen, beside a model in which the others are zero?
bool each_is_seen(const ScoreTest& score, const ProjectedColumns& projected, Eigen::Index first,
                  const Eigen::VectorXd& largest) {
  const Eigen::ArrayXd norm = projected.norm.segment(first, largest.size());
  const Eigen::ArrayXd left = score.gram.diagonal().array().max(0.0).sqrt();
  return (norm * largest.array() >= 1.0 && left > kThresholds.invisible_share * norm).all();
}

ScoreTest nothing_visible(Eigen::Index amplitudes) {
  ScoreTest test;
  test.amplitude = Eigen::VectorXd::Zero(amplitudes);
  test.covariance = Eigen::MatrixXd::Zero(amplitudes, amplitudes);
  test.gram = Eigen::MatrixXd::Zero(amplitudes, amplitudes);
  test.score = Eigen::VectorXd::Zero(amplitudes);
  return test;
}

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

ScoreTest family_score(const Family& family, const ProjectedColumns& projected, Eigen::Index first,
                       const Eigen::VectorXd& largest) {
  const Eigen::Index columns = family.amplitudes();
  ScoreTest test = score_test(projected, first, columns, largest);
  if (largest.size() == 0 || test.dof == 0) return test;
  const bool is_one_thing = columns > 1 && !family.independent_components();
  const bool is_too_large = (test.amplitude.cwiseAbs().array() > largest.array()).any();
  if (is_too_large || (is_one_thing && !each_is_seen(test, projected, first, largest)))
    return nothing_visible(columns);
  return test;
}

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

void add_family_products(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape,
                         std::size_t setup, const Eigen::Ref<const Eigen::MatrixXd>& rows,
                         Eigen::Ref<Eigen::MatrixXd> sum) {
  if (!family.resolution) {
    model.add_products(*family.effect, shape, setup, rows, sum);
    return;
  }
  Eigen::MatrixXd columns(rows.rows(), sum.rows());
  resolution_columns(model, *family.resolution, setup, columns);
  sum += columns.transpose() * rows;
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
  return FamilyProducts(model, families, projector, threads).tests(families, projector, threads);
}

}  // namespace volcal
