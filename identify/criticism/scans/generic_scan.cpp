#include "volcal/identify/criticism/scans/generic_scan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "volcal/identify/criticism/data/figure_data.h"
#include "volcal/identify/criticism/projection/score_statistics.h"
#include "volcal/identify/criticism/scans/wave_scan.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/model/description/variable.h"

namespace volcal {
namespace {

constexpr int kSingleWaves = 10;
constexpr int kPairWaves = 4;

/// What the columns of a variable are made of.
struct Features {
  Eigen::MatrixXd powers;
  Eigen::MatrixXd waves;
};

/// What a function of the variables may do.
struct ScanAction {
  enum class Kind { Displacement, Beam, Rotation } kind = Kind::Displacement;
  std::optional<ScanDirection> direction;  ///< not of a rotation
  std::optional<ErrorSymbol> rotation;     ///< of a rotation
  Eigen::VectorXd column;                  ///< derivative of every observation
};

std::vector<ScanAction> scan_actions(const LinearModel& model) {
  std::vector<ScanAction> actions;
  for (const ScanDirection direction : kScanDirections) {
    const bool beam = direction == ScanDirection::Beam;
    actions.push_back({beam ? ScanAction::Kind::Beam : ScanAction::Kind::Displacement,
                       direction,
                       {},
                       model.direction(direction)});
  }
  for (const Axis& axis : model.campaign().machine.axes) {
    for (const Component component : {Component::A, Component::B, Component::C}) {
      const ErrorSymbol symbol{component, axis.name};
      actions.push_back({ScanAction::Kind::Rotation, {}, symbol, model.motion(symbol)});
    }
  }
  return actions;
}

/// Has an action a reason to follow these variables? The machine does not know the beam, nor which station
/// looks at it; a station that moves does so in time; and a beam does not know the machine but by its own
/// length and elevation.
bool has_reason(const Variable& a, const Variable& b, ScanAction::Kind kind) {
  const bool machine = a.is_machine_state() || b.is_machine_state();
  if (kind == ScanAction::Kind::Beam) return !machine;
  if (a.is_of_the_beam() || b.is_of_the_beam()) return false;
  const auto either = [&](Variable::Kind of) { return a.kind == of || b.kind == of; };
  if (!either(Variable::Kind::Station)) return true;
  return kind == ScanAction::Kind::Displacement && !machine && !either(Variable::Kind::Tool);
}

/// Of the readings in use.
double typical_sigma(const LinearModel& model) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const double sigma : model.problem().data.sigma) {
    if (!std::isfinite(sigma)) continue;
    sum += sigma * sigma;
    ++count;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
}

/// The best fit's size follows from the test: LM = |g~ a|^2 in units of the noise.
double size_of(double lm, const Projector& projector, double typical_sigma) {
  return std::sqrt(std::max(0.0, lm) / static_cast<double>(projector.observations())) * typical_sigma;
}

/// One variable, or two. Columns: polynomials of the displacements, their waves, then polynomials and waves
/// of every other action.
struct ScanItem {
  std::size_t a = 0;
  std::size_t b = 0;  ///< same as a: one
  Eigen::Index polynomials = 0;
  Eigen::Index waves = 0;
  std::vector<std::size_t> actions;  ///< displacements first, all of them or none
  Eigen::Index displacements = 0;
  std::size_t first_test = 0;

  Eigen::Index columns() const { return static_cast<Eigen::Index>(actions.size()) * (polynomials + waves); }
  /// One of every action, one of the displacements together; as polynomials and as a kernel.
  std::size_t tests() const { return 2 * (actions.size() + (displacements > 0 ? 1 : 0)); }
  Eigen::Index first_polynomial(Eigen::Index action) const {
    return action < displacements ? action * polynomials : action * (polynomials + waves);
  }
  Eigen::Index first_wave(Eigen::Index action) const {
    return action < displacements ? displacements * polynomials + action * waves
                                  : first_polynomial(action) + polynomials;
  }
};

struct ScanBlock {
  std::vector<ScanItem> items;
  Eigen::Index columns = 0;
};

class GenericScanner {
 public:
  GenericScanner(const LinearModel& model, const std::vector<ScanVariable>& variables,
                 const Projector& projector)
      : model_(model),
        variables_(variables),
        projector_(projector),
        actions_(scan_actions(model)),
        typical_sigma_(typical_sigma(model)) {
    for (const ScanVariable& variable : variables)
      features_.push_back({scan_powers(variable), scan_waves(variable, kSingleWaves)});
    log_count_ = std::log(static_cast<double>(projector.observations()));
  }

  std::vector<GenericTest> run(int threads) {
    const std::vector<ScanBlock> all = blocks();
    run_parallel(all.size(), threads, [&](std::size_t i) { test(all[i]); });
    return std::move(tests_);
  }

  /// Of the tests that are no waves.
  Eigen::MatrixXd displacements(const std::vector<std::size_t>& tests) {
    const std::vector<ScanBlock> all = blocks();
    Eigen::MatrixXd moved(static_cast<Eigen::Index>(model_.size()), static_cast<Eigen::Index>(tests.size()));
    for (const ScanBlock& block : all) {
      for (const ScanItem& item : block.items) {
        for (std::size_t k = 0; k < tests.size(); ++k) {
          if (tests[k] < item.first_test || tests[k] >= item.first_test + item.tests()) continue;
          moved.col(static_cast<Eigen::Index>(k)) = displacement(item, tests[k] - item.first_test);
        }
      }
    }
    return moved;
  }

 private:
  std::vector<ScanBlock> blocks() {
    std::vector<ScanBlock> all;
    std::size_t tests = 0;
    const auto add = [&](ScanItem item) {
      for (std::size_t k = 0; k < actions_.size(); ++k) {
        if (has_reason(variables_[item.a].variable, variables_[item.b].variable, actions_[k].kind))
          item.actions.push_back(k);
      }
      if (item.actions.empty()) return;
      item.displacements = std::ranges::count_if(
          item.actions, [this](std::size_t k) { return actions_[k].kind == ScanAction::Kind::Displacement; });
      if (all.empty() || all.back().columns + item.columns() > kBlockColumns) all.emplace_back();
      item.first_test = tests;
      all.back().items.push_back(item);
      all.back().columns += item.columns();
      tests += item.tests();
    };
    for (std::size_t a = 0; a < variables_.size(); ++a) {
      add({a, a, features_[a].powers.cols(), features_[a].waves.cols(), {}});
      for (std::size_t b = a + 1; b < variables_.size(); ++b) {
        if (exclude_each_other(variables_[a], variables_[b])) continue;
        add({a, b, pair_polynomials(a, b), pair_waves(a) * pair_waves(b), {}});
      }
    }
    tests_.resize(tests);
    return all;
  }

  /// a b, a^2 b, a b^2; of temperatures and time a and b, too: an effect may follow their difference.
  Eigen::Index pair_polynomials(std::size_t a, std::size_t b) const {
    return 1 + (variables_[a].two_valued ? 0 : 1) + (variables_[b].two_valued ? 0 : 1) +
           (follow_the_clock(a, b) ? 2 : 0);
  }

  bool follow_the_clock(std::size_t a, std::size_t b) const {
    return variables_[a].variable.is_of_environment() && variables_[b].variable.is_of_environment();
  }

  Eigen::Index pair_waves(std::size_t variable) const {
    return std::min<Eigen::Index>(kPairWaves, features_[variable].waves.cols());
  }

  /// Indicators of tools, and of stations, do not meet in one reading.
  static bool exclude_each_other(const ScanVariable& a, const ScanVariable& b) {
    return a.variable.kind == b.variable.kind && a.variable.is_indicator();
  }

  /// Rows of one setup.
  void fill(const ScanItem& item, std::size_t setup, Eigen::Ref<Eigen::MatrixXd> columns) const {
    const Eigen::Index first = model_.parts()[setup], count = columns.rows();
    const Eigen::MatrixXd polynomials = polynomials_of(item, first, count);
    const Eigen::MatrixXd waves = waves_of(item, first, count);
    for (std::size_t k = 0; k < item.actions.size(); ++k) {
      const auto action = static_cast<Eigen::Index>(k);
      const auto acts = actions_[item.actions[k]].column.segment(first, count).asDiagonal();
      columns.middleCols(item.first_polynomial(action), item.polynomials) = acts * polynomials;
      columns.middleCols(item.first_wave(action), item.waves) = acts * waves;
    }
  }

  Eigen::MatrixXd polynomials_of(const ScanItem& item, Eigen::Index first, Eigen::Index count) const {
    if (item.a == item.b) return features_[item.a].powers.middleRows(first, count);
    const ScanVariable &a = variables_[item.a], &b = variables_[item.b];
    const auto of_a = a.value.segment(first, count), of_b = b.value.segment(first, count);
    Eigen::MatrixXd columns(count, item.polynomials);
    Eigen::Index at = 0;
    columns.col(at++) = of_a.cwiseProduct(of_b);
    if (!a.two_valued) columns.col(at++) = columns.col(0).cwiseProduct(of_a);
    if (!b.two_valued) columns.col(at++) = columns.col(0).cwiseProduct(of_b);
    if (follow_the_clock(item.a, item.b)) {
      columns.col(at++) = of_a;
      columns.col(at++) = of_b;
    }
    return columns;
  }

  Eigen::MatrixXd waves_of(const ScanItem& item, Eigen::Index first, Eigen::Index count) const {
    const auto a = features_[item.a].waves.middleRows(first, count);
    if (item.a == item.b) return a;
    const Eigen::Index of_b = pair_waves(item.b);
    const auto b = features_[item.b].waves.middleRows(first, count).leftCols(of_b);
    Eigen::MatrixXd columns(count, item.waves);
    for (Eigen::Index k = 0; k < pair_waves(item.a); ++k)
      columns.middleCols(k * of_b, of_b) = a.col(k).asDiagonal() * b;
    return columns;
  }

  void fill(const ScanBlock& block, std::size_t setup, Eigen::Ref<Eigen::MatrixXd> rows) const {
    Eigen::Index at = 0;
    for (const ScanItem& item : block.items) {
      fill(item, setup, rows.middleCols(at, item.columns()));
      at += item.columns();
    }
  }

  void test(const ScanBlock& block) {
    CandidateColumns candidates{block.columns, {}, [&](std::size_t setup, Eigen::Ref<Eigen::MatrixXd> rows) {
                                  fill(block, setup, rows);
                                }};
    for (const ScanItem& item : block.items) add_groups(item, candidates.groups);
    const ProjectedColumns projected = projector_.project(candidates);
    Eigen::Index at = 0;
    for (const ScanItem& item : block.items) {
      test(item, projected, at);
      at += item.columns();
    }
  }

  /// Stretches of columns that are tested together.
  static void add_groups(const ScanItem& item, std::vector<Eigen::Index>& groups) {
    if (item.displacements > 0)
      groups.insert(groups.end(), {item.displacements * item.polynomials, item.displacements * item.waves});
    for (auto k = static_cast<std::size_t>(item.displacements); k < item.actions.size(); ++k)
      groups.insert(groups.end(), {item.polynomials, item.waves});
  }

  /// Of the test of an item: polynomials and kernel of every action in turn, then of the displacements
  /// together.
  Eigen::VectorXd displacement(const ScanItem& item, std::size_t test) const {
    const bool kernel = test % 2 == 1, together = test / 2 == item.actions.size();
    const auto action = together ? 0 : static_cast<Eigen::Index>(test / 2);
    const Eigen::Index several = together ? item.displacements : 1;
    const Eigen::Index first = kernel ? item.first_wave(action) : item.first_polynomial(action);
    const Eigen::Index count = several * (kernel ? item.waves : item.polynomials);
    Eigen::MatrixXd all(static_cast<Eigen::Index>(model_.size()), item.columns());
    const auto& parts = model_.parts();
    for (std::size_t setup = 0; setup + 1 < parts.size(); ++setup)
      fill(item, setup, all.middleRows(parts[setup], parts[setup + 1] - parts[setup]));
    const Eigen::MatrixXd columns = all.middleCols(first, count);
    const ProjectedColumns projected = projector_.project(columns);
    if (kernel) return columns * projected.score;
    return columns * score_test(projected, 0, count).amplitude;
  }

  void test(const ScanItem& item, const ProjectedColumns& projected, Eigen::Index first) {
    std::vector<Variable> names = {variables_[item.a].variable};
    if (item.b != item.a) names.push_back(variables_[item.b].variable);
    std::size_t test = item.first_test;
    const auto add = [&](const ScanAction& action, Eigen::Index begin, Eigen::Index several) {
      tests_[test++] =
          polynomial(names, action,
                     score_test(projected, first + item.first_polynomial(begin), several * item.polynomials));
      tests_[test++] = kernel(names, action, projected, first + item.first_wave(begin), several * item.waves);
    };
    for (std::size_t k = 0; k < item.actions.size(); ++k)
      add(actions_[item.actions[k]], static_cast<Eigen::Index>(k), 1);
    if (item.displacements > 0) add({ScanAction::Kind::Displacement, {}, {}, {}}, 0, item.displacements);
    find_directions(std::span(tests_).subspan(item.first_test, item.tests()));
  }

  /// A rotation shows most where a displacement that it brings about stands out most; several displacements
  /// together, in the one that stands out most.
  static void find_directions(std::span<GenericTest> tests) {
    for (GenericTest& test : tests) {
      if (test.direction) continue;
      const GenericTest* most = nullptr;
      for (const GenericTest& other : tests) {
        if (!other.direction || other.direction == ScanDirection::Beam || other.rotation) continue;
        if (test.rotation && turns_about(*test.rotation, *other.direction)) continue;
        if (most == nullptr || other.log10_p < most->log10_p) most = &other;
      }
      test.direction = most->direction;
    }
  }

  static bool turns_about(const ErrorSymbol& rotation, ScanDirection direction) {
    return static_cast<std::size_t>(direction_of(rotation.component)) == index_of(direction);
  }

  double explained_rms(double lm) const { return size_of(lm, projector_, typical_sigma_); }

  GenericTest polynomial(const std::vector<Variable>& names, const ScanAction& action,
                         const ScoreTest& score) const {
    return {names,
            action.direction,
            action.rotation,
            false,
            score.log10_p,
            score.lm,
            static_cast<double>(score.dof),
            score.lm - score.dof * log_count_,
            explained_rms(score.lm)};
  }

  GenericTest kernel(const std::vector<Variable>& names, const ScanAction& action,
                     const ProjectedColumns& projected, Eigen::Index first, Eigen::Index columns) const {
    const KernelTest test = kernel_test(projected, first, columns);
    return {names,
            action.direction,
            action.rotation,
            true,
            test.log10_p,
            test.lm,
            test.dof,
            0.0,
            explained_rms(test.lm - test.dof)};
  }

  const LinearModel& model_;
  const std::vector<ScanVariable>& variables_;
  const Projector& projector_;
  std::vector<ScanAction> actions_;
  double typical_sigma_;
  std::vector<Features> features_;
  std::vector<GenericTest> tests_;
  double log_count_ = 0.0;
};

Eigen::VectorXd wave_displacement(const LinearModel& model, const Projector& projector,
                                  const GenericTest& test) {
  const Eigen::MatrixXd columns =
      wave_columns(model, test.variables.front().axis, test.direction.value(), test.period);
  return columns * score_test(projector.project(columns), 0, columns.cols()).amplitude;
}

}  // namespace

Eigen::MatrixXd scanned_displacements(const LinearModel& model, const std::vector<ScanVariable>& variables,
                                      const Projector& projector, const std::vector<GenericTest>& tests,
                                      const std::vector<std::size_t>& chosen) {
  Eigen::MatrixXd moved = GenericScanner(model, variables, projector).displacements(chosen);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const GenericTest& test = tests[chosen[k]];
    if (test.period > 0.0)
      moved.col(static_cast<Eigen::Index>(k)) = wave_displacement(model, projector, test);
  }
  return moved;
}

double explained_rms(double lm, const LinearModel& model, const Projector& projector) {
  return size_of(lm, projector, typical_sigma(model));
}

std::vector<GenericTest> wave_tests(const LinearModel& model, const Projector& projector, int threads) {
  const double log_count = std::log(static_cast<double>(projector.observations()));
  const double sigma = typical_sigma(model);
  std::vector<GenericTest> tests;
  for (const WaveTest& wave : wave_scan(model, projector, threads)) {
    // The period counts as one degree of freedom in the gain, as that of a name does.
    tests.push_back({{{Variable::Kind::Position, wave.axis}},
                     wave.direction,
                     {},
                     false,
                     wave.log10_p,
                     wave.lm,
                     static_cast<double>(wave.dof),
                     wave.lm - (wave.dof + 1) * log_count,
                     size_of(wave.projected_lm, projector, sigma),
                     wave.period,
                     wave.log10_choices});
  }
  return tests;
}

std::vector<GenericTest> generic_scan(const LinearModel& model, const std::vector<ScanVariable>& variables,
                                      const Projector& projector, int threads) {
  return GenericScanner(model, variables, projector).run(threads);
}

}  // namespace volcal
