#include "volcal/identify/criticism/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <stdexcept>

#include "volcal/identify/criticism/catalogue/detectable.h"
#include "volcal/identify/criticism/catalogue/not_looked_for.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/figures/diagnosis_figures.h"
#include "volcal/identify/criticism/proposals/confounding.h"
#include "volcal/identify/criticism/proposals/next_measurement.h"
#include "volcal/identify/criticism/search/effect_search.h"
#include "volcal/identify/solve/result.h"
#include "volcal/identify/stats/channels.h"
#include "volcal/identify/stats/chi_squared.h"
#include "volcal/identify/stats/threads.h"
#include "volcal/model/description/units.h"

namespace volcal {

namespace {

constexpr std::size_t kListed = 40;
constexpr std::size_t kMostUnknown = 10;
constexpr std::size_t kMostAmplitudesInWords = 3;
constexpr const char* kNotReducedWords =
    "More remains: readings that were held out are still off by more than noise, hardly less than before. "
    "The "
    "effect may be another one that acts in the same places.";
constexpr const char* kKnownMore =
    "More remains, and the catalogue has a name for it: extend the model and diagnose again, or climb with "
    "--auto.";

SearchOptions search_options(const DiagnoseOptions& options) {
  return {.threads = thread_count(options.threads),
          .most = options.most_effects,
          .climb = options.climb,
          .leave_out = options.leave_out,
          .progress = options.progress};
}

class Diagnostician {
 public:
  Diagnostician(const Campaign& campaign, const FitResult& result, const DiagnoseOptions& options)
      : options_(options),
        result_(result),
        model_(campaign, result),
        heldout_(heldout_lines(model_, options.heldout_share)),
        search_(model_, heldout_, search_options(options)),
        families_(search_.families()) {
    removed_by_fit_ = model_.removed().size();
  }

  Diagnosis run() {
    search_.run();
    list_removed();
    diagnosis_.notes = model_.campaign().notes;
    diagnosis_.not_looked_for = not_looked_for(model_.campaign(), families_);
    diagnosis_.families = families_.size();
    diagnosis_.generic_tests = search_.generic().size();
    diagnosis_.ladder = search_.ladder();
    list_added();
    list_detectable();
    rank();
    collect_unknown();
    list_noise();
    conclude();
    compare_hypotheses();
    draw();
    progress("done", 1.0);
    return std::move(diagnosis_);
  }

 private:
  void progress(const std::string& stage, double done) const {
    if (options_.progress) options_.progress(stage, done);
  }

  void list_removed() {
    std::vector<std::size_t> removed = model_.removed();
    std::ranges::sort(removed);
    for (const std::size_t observation : removed) {
      const auto& [of_setup, row, channel] = model_.observations()[observation];
      const Setup& setup = model_.campaign().setups[of_setup];
      diagnosis_.removed_readings.push_back(
          {setup.name, setup.readings.source_line[row], std::string(channel_column(setup, channel))});
    }
  }

  void list_noise() {
    diagnosis_.noise = noise_table(search_.noise_with_uncertainty());
    diagnosis_.noise_instruments = model_.noise_groups();
  }

  EffectFinding finding(const FamilyTest& test) const {
    const Family& family = families_[test.family];
    EffectFinding out;
    out.name = family.name();
    out.label = family.label();
    out.spec = family.spec;
    out.log10_p = search_.family_wise_log10_p(test);
    out.lm = test.score.lm;
    out.dof = test.score.dof;
    out.gain = test.gain;
    out.visible_fraction = test.score.visible_fraction;
    out.resolution = family.resolution.has_value();
    if (!family.effect) return out;
    const double found_from = std::sqrt(
        detectable_noncentrality(search_.log10_level(), std::max(1, test.score.dof), kThresholds.power));
    for (const EffectAmplitude& amplitude : family.effect->amplitudes()) {
      const auto at = static_cast<Eigen::Index>(out.amplitudes.size());
      const double u = std::sqrt(std::max(0.0, test.score.covariance(at, at)));
      out.amplitudes.push_back({amplitude.label, test.score.amplitude[at], u,
                                u > 0.0 ? u * found_from : std::nan(""), amplitude.unit(),
                                amplitude.si_per_unit()});
    }
    state_values(family, test.shape, Eigen::VectorXd::Zero(test.shape.size()), out);
    return out;
  }

  /// Amplitudes and shape of a finding into its specification, the shape in words.
  static void state_values(const Family& family, const Eigen::VectorXd& shape, const Eigen::VectorXd& u,
                           EffectFinding& out) {
    const auto& amplitudes = family.effect->amplitudes();
    for (std::size_t k = 0; k < amplitudes.size(); ++k) {
      out.spec.options.set(std::string(stem_of_key(amplitudes[k].key)), out.amplitudes[k].value);
    }
    const auto& shapes = family.effect->shapes();
    out.shape_text.clear();
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const std::string stem(stem_of_key(shapes[k].key));
      const double si = shapes[k].si_per_unit();
      out.spec.options.set(stem, shape[at]);
      out.shape_text += fmt::format("{}{} {:.4g}", k > 0 ? ", " : "", stem, shape[at] / si);
      if (u[at] > 0.0) out.shape_text += fmt::format(" +- {:.2g}", kCoverageFactor * u[at] / si);
      out.shape_text += " " + shapes[k].unit();
    }
  }

  /// Everything added, estimated together.
  void list_added() {
    if (search_.added().empty()) return;
    const auto projector = search_.projector_of_all_readings();
    const Eigen::VectorXd solution = projector->solution();
    const Eigen::MatrixXd covariance = projector->accepted_covariance();
    Eigen::Index at = 0;
    for (const AddedEffect& added : search_.added()) {
      const Eigen::Index count = added.columns.cols();
      const Eigen::VectorXd values = solution.segment(solution.size() - covariance.rows() + at, count);
      const Eigen::VectorXd u = covariance.diagonal().segment(at, count).cwiseMax(0.0).cwiseSqrt();
      at += count;
      list(added, estimated(added, values, u));
    }
  }

  EffectFinding estimated(const AddedEffect& added, const Eigen::VectorXd& values,
                          const Eigen::VectorXd& u) const {
    const Family& family = families_[added.test.family];
    EffectFinding out = finding(added.test);
    if (!family.effect) return out;
    for (std::size_t k = 0; k < out.amplitudes.size(); ++k) {
      out.amplitudes[k].value = values[static_cast<Eigen::Index>(k)];
      out.amplitudes[k].u = u[static_cast<Eigen::Index>(k)];
    }
    Eigen::VectorXd shape = added.test.shape, shape_u = Eigen::VectorXd::Zero(shape.size());
    if (values.size() > family.amplitudes()) {
      for (Eigen::Index k = 0; k < shape.size(); ++k) {
        const EffectShape& own = family.effect->shapes()[static_cast<std::size_t>(k)];
        const double moved = shape[k] + values.tail(shape.size())[k];
        shape[k] = own.scan_min < own.scan_max ? std::clamp(moved, own.scan_min, own.scan_max) : moved;
      }
      shape_u = u.tail(shape.size());
    }
    state_values(family, shape, shape_u, out);
    return out;
  }

  /// A change of the model, a name, or one of several names.
  void list(const AddedEffect& added, const EffectFinding& finding) {
    if (added.rivals.empty()) {
      (finding.resolution ? diagnosis_.model_changes : diagnosis_.effects).push_back(finding);
      return;
    }
    std::vector<EffectFinding> set{finding};
    for (const FamilyTest& rival : added.rivals) set.push_back(this->finding(rival));
    if (diagnosis_.one_of.empty()) {
      diagnosis_.one_of = std::move(set);
    } else {
      diagnosis_.further_one_of.push_back(std::move(set));
    }
  }

  /// The direction of the scan whose share in the readings is most like that of a change.
  std::string direction_of_change(const Eigen::VectorXd& moved) const {
    std::size_t nearest = 0;
    double best = -1.0;
    for (std::size_t k = 0; k < std::size(kScanDirections); ++k) {
      const Eigen::VectorXd along = model_.direction(static_cast<int>(k));
      const double likeness = moved.cwiseAbs().dot(along.cwiseAbs()) / std::max(1e-300, along.norm());
      if (likeness <= best) continue;
      best = likeness;
      nearest = k;
    }
    return kScanDirections[nearest];
  }

  /// At the given model: what would have been found, and what could not be.
  void list_detectable() {
    const FunctionalPointLevers levers(model_);
    for (const FamilyTest& test : search_.first_tests()) {
      const Family& family = families_[test.family];
      if (family.resolution) continue;
      const EffectFinding found = finding(test);
      const bool visible = test.score.dof > 0 && test.score.visible_fraction >= kThresholds.visible_fraction;
      if (!visible) diagnosis_.not_visible.push_back(found);
      diagnosis_.detectable.push_back(detectable(found, *family.effect, test.shape, visible, levers));
    }
  }

  /// By the amplitude that is hardest to find.
  static DetectableEffect detectable(const EffectFinding& found, const Effect& effect,
                                     const Eigen::VectorXd& shape, bool visible,
                                     const FunctionalPointLevers& levers) {
    std::size_t hardest = 0;
    for (std::size_t k = 1; k < found.amplitudes.size(); ++k) {
      if (!(found.amplitudes[k].mdb <= found.amplitudes[hardest].mdb)) hardest = k;
    }
    const AmplitudeFigure& amplitude = found.amplitudes[hardest];
    return {found.name,     found.label,           found.shape_text,
            amplitude.unit, amplitude.si_per_unit, found.visible_fraction,
            visible,        amplitude.mdb,         amplitude.mdb * levers.rms(effect, shape, hardest)};
  }

  void draw() {
    if (!options_.figures) return;
    std::vector<std::size_t> added;
    std::vector<Eigen::MatrixXd> columns;
    for (const AddedEffect& effect : search_.added()) {
      added.push_back(effect.test.family);
      columns.push_back(effect.columns);
    }
    diagnosis_.figures = diagnosis_figures(
        {model_, heldout_, search_.noise(), search_.projector(), families_, search_.tests(), added, columns,
         search_.variables(), search_.first_generic(), search_.generic(), thread_count(options_.threads)});
  }

  void rank() {
    std::vector<const FamilyTest*> order;
    for (const FamilyTest& test : search_.tests()) {
      if (test.score.dof > 0 && !search_.is_added(test.family)) order.push_back(&test);
    }
    std::ranges::sort(order, std::greater{}, &FamilyTest::gain);
    for (std::size_t i = 0; i < std::min(kListed, order.size()); ++i) {
      diagnosis_.ranking.push_back(finding(*order[i]));
    }
  }

  /// Significant generic tests, leading first, one per set of variables.
  void collect_unknown() {
    std::vector<const GenericTest*> order = search_.outstanding_scans();
    std::ranges::sort(order, {}, &GenericTest::log10_p);
    put_simplest_first(order);
    std::set<std::vector<std::string>> seen;
    for (const GenericTest* test : order) {
      if (!seen.insert(test->variables).second || diagnosis_.unknown.size() == kMostUnknown) continue;
      diagnosis_.unknown.push_back({test->variables,
                                    {},
                                    test->direction,
                                    test->rotation,
                                    test->rms,
                                    search_.family_wise_log10_p(*test),
                                    test->period});
    }
    if (diagnosis_.unknown.empty()) {
      collect_given_up();
    } else {
      tell_what_is_certain();
    }
  }

  /// Where another variable beside the same one explains nearly as much as the second of the leading finding,
  /// the first alone is certain.
  void tell_what_is_certain() {
    UnknownFinding& leading = diagnosis_.unknown.front();
    if (leading.variables.size() < 2) return;
    const double nearly =
        leading.log10_p +
        std::max(kThresholds.same_second_variable, -kThresholds.same_second_variable_share * leading.log10_p);
    std::vector<std::string> common = leading.variables, others = leading.variables;
    for (const UnknownFinding& other : diagnosis_.unknown) {
      if (other.variables.size() < 2 || other.log10_p > nearly) continue;
      const auto is_in_other = [&other](const std::string& name) {
        return std::ranges::find(other.variables, name) != other.variables.end();
      };
      std::erase_if(common, std::not_fn(is_in_other));
      for (const std::string& name : other.variables) {
        if (std::ranges::find(others, name) == others.end()) others.push_back(name);
      }
    }
    if (common.size() != 1) return;
    std::erase(others, common.front());
    leading.variables = common;
    leading.with_one_of = others;
  }

  /// Of those that stand out nearly as much as the most improbable one, the first of the simplest.
  static void put_simplest_first(std::vector<const GenericTest*>& order) {
    if (order.empty()) return;
    const double nearly = (1.0 - kThresholds.nearly_as_improbable) * order.front()->log10_p;
    const auto end =
        std::ranges::find_if(order, [nearly](const GenericTest* test) { return test->log10_p > nearly; });
    const auto simplest = std::ranges::min_element(order.begin(), end, {}, [](const GenericTest* test) {
      return complexity_rank(test->variables, test->direction);
    });
    std::rotate(order.begin(), simplest, simplest + 1);
  }

  /// What stood out under names that are none, and no generic test sees for itself.
  void collect_given_up() {
    for (const auto& [family, reason] : search_.given_up()) {
      const FamilyTest& test = search_.tests()[family];
      if (search_.is_added(family) || search_.family_wise_log10_p(test) > log10_family_risk()) continue;
      const Eigen::VectorXd moved =
          family_columns(model_, families_[family], test.shape) * test.score.amplitude;
      diagnosis_.unknown.push_back({scan_variables_of(families_[family].name()),
                                    {},
                                    direction_of_change(moved),
                                    {},
                                    moved.norm() / std::sqrt(static_cast<double>(moved.size())),
                                    search_.family_wise_log10_p(test)});
    }
    std::ranges::sort(diagnosis_.unknown, {}, &UnknownFinding::log10_p);
  }

  /// What the readings can tell apart, and what would have to be measured for the rest.
  void compare_hypotheses() {
    if (!options_.compare) return;
    progress("confounding", 0.95);
    const NoiseData data = without(model_.problem().data, heldout_);
    const CriticismState state{model_,
                               result_,
                               data,
                               search_.projector(),
                               search_.noise(),
                               families_,
                               search_.tests(),
                               search_.log10_level(),
                               kThresholds.power,
                               thread_count(options_.threads)};
    add_confounding(state, diagnosis_);
    add_next_measurements(state, options_.planning, diagnosis_);
  }

  bool mostly_invisible() const {
    const auto effects = static_cast<std::size_t>(
        std::ranges::count_if(families_, [](const Family& family) { return !family.resolution; }));
    return 2 * diagnosis_.not_visible.size() > effects;
  }

  void conclude() {
    if (!diagnosis_.effects.empty()) {
      conclude_named();
    } else if (!diagnosis_.unknown.empty()) {
      conclude_unknown();
    } else if (!sets_of_alternatives(diagnosis_).empty()) {
      conclude_one_of();
    } else {
      conclude_nothing();
    }
    add_remarks();
  }

  void conclude_named() {
    const auto sets = sets_of_alternatives(diagnosis_);
    const bool more = !diagnosis_.unknown.empty();
    const bool not_reduced = heldout_error_not_reduced(diagnosis_.ladder);
    const bool open = more || !sets.empty() || search_.more_is_known() || not_reduced;
    auto& words = diagnosis_.words;
    diagnosis_.verdict = open ? Verdict::NamedMoreRemains : Verdict::Named;
    for (const EffectFinding& effect : diagnosis_.effects)
      words.push_back("The missing effect is: " + sentence(effect));
    for (const auto* set : sets) words.push_back("More remains, one of: " + names(*set));
    if (search_.more_is_known()) words.emplace_back(kKnownMore);
    if (more) words.push_back("More remains: " + sentence(diagnosis_.unknown.front()));
    if (not_reduced) words.emplace_back(kNotReducedWords);
  }

  void conclude_unknown() {
    auto& words = diagnosis_.words;
    diagnosis_.verdict = Verdict::Unknown;
    words.push_back("An effect that is in no catalogue: " + sentence(diagnosis_.unknown.front()));
    for (const auto* set : sets_of_alternatives(diagnosis_)) {
      words.push_back("Nearest in the catalogue, but not all of it: " + names(*set));
    }
  }

  void conclude_one_of() {
    auto& words = diagnosis_.words;
    diagnosis_.verdict = Verdict::OneOf;
    for (const auto* set : sets_of_alternatives(diagnosis_)) {
      words.push_back("One of these is missing, and these readings do not tell them apart: " + names(*set));
    }
    if (search_.more_is_known()) words.emplace_back(kKnownMore);
  }

  void conclude_nothing() {
    if (mostly_invisible()) {
      diagnosis_.verdict = Verdict::NotVisible;
      diagnosis_.words.push_back(fmt::format(
          "Nothing is above the noise, but {} of {} effects would not be visible with this measurement.",
          diagnosis_.not_visible.size(), diagnosis_.families));
    } else {
      diagnosis_.verdict = Verdict::NothingAbove;
      diagnosis_.words.emplace_back(
          "Nothing is above the noise; what would have been found is in the table of smallest detectable "
          "amplitudes.");
    }
  }

  void add_remarks() {
    auto& words = diagnosis_.words;
    for (const auto& [family, reason] : search_.given_up()) {
      words.push_back("Not named " + families_[family].label() + ": " + reason + ".");
    }
    if (const std::size_t back = removed_by_fit_ - diagnosis_.removed_readings.size(); back > 0) {
      words.push_back(
          fmt::format("{} of {} readings that the outlier test had removed agree with the model "
                      "reached and are used again.",
                      back, removed_by_fit_));
    }
    for (const EffectFinding& change : diagnosis_.model_changes) {
      words.push_back("The error function " + change.name.target + " needs more knots.");
    }
  }

  static std::string names(const std::vector<EffectFinding>& findings) {
    std::string text;
    for (const EffectFinding& each : findings) text += (text.empty() ? "" : "; ") + each.label;
    return text;
  }

  static std::string sentence(const EffectFinding& effect) {
    std::string text = effect.label + " (" + effect.name.kind + ")";
    if (effect.amplitudes.size() > kMostAmplitudesInWords) return text;
    for (const AmplitudeFigure& amplitude : effect.amplitudes) {
      text +=
          fmt::format(", {} = {:.3g} +- {:.2g} {}", amplitude.label, amplitude.value / amplitude.si_per_unit,
                      kCoverageFactor * amplitude.u / amplitude.si_per_unit, amplitude.unit);
    }
    return text + (effect.shape_text.empty() ? "" : ", " + effect.shape_text);
  }

  static std::string sentence(const UnknownFinding& unknown) {
    const std::string variables =
        unknown.variables.empty() ? "nothing recorded that was tried" : unknown.dependence();
    return fmt::format("it depends on {}, acts along {}, and is {:.2g} um RMS on the readings", variables,
                       unknown.action(), unknown.rms * 1e6);
  }

  const DiagnoseOptions& options_;
  const FitResult& result_;
  LinearModel model_;
  std::vector<bool> heldout_;
  EffectSearch search_;
  const std::vector<Family>& families_;
  std::size_t removed_by_fit_ = 0;
  Diagnosis diagnosis_;
};

}  // namespace

Diagnosis diagnose(const Campaign& campaign, const FitResult& result, const DiagnoseOptions& options) {
  return Diagnostician(campaign, result, options).run();
}

}  // namespace volcal
