#include "volcal/identify/criticism/formulas/formula_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/formulas/elementary_functions.h"
#include "volcal/identify/criticism/projection/score_statistics.h"
#include "volcal/identify/criticism/search/surface_search.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {
namespace {

constexpr std::size_t kMostShapes = 2;  // p and q
constexpr std::size_t kTested = 12;     // laws by their own columns
constexpr int kRefinements = 60;        // evaluations of one law's shape
constexpr double kFirstStep = 0.03;     // of the driver's range
constexpr double kLastStep = 3e-4;
const std::vector<std::string> kNames = {"p", "q"};

/// From where a variable counts in a law.
double zero_of(const Machine& machine, const std::string& variable) {
  if (variable.starts_with("T_")) return kReferenceTemperature_degC;
  if (variable.size() != 1) return 0.0;
  for (const Axis& axis : machine.axes) {
    if (lower_letter_of(axis.name) == variable[0]) return axis.home / position_unit(axis.name).si_per_unit;
  }
  return 0.0;
}

/// A product of one function of each driver.
struct Law {
  std::vector<const ElementaryFunction*> functions;
  std::vector<double> shape;  ///< of all functions, one after the other
  double lm = 0.0;

  std::size_t shapes() const { return shape.size(); }
};

/// What the readings say of a surface's coefficients, the model without it having been allowed to explain all
/// it can.
struct CoefficientScores {
  Eigen::MatrixXd gram;
  Eigen::VectorXd score;

  double lm(const Eigen::VectorXd& coefficients) const {
    const double squares = coefficients.dot(gram * coefficients);
    const double along = coefficients.dot(score);
    return squares > 0.0 ? along * along / squares : 0.0;
  }
};

class FormulaSearch {
 public:
  FormulaSearch(const ModelState& state, const AddedSurface& surface)
      : model_(state.model()),
        surface_(surface),
        basis_(*surface.effect->surface()),
        projector_(state.projector_without_surface(surface)),
        log_count_(std::log(static_cast<double>(projector_->observations()))) {
    const std::vector<std::string> drivers = variables_in(*surface.spec.options.text("drivers"));
    for (std::size_t i = 0; i < drivers.size(); ++i) {
      const DriverRange range{drivers[i], basis_.sides()[i].from, basis_.sides()[i].to};
      functions_.push_back(elementary_functions(range, zero_of(model_.campaign().machine, drivers[i])));
      const Eigen::MatrixXd samples = basis_.samples(i);
      to_coefficients_.push_back((samples.transpose() * samples).ldlt().solve(samples.transpose()));
    }
  }

  std::vector<FormulaFinding> run() {
    score_surface();
    const double of_surface = surface_evidence(model_, *projector_, *surface_.effect);
    std::vector<Law> laws = ranked_laws();
    std::vector<FormulaFinding> findings;
    for (std::size_t i = 0; i < std::min(laws.size(), kTested); ++i) {
      FormulaFinding finding = tested(laws[i]);
      if (finding.log_evidence >= of_surface) findings.push_back(std::move(finding));
    }
    std::ranges::sort(findings, std::greater{}, &FormulaFinding::log_evidence);
    const auto is_worse = [&](const FormulaFinding& each) {
      return each.log_evidence < findings.front().log_evidence - 0.5 * kThresholds.indistinguishable_gain;
    };
    if (!findings.empty()) findings.erase(std::ranges::find_if(findings, is_worse), findings.end());
    return findings;
  }

 private:
  void score_surface() {
    const auto count = static_cast<Eigen::Index>(surface_.effect->amplitudes().size());
    const ProjectedColumns projected =
        projector_->project({count, {count}, [&](std::size_t part, Eigen::Ref<Eigen::MatrixXd> rows) {
                               model_.columns(*surface_.effect, surface_.effect->shape_values(), part, rows);
                             }});
    scores_ = {projected.gram(0, count), projected.score};
  }

  /// Of the spline that follows a function of one driver best.
  Eigen::VectorXd coefficients(std::size_t driver, const ElementaryFunction& function,
                               const std::vector<double>& shape) const {
    const auto& side = basis_.sides()[driver];
    Eigen::VectorXd values(to_coefficients_[driver].cols());
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(values.size() - 1);
      values[i] = function.at(side.from + share * (side.to - side.from), shape);
    }
    return to_coefficients_[driver] * values;
  }

  Eigen::VectorXd coefficients(const Law& law) const {
    Eigen::VectorXd product = Eigen::VectorXd::Ones(1);
    std::size_t at = 0;
    for (std::size_t i = 0; i < law.functions.size(); ++i) {
      const std::size_t count = law.functions[i]->shapes();
      const std::vector<double> own(law.shape.begin() + static_cast<std::ptrdiff_t>(at),
                                    law.shape.begin() + static_cast<std::ptrdiff_t>(at + count));
      at += count;
      const Eigen::VectorXd along = coefficients(i, *law.functions[i], own);
      Eigen::VectorXd next(product.size() * along.size());
      for (Eigen::Index k = 0; k < product.size(); ++k)
        next.segment(k * along.size(), along.size()) = product[k] * along;
      product = std::move(next);
    }
    return product;
  }

  /// Every combination of functions at its best start, best first by LM less the price of its shape.
  std::vector<Law> ranked_laws() {
    std::vector<Law> laws;
    std::vector<const ElementaryFunction*> chosen;
    const std::function<void()> choose = [&] {
      if (chosen.size() == functions_.size()) {
        std::size_t shapes = 0;
        for (const ElementaryFunction* each : chosen) shapes += each->shapes();
        if (shapes <= kMostShapes) laws.push_back(best_start(chosen));
        return;
      }
      for (const ElementaryFunction& function : functions_[chosen.size()]) {
        chosen.push_back(&function);
        choose();
        chosen.pop_back();
      }
    };
    choose();
    log_tried_ = std::log(static_cast<double>(std::max<std::size_t>(laws.size(), 1)));
    std::ranges::sort(laws, std::greater{}, [&](const Law& law) {
      return law.lm - static_cast<double>(law.shapes()) * log_count_;
    });
    return laws;
  }

  Law best_start(const std::vector<const ElementaryFunction*>& chosen) const {
    Law best{chosen, {}, -1.0};
    std::vector<double> shape;
    const std::function<void(std::size_t)> go_on = [&](std::size_t i) {
      if (i == chosen.size()) {
        Law law{chosen, shape, 0.0};
        law.lm = scores_.lm(coefficients(law));
        if (law.lm > best.lm) best = law;
        return;
      }
      for (const std::vector<double>& start : chosen[i]->starts) {
        shape.insert(shape.end(), start.begin(), start.end());
        go_on(i + 1);
        shape.resize(shape.size() - start.size());
      }
    };
    go_on(0);
    return best;
  }

  /// By compass search in the splines' measure (Kolda, Lewis and Torczon 2003, SIAM Review 45, 385), then by
  /// its own column.
  FormulaFinding tested(Law law) const {
    std::vector<double> step;
    for (std::size_t i = 0; i < law.functions.size(); ++i) {
      const auto& side = basis_.sides()[i];
      step.insert(step.end(), law.functions[i]->shapes(), kFirstStep * (side.to - side.from));
    }
    double share = 1.0;
    for (int used = 0; used < kRefinements && !step.empty() && share * kFirstStep > kLastStep;) {
      bool better = false;
      for (std::size_t k = 0; k < step.size() && !better; ++k) {
        for (const double sign : {-1.0, 1.0}) {
          Law moved = law;
          moved.shape[k] += sign * share * step[k];
          moved.lm = scores_.lm(coefficients(moved));
          ++used;
          if (!(moved.lm > law.lm)) continue;
          law = std::move(moved);
          better = true;
          break;
        }
      }
      if (!better) share *= 0.5;
    }
    return finding(law);
  }

  std::string expression(const Law& law) const {
    std::vector<std::string> parts = variables_in(surface_.spec.options.text("factor").value_or(""));
    std::size_t at = 0;
    for (const ElementaryFunction* function : law.functions) {
      const std::size_t count = function->shapes();
      parts.push_back(function->text({kNames.begin() + static_cast<std::ptrdiff_t>(at), kNames.end()}));
      at += count;
    }
    return fmt::format("{}", fmt::join(parts, " * "));
  }

  FormulaFinding finding(const Law& law) const {
    FormulaFinding finding;
    finding.spec = effect_spec(
        "custom", {{"target", *surface_.spec.options.text("target")}, {"expression", expression(law)}});
    const bool smooth = std::ranges::all_of(law.functions, &ElementaryFunction::smooth_in_shape);
    std::size_t at = 0;
    for (std::size_t i = 0; i < law.functions.size(); ++i) {
      const auto& side = basis_.sides()[i];
      for (std::size_t k = 0; k < law.functions[i]->shapes(); ++k, ++at) {
        finding.spec.options.set(kNames[at], law.shape[at]);
        if (smooth) finding.spec.options.set(kNames[at] + "_sigma", side.to - side.from);
        finding.shape_text += fmt::format("{}{} = {:.4g}", at > 0 ? ", " : "", kNames[at], law.shape[at]);
      }
    }
    const std::unique_ptr<Effect> effect = find_effect("custom")->make(finding.spec, {});
    const ProjectedColumns projected =
        projector_->project({1, {1}, [&](std::size_t part, Eigen::Ref<Eigen::MatrixXd> rows) {
                               model_.columns(*effect, effect->shape_values(), part, rows);
                             }});
    const ScoreTest score = score_test(projected, 0, 1);
    const EffectAmplitude& amplitude = effect->amplitudes().front();
    finding.label = amplitude.label;
    finding.unit = amplitude.unit();
    finding.si_per_unit = amplitude.si_per_unit();
    if (score.dof == 0) return finding;
    finding.amplitude = score.amplitude[0];
    finding.u = std::sqrt(std::max(0.0, score.covariance(0, 0)));
    finding.spec.options.set("amplitude", finding.amplitude);
    finding.log_evidence =
        0.5 * score.lm - 0.5 * static_cast<double>(1 + law.shapes()) * log_count_ - log_tried_;
    return finding;
  }

  const LinearModel& model_;
  const AddedSurface& surface_;
  const TensorBasis& basis_;
  std::unique_ptr<Projector> projector_;
  double log_count_;
  double log_tried_ = 0.0;
  std::vector<std::vector<ElementaryFunction>> functions_;  ///< per driver
  std::vector<Eigen::MatrixXd> to_coefficients_;            ///< per driver: of values at its samples
  CoefficientScores scores_;
};

}  // namespace

std::vector<FormulaFinding> formulas_for(const ModelState& state, std::size_t surface) {
  const AddedSurface& own = state.surfaces()[surface];
  if (own.effect->surface()->sides().size() > 2 || own.spec.options.has("only")) return {};
  return FormulaSearch(state, own).run();
}

}  // namespace volcal
