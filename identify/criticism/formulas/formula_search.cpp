#include "volcal/identify/criticism/formulas/formula_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/formulas/further_factors.h"
#include "volcal/identify/criticism/formulas/law.h"
#include "volcal/identify/criticism/projection/score_statistics.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/criticism/search/surface_search.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/effects/kinds/open/custom.h"
#include "volcal/model/effects/kinds/open/empirical.h"
#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr std::size_t kTested = 12;      // laws by their own columns
constexpr std::size_t kExtended = 2;     // laws that further variables are tried with
constexpr std::size_t kTested3 = 6;      // of these, with a further variable
constexpr std::size_t kToldToUser = 10;  // laws that were asked for
constexpr std::size_t kLawsKept = 24;
constexpr int kSweeps = 2;

class FormulaSearch {
 public:
  FormulaSearch(const LinearModel& model, const EffectSpec& surface, const Effect& effect,
                const Projector& projector)
      : model_(model),
        surface_(surface),
        projector_(projector),
        measure_(*effect.surface(), projected_effect(model, projector, effect)),
        surface_evidence_(surface_evidence(model, projector, effect)),
        log_count_(std::log(static_cast<double>(projector.observations()))) {
    const std::vector<Variable> drivers = variables_in(*surface.options.text("drivers"));
    ranges_.reserve(drivers.size());
    for (std::size_t i = 0; i < drivers.size(); ++i) {
      const TensorBasis::Side& side = effect.surface()->sides()[i];
      ranges_.push_back({drivers[i], side.from, side.to});
      functions_.push_back(
          elementary_functions(ranges_.back(), zero_of(model.campaign().machine, drivers[i])));
      if (drivers.size() > 2 || !factors().empty()) functions_.back().push_back(unity());
    }
  }

  /// Best first, all that were tested by their own columns.
  std::vector<FormulaFinding> run() {
    std::vector<Law> laws = ranges_.size() > 2 ? laws_of_beam() : all_laws();
    log_tried_ = std::log(static_cast<double>(std::max<std::size_t>(count_laws(), 1)));
    rank(laws);
    laws.resize(std::min(laws.size(), kTested));
    for (Law& law : laws) climb_shape(law, [this](const Law& each) { return measure_.lm(each); });
    std::vector<FormulaFinding> findings;
    for (const Law& law : laws) findings.push_back(finding(law));
    if (ranges_.size() < kMostFactors) add_extended(laws, findings);
    std::ranges::stable_sort(findings, std::greater{}, &FormulaFinding::log_evidence);
    return findings;
  }

  double evidence_of_surface() const { return surface_evidence_; }
  std::size_t tried() const { return static_cast<std::size_t>(std::lround(std::exp(log_tried_))); }

 private:
  std::vector<Variable> factors() const { return variables_in(surface_.options.text("factor").value_or("")); }

  bool is_law(const Law& law) const { return law.depends() || !factors().empty(); }

  /// How many products the grammar has.
  std::size_t count_laws() const {
    std::vector<std::size_t> by_shapes(kMostLawShapes + 1, 0);
    by_shapes[0] = 1;
    for (const auto& functions : functions_) {
      std::vector<std::size_t> next(kMostLawShapes + 1, 0);
      for (std::size_t used = 0; used < by_shapes.size(); ++used) {
        for (const ElementaryFunction& function : functions) {
          if (used + function.shapes() <= kMostLawShapes) next[used + function.shapes()] += by_shapes[used];
        }
      }
      by_shapes = std::move(next);
    }
    std::size_t count = 0;
    for (const std::size_t each : by_shapes) count += each;
    return count;
  }

  /// By LM less the price of the shape.
  double worth(const Law& law) const { return law.lm - static_cast<double>(law.shapes()) * log_count_; }
  void rank(std::vector<Law>& laws) const {
    std::ranges::stable_sort(laws, std::greater{}, [this](const Law& law) { return worth(law); });
  }

  /// Every combination of functions at its best start.
  std::vector<Law> all_laws() const {
    std::vector<Law> laws;
    std::vector<LawFactor> chosen;
    const std::function<void(std::size_t)> choose = [&](std::size_t shapes) {
      if (chosen.size() == functions_.size()) {
        laws.push_back(best_start(chosen));
        return;
      }
      for (const ElementaryFunction& function : functions_[chosen.size()]) {
        if (shapes + function.shapes() > kMostLawShapes) continue;
        chosen.push_back({&function, &ranges_[chosen.size()]});
        choose(shapes + function.shapes());
        chosen.pop_back();
      }
    };
    choose(0);
    return laws;
  }

  Law best_start(const std::vector<LawFactor>& chosen) const {
    Law best{chosen, {}, -1.0};
    Law law{chosen, {}, 0.0};
    const std::function<void(std::size_t)> go_on = [&](std::size_t i) {
      if (i == chosen.size()) {
        law.lm = measure_.lm(law);
        if (law.lm > best.lm) best = law;
        return;
      }
      for (const std::vector<double>& start : chosen[i].function->starts) {
        law.shape.insert(law.shape.end(), start.begin(), start.end());
        go_on(i + 1);
        law.shape.resize(law.shape.size() - start.size());
      }
    };
    go_on(0);
    return best;
  }

  /// From products of functions without a shape, one driver's function after another exchanged for every
  /// other; the best go on.
  std::vector<Law> laws_of_beam() const {
    std::vector<Law> beam;
    std::vector<LawFactor> chosen;
    const std::function<void()> choose = [&] {
      if (chosen.size() == functions_.size()) {
        Law law{chosen, {}, 0.0};
        law.lm = measure_.lm(law);
        if (is_law(law)) beam.push_back(std::move(law));
        return;
      }
      for (const ElementaryFunction& function : functions_[chosen.size()]) {
        if (function.shapes() > 0) continue;
        chosen.push_back({&function, &ranges_[chosen.size()]});
        choose();
        chosen.pop_back();
      }
    };
    choose();
    keep_best(beam);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::size_t driver = 0; driver < functions_.size(); ++driver) {
        std::vector<Law> next = beam;
        for (const Law& law : beam) append_exchanged(law, driver, next);
        keep_best(next);
        beam = std::move(next);
      }
    }
    return beam;
  }

  void append_exchanged(const Law& law, std::size_t driver, std::vector<Law>& next) const {
    const LawMeasure::OfDriver of_driver(measure_, law, driver);
    const std::size_t others = law.shapes() - law.factors[driver].function->shapes();
    std::size_t at = 0;
    for (std::size_t i = 0; i < driver; ++i) at += law.factors[i].function->shapes();
    for (const ElementaryFunction& function : functions_[driver]) {
      if (others + function.shapes() > kMostLawShapes) continue;
      const std::vector<double>* best = nullptr;
      double best_lm = -1.0;
      for (const std::vector<double>& start : function.starts) {
        const double lm = of_driver.lm(function, start);
        if (!(lm > best_lm)) continue;
        best_lm = lm;
        best = &start;
      }
      if (best == nullptr) continue;
      Law other = law;
      const auto begin = other.shape.begin() + static_cast<std::ptrdiff_t>(at);
      other.shape.erase(begin, begin + static_cast<std::ptrdiff_t>(law.factors[driver].function->shapes()));
      other.shape.insert(other.shape.begin() + static_cast<std::ptrdiff_t>(at), best->begin(), best->end());
      other.factors[driver].function = &function;
      other.lm = best_lm;
      if (is_law(other)) next.push_back(std::move(other));
    }
  }

  /// Of laws of the same functions the best.
  void keep_best(std::vector<Law>& laws) const {
    rank(laws);
    std::vector<Law> kept;
    for (Law& law : laws) {
      const auto same = [&](const Law& other) {
        for (std::size_t i = 0; i < law.factors.size(); ++i) {
          if (law.factors[i].function != other.factors[i].function) return false;
        }
        return true;
      };
      if (kept.size() < kLawsKept && std::ranges::none_of(kept, same)) kept.push_back(std::move(law));
    }
    laws = std::move(kept);
  }

  void add_extended(const std::vector<Law>& laws, std::vector<FormulaFinding>& findings) {
    FurtherFactors further(model_, projector_, surface_);
    if (further.tried() == 0) return;
    std::vector<std::size_t> order(findings.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return findings[i].log_evidence; });
    const double before = log_tried_;
    log_tried_ = std::log(std::exp(before) + static_cast<double>(kExtended * further.tried()));
    std::vector<Law> extended;
    for (std::size_t i = 0; i < std::min(order.size(), kExtended); ++i) {
      const Law& law = laws[order[i]];
      const std::unique_ptr<Effect> own = effect_of(law);
      for (Law& longer : further.times(law, *own)) extended.push_back(std::move(longer));
    }
    rank(extended);
    extended.resize(std::min(extended.size(), kTested3));
    for (const Law& law : extended) findings.push_back(finding(law));
    log_tried_ = before;
  }

  EffectSpec spec_of(const Law& law) const {
    std::vector<std::string> parts = written_names(factors());
    if (const std::string product = law.expression(); !product.empty()) parts.push_back(product);
    EffectSpec spec =
        written_spec(*surface_.options.text("target"), fmt::format("{}", fmt::join(parts, " * ")));
    static const std::vector<std::string> kNames = {"p", "q"};
    std::size_t at = 0;
    for (const LawFactor& factor : law.factors) {
      for (std::size_t k = 0; k < factor.function->shapes(); ++k, ++at) {
        spec.options.set(kNames[at], law.shape[at]);
        if (law.smooth_in_shape())
          spec.options.set(kNames[at] + "_sigma", factor.range->to - factor.range->from);
      }
    }
    return spec;
  }

  std::unique_ptr<Effect> effect_of(const Law& law) const {
    const EffectSpec spec = spec_of(law);
    return find_effect(spec.kind)->make(spec, {});
  }

  FormulaFinding finding(const Law& law) const {
    FormulaFinding finding;
    finding.spec = spec_of(law);
    finding.shape_text = law.shape_text();
    const std::unique_ptr<Effect> effect = effect_of(law);
    const ScoreTest score = score_test(projected_effect(model_, projector_, *effect), 0, 1);
    const EffectAmplitude& amplitude = effect->amplitudes().front();
    finding.label = amplitude.label;
    finding.unit = law.amplitude_unit(amplitude.unit());
    finding.si_per_unit = amplitude.si_per_unit();
    if (score.dof == 0) return finding;
    finding.amplitude = score.amplitude[0];
    finding.u = std::sqrt(std::max(0.0, score.covariance(0, 0)));
    finding.spec.options.set("amplitude", finding.amplitude);
    finding.gain = score.lm - static_cast<double>(1 + law.shapes()) * log_count_;
    finding.log_evidence = 0.5 * finding.gain - log_tried_;
    finding.log10_p =
        std::min(0.0, log10_chi_squared_exceedance(score.lm, static_cast<double>(1 + law.shapes())) +
                          log_tried_ / std::log(10.0));
    return finding;
  }

  const LinearModel& model_;
  const EffectSpec& surface_;
  const Projector& projector_;
  LawMeasure measure_;
  double surface_evidence_;
  double log_count_;
  double log_tried_ = 0.0;
  std::vector<DriverRange> ranges_;                         ///< per driver
  std::vector<std::vector<ElementaryFunction>> functions_;  ///< per driver
};

std::vector<std::string> sorted_names(const EffectSpec& surface, const std::string& key) {
  std::vector<std::string> names = written_names(variables_in(surface.options.text(key).value_or("")));
  std::ranges::sort(names);
  return names;
}

bool acts_in_part(const EffectSpec& surface) { return surface.options.has("only"); }

}  // namespace

std::vector<FormulaFinding> formulas_for(const ModelState& state, std::size_t surface) {
  const AddedSurface& own = state.surfaces()[surface];
  if (acts_in_part(own.spec)) return {};
  const std::unique_ptr<Projector> projector = state.projector_without_surface(own);
  FormulaSearch search(state.model(), own.spec, *own.effect, *projector);
  std::vector<FormulaFinding> findings = search.run();
  std::erase_if(findings, [&](const FormulaFinding& each) {
    return !(each.log_evidence >= search.evidence_of_surface());
  });
  const auto is_worse = [&](const FormulaFinding& each) {
    return each.log_evidence < findings.front().log_evidence - 0.5 * kThresholds.indistinguishable_gain;
  };
  if (!findings.empty()) findings.erase(std::ranges::find_if(findings, is_worse), findings.end());
  return findings;
}

bool is_same_function(const EffectSpec& surface, const EffectSpec& other) {
  const EffectKind& kind = empirical_effect();
  return kind.make(surface, {})->name().target == kind.make(other, {})->name().target &&
         sorted_names(surface, "drivers") == sorted_names(other, "drivers") &&
         sorted_names(surface, "factor") == sorted_names(other, "factor");
}

void check_asked_surface(const LinearModel& model, const EffectSpec& surface) {
  if (acts_in_part(surface)) {
    throw InputError({}, "laws cannot be looked for where an effect acts in a part of the campaign alone",
                     "leave out only = ...");
  }
  const EffectKind& kind = empirical_effect();
  kind.make(surface, {})->check(model.campaign(), {});
  kind.resolved(surface, model.views(), {});
}

AskedLaws asked_laws(const ModelState& state, const EffectSpec& surface) {
  const EffectKind& kind = empirical_effect();
  EffectSpec spec = kind.resolved(surface, state.model().views(), {});
  std::shared_ptr<const Effect> effect = kind.make(spec, {});
  std::shared_ptr<const Projector> projector;
  for (const AddedSurface& drawn : state.surfaces()) {
    if (!is_same_function(drawn.spec, spec)) continue;
    projector = state.projector_without_surface(drawn);
    spec = drawn.spec;
    effect = drawn.effect;
  }
  if (!projector) projector = std::make_shared<Projector>(state.projector());
  FormulaSearch search(state.model(), spec, *effect, *projector);
  AskedLaws asked;
  asked.laws = search.run();
  asked.label = effect_label(*effect);
  asked.surface_evidence = search.evidence_of_surface();
  asked.tried = search.tried();
  asked.laws.resize(std::min(asked.laws.size(), kToldToUser));
  return asked;
}

}  // namespace volcal
