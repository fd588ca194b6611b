#include "volcal/identify/criticism/diagnosis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>

#include "volcal/identify/criticism/ladder.h"
#include "volcal/identify/stats/chi_squared.h"
#include "volcal/model/description/units.h"

namespace volcal {

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::Named:
      return "NAMED";
    case Verdict::NamedMoreRemains:
      return "NAMED_MORE_REMAINS";
    case Verdict::OneOf:
      return "ONE_OF";
    case Verdict::Unknown:
      return "UNKNOWN";
    case Verdict::NothingAbove:
      return "NOTHING_ABOVE";
    case Verdict::NotVisible:
      return "NOT_VISIBLE";
  }
  return "";
}

Verdict verdict_from(const std::string& text) {
  for (const Verdict verdict : {Verdict::Named, Verdict::NamedMoreRemains, Verdict::OneOf, Verdict::Unknown,
                                Verdict::NothingAbove, Verdict::NotVisible}) {
    if (to_string(verdict) == text) return verdict;
  }
  throw std::invalid_argument("\"" + text + "\" is no verdict");
}

namespace {

const double kLog10FamilyRisk = std::log10(0.005);
const double kLog10GenericRisk = std::log10(0.002);  // kernels and polynomials each
constexpr double kToldApart = 6.0;                   // of the extended BIC
constexpr double kVisible = 0.02;
constexpr double kPower = 0.8;
constexpr std::size_t kListed = 40;
constexpr std::size_t kMostAlternatives = 6;

class Diagnostician {
 public:
  Diagnostician(const Campaign& campaign, const FitResult& result, const DiagnoseOptions& options)
      : options_(options),
        threads_(options.threads > 0 ? options.threads
                                     : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))),
        model_(campaign, result),
        heldout_(heldout_lines(model_, options.heldout_share)) {
    diagnosis_.removed_readings = static_cast<std::size_t>(
        std::ranges::count_if(result.residuals, [](const ResidualRecord& record) { return record.removed; }));
  }

  Diagnosis run() {
    progress("noise model", 0.05);
    find_noise();
    families_ = families(model_);
    std::erase_if(families_, [this](const Family& family) {
      return std::ranges::find(options_.leave_out, family.name().kind) != options_.leave_out.end();
    });
    variables_ = scan_variables(model_);
    diagnosis_.families = families_.size();
    add_step("");
    for (int step = 0; step <= options_.most_effects; ++step) {
      progress(fmt::format("tests, step {}", step + 1), 0.2 + 0.7 * step / (options_.most_effects + 1.0));
      test();
      if (step == 0) list_detectable();
      if (step == options_.most_effects || !accept_leading()) break;
      if (!options_.climb && !diagnosis_.effects.empty()) {
        test();
        break;
      }
    }
    restate_ladder();
    list_noise();
    rank();
    drop_unneeded();
    conclude();
    if (options_.figures) {
      diagnosis_.figures =
          diagnosis_figures({model_, heldout_, noise_, *projector_, families_, tests_, accepted_order_,
                             accepted_columns_, variables_, generic_given_, generic_, threads_});
    }
    progress("done", 1.0);
    return std::move(diagnosis_);
  }

 private:
  void progress(const std::string& stage, double done) const {
    if (options_.progress) options_.progress(stage, done);
  }

  /// Noise of all readings; the projector that chooses sees those that are not held out.
  void find_noise() {
    NoiseOptions noise;
    noise.threads = threads_;
    noise.uncertainty = false;
    noise_estimate_ = estimate_noise(with_accepted(), noise, accepted_.empty() ? nullptr : &noise_estimate_);
    noise_ = noise_estimate_.parameters();
    projector_ = std::make_unique<Projector>(model_.problem(), without(model_.problem().data, heldout_),
                                             noise_, threads_, model_.parts());
    for (const Eigen::MatrixXd& columns : accepted_columns_) projector_->accept(columns);
  }

  void list_noise() {
    NoiseOptions noise;
    noise.threads = threads_;
    noise_estimate_ = estimate_noise(with_accepted(), noise, &noise_estimate_);
    diagnosis_.noise = noise_table(noise_estimate_);
    diagnosis_.noise_instruments = model_.instruments();
  }

  /// The linear model with the accepted effects as further columns.
  NoiseProblem with_accepted() const {
    NoiseProblem problem = model_.problem();
    for (const Eigen::MatrixXd& columns : accepted_columns_) {
      const Eigen::Index before = problem.jacobian.cols();
      problem.jacobian.conservativeResize(Eigen::NoChange, before + columns.cols());
      problem.jacobian.rightCols(columns.cols()) = columns;
      problem.prior_precision.conservativeResizeLike(
          Eigen::MatrixXd::Zero(before + columns.cols(), before + columns.cols()));
      problem.prior_mean.conservativeResizeLike(Eigen::VectorXd::Zero(before + columns.cols()));
    }
    return problem;
  }

  void test() {
    tests_ = test_families(model_, families_, *projector_, threads_);
    generic_ = generic_scan(model_, variables_, *projector_, threads_);
    diagnosis_.generic_tests = generic_.size();
    log10_families_ = std::log10(static_cast<double>(std::max<std::size_t>(families_.size(), 1)));
    log10_generic_ = std::log10(static_cast<double>(std::max<std::size_t>(generic_.size(), 1)));
  }

  double family_wise(const FamilyTest& test) const { return std::min(0.0, test.log10_p + log10_families_); }
  double family_wise(const GenericTest& test) const { return std::min(0.0, test.log10_p + log10_generic_); }

  const FamilyTest* leading() const {
    const FamilyTest* best = nullptr;
    for (const FamilyTest& test : tests_) {
      if (accepted_.contains(test.family) || test.score.dof == 0) continue;
      if (best == nullptr || test.gain > best->gain) best = &test;
    }
    return best;
  }

  const GenericTest* leading_generic() const {
    const GenericTest* best = nullptr;
    for (const GenericTest& test : generic_) {
      if (best == nullptr || test.log10_p < best->log10_p) best = &test;
    }
    return best;
  }

  /// The largest gain of the generic polynomials: what an unlisted effect of few terms would reach.
  double generic_gain() const {
    double gain = 0.0;
    for (const GenericTest& test : generic_) {
      if (!test.kernel) gain = std::max(gain, test.gain);
    }
    return gain;
  }

  /// Families that the readings do not tell from the leading one.
  std::vector<const FamilyTest*> rivals(const FamilyTest& best) const {
    std::vector<const FamilyTest*> near;
    for (const FamilyTest& test : tests_) {
      if (&test == &best || accepted_.contains(test.family) || test.score.dof == 0) continue;
      if (best.gain - test.gain < kToldApart) near.push_back(&test);
    }
    std::ranges::sort(near, std::greater{}, &FamilyTest::gain);
    return near;
  }

  /// Adds the leading family when it is above the noise and alone; false when the climb ends here.
  bool accept_leading() {
    const FamilyTest* best = leading();
    if (best == nullptr || family_wise(*best) > kLog10FamilyRisk) return false;
    if (generic_gain() > best->gain + kToldApart) return false;
    const auto near = rivals(*best);
    if (!near.empty()) {
      diagnosis_.one_of.push_back(finding(*best));
      for (const FamilyTest* test : near) {
        if (diagnosis_.one_of.size() < kMostAlternatives) diagnosis_.one_of.push_back(finding(*test));
      }
      return false;
    }
    accept(*best);
    return true;
  }

  void accept(const FamilyTest& test) {
    accepted_.insert(test.family);
    accepted_columns_.push_back(family_columns(model_, families_[test.family], test.shape));
    (families_[test.family].resolution ? diagnosis_.model_changes : diagnosis_.effects)
        .push_back(finding(test));
    accepted_order_.push_back(test.family);
    find_noise();
    add_step(families_[test.family].label());
  }

  EffectFinding finding(const FamilyTest& test) const {
    const Family& family = families_[test.family];
    EffectFinding out;
    out.name = family.name();
    out.label = family.label();
    out.spec = family.spec;
    out.log10_p = family_wise(test);
    out.lm = test.score.lm;
    out.dof = test.score.dof;
    out.gain = test.gain;
    out.visible_fraction = test.score.visible_fraction;
    out.resolution = family.resolution.has_value();
    if (!family.effect) return out;
    const double found_from = std::sqrt(
        detectable_noncentrality(kLog10FamilyRisk - log10_families_, std::max(1, test.score.dof), kPower));
    const auto& amplitudes = family.effect->amplitudes();
    for (std::size_t k = 0; k < amplitudes.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const double u = std::sqrt(std::max(0.0, test.score.covariance(at, at)));
      const double mdb = u > 0.0 ? u * found_from : std::nan("");
      out.amplitudes.push_back({amplitudes[k].label, test.score.amplitude[at], u, mdb, amplitudes[k].unit(),
                                amplitudes[k].si_per_unit()});
      out.spec.options.set(std::string(stem_of_key(amplitudes[k].key)), test.score.amplitude[at]);
    }
    const auto& shapes = family.effect->shapes();
    for (std::size_t k = 0; k < shapes.size(); ++k) {
      const double value = test.shape[static_cast<Eigen::Index>(k)];
      const std::string stem(stem_of_key(shapes[k].key));
      out.spec.options.set(stem, value);
      out.shape_text += fmt::format("{}{} {:.4g} {}", k > 0 ? ", " : "", stem,
                                    value / shapes[k].si_per_unit(), shapes[k].unit());
    }
    return out;
  }

  void add_step(const std::string& added) {
    LadderStep step = ladder_step(model_, heldout_, noise_, *projector_, accepted_columns_, heldout_loglik_);
    step.model = std::to_string(diagnosis_.ladder.size());
    step.added = added;
    diagnosis_.ladder.push_back(step);
  }

  /// All steps against the noise of the model reached: noise estimated beside a missing effect holds part of
  /// the effect, and would hide its fall.
  void restate_ladder() {
    if (accepted_columns_.empty()) return;
    Projector projector(model_.problem(), without(model_.problem().data, heldout_), noise_, threads_,
                        model_.parts());
    heldout_loglik_.reset();
    std::vector<Eigen::MatrixXd> accepted;
    for (LadderStep& step : diagnosis_.ladder) {
      if (&step != &diagnosis_.ladder.front()) {
        accepted.push_back(accepted_columns_[accepted.size()]);
        projector.accept(accepted.back());
      }
      LadderStep restated = ladder_step(model_, heldout_, noise_, projector, accepted, heldout_loglik_);
      restated.model = step.model;
      restated.added = step.added;
      step = restated;
    }
  }

  /// At the given model: what would have been found, and what could not be.
  void list_detectable() {
    generic_given_ = generic_;
    const FunctionalPointLevers levers(model_);
    for (const FamilyTest& test : tests_) {
      if (families_[test.family].resolution) continue;
      const EffectFinding found = finding(test);
      const bool visible = test.score.dof > 0 && test.score.visible_fraction >= kVisible;
      if (!visible) diagnosis_.not_visible.push_back(found);
      diagnosis_.detectable.push_back(
          detectable(found, *families_[test.family].effect, test.shape, visible, levers));
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

  void rank() {
    std::vector<const FamilyTest*> order;
    for (const FamilyTest& test : tests_) {
      if (test.score.dof > 0 && !accepted_.contains(test.family)) order.push_back(&test);
    }
    std::ranges::sort(order, std::greater{}, &FamilyTest::gain);
    for (std::size_t i = 0; i < std::min(kListed, order.size()); ++i) {
      diagnosis_.ranking.push_back(finding(*order[i]));
    }
    collect_unknown();
  }

  /// Significant generic tests, leading first, one per set of variables.
  void collect_unknown() {
    std::vector<const GenericTest*> order;
    for (const GenericTest& test : generic_) {
      if (family_wise(test) < kLog10GenericRisk) order.push_back(&test);
    }
    std::ranges::sort(order, {}, &GenericTest::log10_p);
    std::set<std::vector<std::string>> seen;
    for (const GenericTest* test : order) {
      if (!seen.insert(test->variables).second || diagnosis_.unknown.size() == 10) continue;
      diagnosis_.unknown.push_back({test->variables, test->direction, test->rms, family_wise(*test)});
    }
  }

  /// Estimates of everything accepted together, from all readings that are not held out; what is no longer
  /// significant beside the others leaves.
  void drop_unneeded() {
    if (accepted_order_.empty()) return;
    const Eigen::VectorXd solution = projector_->solution();
    const Eigen::MatrixXd covariance = projector_->accepted_covariance();
    Eigen::Index at = 0;
    std::vector<EffectFinding> kept;
    const Eigen::Index first = solution.size() - covariance.rows();
    for (std::size_t i = 0; i < accepted_order_.size(); ++i) {
      const Eigen::Index count = accepted_columns_[i].cols();
      const Family& family = families_[accepted_order_[i]];
      if (!family.resolution)
        update(family, solution.segment(first + at, count), covariance.block(at, at, count, count), kept);
      at += count;
    }
    diagnosis_.effects = std::move(kept);
  }

  void update(const Family& family, const Eigen::VectorXd& amplitude, const Eigen::MatrixXd& covariance,
              std::vector<EffectFinding>& kept) const {
    const auto found = std::ranges::find_if(
        diagnosis_.effects, [&](const EffectFinding& each) { return each.name == family.name(); });
    EffectFinding finding = *found;
    const double lm = amplitude.dot(covariance.ldlt().solve(amplitude));
    const double log10_p = log10_chi_squared_exceedance(lm, static_cast<double>(amplitude.size()));
    if (log10_p + log10_families_ > kLog10FamilyRisk) return;
    for (std::size_t k = 0; k < finding.amplitudes.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      finding.amplitudes[k].value = amplitude[at];
      finding.amplitudes[k].u = std::sqrt(covariance(at, at));
      finding.spec.options.set(std::string(stem_of_key(family.effect->amplitudes()[k].key)), amplitude[at]);
    }
    kept.push_back(std::move(finding));
  }

  bool mostly_invisible() const {
    const auto effects = static_cast<std::size_t>(
        std::ranges::count_if(families_, [](const Family& family) { return !family.resolution; }));
    return 2 * diagnosis_.not_visible.size() > effects;
  }

  void conclude() {
    const bool more = !diagnosis_.unknown.empty();
    auto& words = diagnosis_.words;
    if (!diagnosis_.effects.empty()) {
      const bool open = more || !diagnosis_.one_of.empty();
      diagnosis_.verdict = open ? Verdict::NamedMoreRemains : Verdict::Named;
      for (const EffectFinding& effect : diagnosis_.effects)
        words.push_back("The missing effect is: " + sentence(effect));
      if (!diagnosis_.one_of.empty()) words.push_back("More remains, one of: " + names(diagnosis_.one_of));
      if (more) words.push_back("More remains: " + sentence(diagnosis_.unknown.front()));
    } else if (!diagnosis_.one_of.empty()) {
      diagnosis_.verdict = Verdict::OneOf;
      words.push_back("One of these is missing, and these readings do not tell them apart: " +
                      names(diagnosis_.one_of));
    } else if (more) {
      diagnosis_.verdict = Verdict::Unknown;
      words.push_back("An effect that is in no catalogue: " + sentence(diagnosis_.unknown.front()));
    } else if (mostly_invisible()) {
      diagnosis_.verdict = Verdict::NotVisible;
      words.push_back(fmt::format(
          "Nothing is above the noise, but {} of {} effects would not be visible with this measurement.",
          diagnosis_.not_visible.size(), diagnosis_.families));
    } else {
      diagnosis_.verdict = Verdict::NothingAbove;
      words.emplace_back(
          "Nothing is above the noise; what would have been found is in the table of smallest detectable "
          "amplitudes.");
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
    for (const AmplitudeFigure& amplitude : effect.amplitudes) {
      text +=
          fmt::format(", {} = {:.3g} +- {:.2g} {}", amplitude.label, amplitude.value / amplitude.si_per_unit,
                      1.96 * amplitude.u / amplitude.si_per_unit, amplitude.unit);
    }
    return text + (effect.shape_text.empty() ? "" : ", " + effect.shape_text);
  }

  static std::string sentence(const UnknownFinding& unknown) {
    std::string variables;
    for (const std::string& name : unknown.variables) variables += (variables.empty() ? "" : " and ") + name;
    return fmt::format("it depends on {}, acts along {}, and is {:.2g} um RMS on the readings", variables,
                       unknown.direction, unknown.rms * 1e6);
  }

  const DiagnoseOptions& options_;
  int threads_;
  LinearModel model_;
  std::vector<bool> heldout_;
  Diagnosis diagnosis_;
  std::vector<Family> families_;
  std::vector<ScanVariable> variables_;
  NoiseEstimate noise_estimate_;
  std::vector<NoiseParameters> noise_;
  std::unique_ptr<Projector> projector_;
  std::vector<FamilyTest> tests_;
  std::vector<GenericTest> generic_given_, generic_;
  std::set<std::size_t> accepted_;
  std::vector<std::size_t> accepted_order_;
  std::vector<Eigen::MatrixXd> accepted_columns_;
  std::optional<double> heldout_loglik_;
  double log10_families_ = 0.0;
  double log10_generic_ = 0.0;
};

}  // namespace

double log10_family_risk() { return kLog10FamilyRisk; }
double log10_generic_risk() { return kLog10GenericRisk; }

Diagnosis diagnose(const Campaign& campaign, const FitResult& result, const DiagnoseOptions& options) {
  return Diagnostician(campaign, result, options).run();
}

}  // namespace volcal
