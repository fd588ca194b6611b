// A session against the diagnosis and the fit that it stands on, and its history.

#include "volcal/identify/session/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/session/proposed_measurements.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using testing_support::hiding;
using testing_support::reversal;

const EffectName kReversal = EffectName::of_parts("reversal", "EYY", "dir_y", "step");
const EffectName kOther = EffectName::of_parts("reversal", "EXX", "dir_x", "step");

/// Two reversals hidden, of which the first moves the readings most.
class SessionOfTwo : public ::testing::Test {
 protected:
  static sim::Study study() { return hiding({reversal("EYY", 1.0e-6), reversal("EXX", 0.6e-6)}, {5, 4, 4}); }
  static const Campaign& campaign() {
    static const Campaign made = sim::simulate(study()).campaign;
    return made;
  }
  static SessionOptions options_of(const SessionProgress& progress) {
    SessionOptions options;
    options.threads = 1;
    options.progress = progress;
    return options;
  }
  static std::unique_ptr<Session> open() {
    return std::make_unique<Session>(campaign(), testing_support::polynomials(), options_of({}));
  }
  /// Opened once; tests leave it at its first model.
  static Session& session() {
    static const std::unique_ptr<Session> opened = open();
    return *opened;
  }
  void TearDown() override { session().go_to(0); }

  /// Of a ladder's step, but for its name.
  static void expect_same_figures(const LadderStep& found, const LadderStep& expected) {
    constexpr double kAlike = 1e-12;
    EXPECT_NEAR(found.rms_fit, expected.rms_fit, kAlike * expected.rms_fit);
    EXPECT_NEAR(found.rms_heldout, expected.rms_heldout, kAlike * expected.rms_heldout);
    EXPECT_NEAR(found.noise_floor, expected.noise_floor, kAlike * expected.noise_floor);
    EXPECT_NEAR(found.reduced_chi2, expected.reduced_chi2, kAlike * expected.reduced_chi2);
    // A difference of squares, of which the larger counts.
    const double squares = kAlike * expected.rms_heldout * expected.rms_heldout;
    EXPECT_NEAR(std::pow(found.systematic, 2), std::pow(expected.systematic, 2), squares);
    EXPECT_NEAR(std::pow(found.systematic_high, 2), std::pow(expected.systematic_high, 2), squares);
  }

  static double rms(const Eigen::VectorXd& residual) {
    return std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
  }
};

/// As the search of a diagnosis does before its first step.
TEST_F(SessionOfTwo, RanksAsADiagnosisToTheBit) {
  FitOptions fit_options;
  fit_options.threads = 1;
  fit_options.outliers = OutlierPolicy::Remove;
  fit_options.noise = NoisePolicy::White;
  const FitResult result = fit(campaign(), testing_support::polynomials(), fit_options);
  const LinearModel model(campaign(), result);
  const ModelState given = ModelState(model, std::make_shared<SearchSetting>(
                                                 model, heldout_lines(model, SessionOptions{}.heldout_share),
                                                 std::vector<std::string>{}, 1))
                               .tested();
  std::map<EffectName, EffectFinding> found;
  for (const FamilyTest& test : given.tests().families) {
    EffectFinding each = finding(given.setting(), test);
    if (test.score.dof > 0) found[each.name] = std::move(each);
  }
  const std::vector<EffectFinding> ranking = session().rank();
  EXPECT_EQ(ranking.size(), found.size());
  ASSERT_GE(ranking.size(), 100U);
  EXPECT_EQ(ranking.front().name, kReversal);
  for (std::size_t i = 0; i < ranking.size(); ++i) {
    const EffectFinding& own = ranking[i];
    const EffectFinding& other = found.at(own.name);
    EXPECT_LE(own.gain, ranking[i > 0 ? i - 1 : 0].gain);
    EXPECT_EQ(own.gain, other.gain) << own.label;
    EXPECT_EQ(own.log10_p, other.log10_p) << own.label;
    ASSERT_EQ(own.amplitudes.size(), other.amplitudes.size());
    for (std::size_t k = 0; k < own.amplitudes.size(); ++k) {
      EXPECT_EQ(own.amplitudes[k].value, other.amplitudes[k].value) << own.label;
      EXPECT_EQ(own.amplitudes[k].u, other.amplitudes[k].u) << own.label;
    }
  }
  EXPECT_EQ(session().current().figures.rms_heldout, ladder_of(given).back().rms_heldout);
  EXPECT_EQ(session().current().figures.systematic, ladder_of(given).back().systematic);
}

/// `volcal diagnose` does not stand on a session, which it needs no tree of; the numbers are the same ones.
TEST_F(SessionOfTwo, IsADoorToTheNumbersOfDiagnose) {
  DiagnoseOptions options;
  options.threads = 1;
  options.climb = true;
  options.figures = options.compare = false;
  const Diagnosis diagnosis = diagnose_model(campaign(), testing_support::polynomials(), options).diagnosis;
  const LadderStep& as_given = diagnosis.ladder.front();
  ASSERT_GE(diagnosis.ladder.size(), 3U);
  EXPECT_EQ(as_given.model, "0");
  const auto own = open();
  own->take(own->climb());
  const std::vector<EffectFinding> accepted = accepted_effects(diagnosis);
  const std::vector<EffectFinding>& climbed = own->current().effects;
  ASSERT_EQ(climbed.size(), accepted.size());
  ASSERT_EQ(own->models().size(), accepted.size() + 1);
  for (std::size_t i = 0; i < climbed.size(); ++i) {
    EXPECT_EQ(climbed[i].name, accepted[i].name);
    EXPECT_EQ(own->models()[i + 1].change, "+ " + accepted[i].label);
  }
  // What `volcal extend --accepted` writes is fitted to what the session has confirmed.
  ModelSpec extended = testing_support::polynomials();
  for (const EffectFinding& found : accepted)
    extend_model({extended, campaign().machine, &campaign()}, found.spec,
                 {.label = found.label, .place = {}, .remedy_if_known = "", .remedy_if_absent = ""});
  ASSERT_EQ(own->model().effects.size(), extended.effects.size());
  FitOptions fit_options;
  fit_options.threads = 1;
  fit_options.outliers = OutlierPolicy::Remove;
  fit_options.noise = NoisePolicy::White;
  const FitResult fitted = fit(campaign(), extended, fit_options);
  EXPECT_EQ(fitted.parameters, own->fitted_result().parameters) << "to the bit";
}

/// No second fit, and to the bit what a diagnosis of the campaign says.
TEST_F(SessionOfTwo, DiagnosesByTheFitThatItHas) {
  DiagnoseOptions options;
  options.figures = options.compare = false;
  std::set<std::string> stages;
  const auto note = [&](const std::string& stage, double /*done*/) {
    stages.insert(stage);
    return true;
  };
  const DiagnosedModel own = session().diagnosis(options)(note);
  EXPECT_FALSE(std::ranges::any_of(stages, [](const auto& stage) { return stage.starts_with("fit"); }));
  const DiagnosedModel anew = diagnose_model(campaign(), testing_support::polynomials(), options);
  EXPECT_EQ(diagnosis_json(own.diagnosis), diagnosis_json(anew.diagnosis));
}

/// The ranking of a preview follows from products that were kept; here the effect is taken into the model and
/// everything tested anew.
TEST_F(SessionOfTwo, RanksAPreviewAsTestsMadeAnew) {
  session().rank();
  session().add(kReversal);
  FitOptions fit_options;
  fit_options.threads = 1;
  fit_options.outliers = OutlierPolicy::Remove;
  fit_options.noise = NoisePolicy::White;
  const FitResult result = fit(campaign(), testing_support::polynomials(), fit_options);
  const LinearModel model(campaign(), result);
  const ModelState given(
      model, std::make_shared<SearchSetting>(model, heldout_lines(model, SessionOptions{}.heldout_share),
                                             std::vector<std::string>{}, 1));
  const auto is_it = [&](const FamilyTest& test) {
    return given.setting().families[test.family].name() == kReversal;
  };
  const std::vector<FamilyTest> before = refined_tests(given.setting(), model, given.projector());
  const ModelState next = given.with_at_this_noise(*std::ranges::find_if(before, is_it));
  expect_same_figures(session().current().figures, last_step_of(next));
  // As those of a refit, of which residuals and noise are others.
  std::vector<NoiseParameters> noise = given.noise();
  for (NoiseParameters& each : noise) each.white *= 1.2;
  const KeptFigures kept(given, noise, *given.projector_at(noise));
  const ModelState moved = given.with_residual(1.1 * model.problem().residual)
                               .with_at_this_noise(*std::ranges::find_if(before, is_it));
  expect_same_figures(kept.last_step(moved, *moved.projector_at(noise)), last_step_at(moved, noise));
  EXPECT_GT(last_step_at(moved, noise).rms_fit, 1.01 * last_step_of(next).rms_fit);
  EXPECT_THROW(static_cast<void>(moved.with_residual(model.problem().residual)), std::logic_error);
  std::map<EffectName, EffectFinding> found;
  for (const FamilyTest& test : refined_tests(next.setting(), next.model(), next.projector())) {
    EffectFinding each = finding(next.setting(), test);
    if (test.score.dof > 0) found[each.name] = std::move(each);
  }
  const std::vector<EffectFinding> ranking = session().rank();
  ASSERT_EQ(ranking.size(), found.size());
  EXPECT_EQ(ranking.front().name, kOther);
  for (const EffectFinding& own : ranking) {
    const EffectFinding& other = found.at(own.name);
    const double alike = 1e-9 / (other.visible_fraction * other.visible_fraction);
    EXPECT_NEAR(own.gain, other.gain, alike * (1.0 + other.lm)) << own.label;
    EXPECT_NEAR(own.lm, other.lm, alike * (1.0 + other.lm)) << own.label;
    for (std::size_t k = 0; k < own.amplitudes.size(); ++k)
      EXPECT_NEAR(own.amplitudes[k].value, other.amplitudes[k].value, alike * other.amplitudes[k].u)
          << own.label;
  }
}

/// Full fits beyond a few are let go of, and are the same to the bit when they are looked at again.
TEST_F(SessionOfTwo, KeepsFewFullFitsAndMakesTheOthersAgain) {
  const auto own = open();
  own->add(kReversal);
  own->take(own->confirmation());
  const Eigen::VectorXd residual = own->residual();
  const std::vector<EffectFinding> ranking = own->rank();
  const std::vector<EffectFinding> effects = own->current().effects;
  for (const auto& [symbol, driver] : {std::pair{"EXX", "dir_x"}, {"EZZ", "dir_z"}, {"EXY", "dir_y"}}) {
    own->go_to(1);
    own->add(EffectName::of_parts("reversal", symbol, driver, "step"));
    own->take(own->confirmation());
    EXPECT_LE(own->kept_fits(), Session::kKeptFits);
  }
  ASSERT_EQ(own->models().size(), 5U);
  for (const std::size_t other : {0U, 2U, 3U, 4U}) {
    own->go_to(other);
    EXPECT_GT(own->linear().size(), 0U);
    EXPECT_LE(own->kept_fits(), Session::kKeptFits);
  }
  own->go_to(1);
  EXPECT_EQ(own->linear().size(), static_cast<std::size_t>(residual.size()));
  EXPECT_LE(own->kept_fits(), Session::kKeptFits);
  EXPECT_EQ(own->residual(), residual);
  const std::vector<EffectFinding>& again = own->rank();
  ASSERT_EQ(again.size(), ranking.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_EQ(again[i].name, ranking[i].name);
    EXPECT_EQ(again[i].gain, ranking[i].gain);
  }
  EXPECT_EQ(own->current().effects[0].amplitudes[0].value, effects[0].amplitudes[0].value);
  own->add(kOther);
  const SessionModel& second = own->models()[2];
  EXPECT_EQ(own->models().back().effects.size(), second.effects.size());
  EXPECT_NEAR(own->models().back().effects[1].amplitudes[0].value, second.effects[1].amplitudes[0].value,
              0.25 * kCoverageFactor * second.effects[1].amplitudes[0].u);
}

/// As `volcal diagnose --separate` proposes for the same two.
TEST_F(SessionOfTwo, ProposesWhatTellsTheLeadingEffectFromItsRivals) {
  const std::vector<MeasurementProposal>& next = session().next_measurements();
  const Rivalry rivalry = session().rivals(12);
  std::set<EffectName> rivals;
  for (Eigen::Index k = 1; k < rivalry.cosine.cols(); ++k) {
    if (rivalry.cosine(0, k) > kRivalCosine) rivals.insert(rivalry.names[static_cast<std::size_t>(k)]);
  }
  ASSERT_FALSE(rivals.empty()) << "a reversal has relatives";
  ASSERT_FALSE(next.empty());
  for (const MeasurementProposal& each : next) {
    ASSERT_EQ(each.separates.size(), 2U);
    EXPECT_EQ(each.separates[0], kReversal);
    EXPECT_TRUE(rivals.contains(each.separates[1])) << full_name(each.separates[1]);
    EXPECT_GE(each.reached, each.separation);
  }
}

TEST_F(SessionOfTwo, APreviewIsWhatAddingGives) {
  const EffectPreview preview = session().preview(kReversal);
  const double before = rms(session().residual());
  const SessionModel& added = session().add(kReversal);
  EXPECT_EQ(added.change, "+ reversal EYY");
  EXPECT_EQ(added.standing, ModelStanding::Preview);
  EXPECT_EQ(added.parent, 0U);
  ASSERT_EQ(added.effects.size(), 1U);
  const AmplitudeFigure& figure = added.effects[0].amplitudes[0];
  // Tests have no held-out readings, amplitudes all.
  EXPECT_NEAR(figure.value, preview.effect.amplitudes[0].value, preview.effect.amplitudes[0].u);
  EXPECT_LT(figure.u, preview.effect.amplitudes[0].u);
  EXPECT_LT((session().residual() - preview.residual).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT(rms(session().residual()), before);
  EXPECT_LT(added.figures.rms_heldout, session().models()[0].figures.rms_heldout);
  for (const EffectFinding& each : session().rank()) EXPECT_NE(each.name, kReversal);
}

TEST_F(SessionOfTwo, MovesBetweenModelsAndLosesNone) {
  const std::size_t start = session().models().size();
  session().add(kReversal);
  const std::size_t first = session().current().number;
  session().add(kOther);
  const Eigen::VectorXd both = session().residual();
  EXPECT_TRUE(session().undo());
  EXPECT_EQ(session().current().number, first);
  EXPECT_TRUE(session().undo());
  EXPECT_EQ(session().current().number, 0U);
  EXPECT_FALSE(session().undo());
  EXPECT_TRUE(session().redo());
  EXPECT_TRUE(session().redo());
  EXPECT_FALSE(session().redo());
  EXPECT_EQ(session().residual(), both);
  const SessionModel& branch = session().remove_preview(kReversal);
  EXPECT_EQ(branch.change, "- reversal EYY");
  ASSERT_EQ(branch.effects.size(), 1U);
  EXPECT_EQ(branch.effects[0].name, kOther);
  EXPECT_EQ(session().models().size(), start + 3);
  session().go_to(first);
  EXPECT_FALSE(session().redo()) << "another way was taken";
  EXPECT_THROW(session().go_to(1000), std::out_of_range);
  EXPECT_THROW(session().add(kReversal), std::invalid_argument);
  EXPECT_THROW(session().remove_preview(kOther), std::invalid_argument);
}

/// The full fit agrees with the preview, and takes the effect out again. The functions are smoothed ones
/// here.
TEST_F(SessionOfTwo, IsConfirmedByAFullFit) {
  sim::Study with_waves = study();
  with_waves.truth.random.wave_scale = 1.0;
  const Campaign measured = sim::simulate(with_waves).campaign;
  const auto own = std::make_unique<Session>(measured, ModelSpec{}, options_of({}));
  own->add(kReversal);
  own->add(kOther);
  const double previewed = own->current().effects[0].amplitudes[0].value;
  const double residual = rms(own->residual());
  const SessionModel& confirmed = own->take(own->confirmation());
  EXPECT_EQ(confirmed.standing, ModelStanding::Fitted);
  EXPECT_EQ(confirmed.number, 2U);
  ASSERT_EQ(confirmed.effects.size(), 2U);
  const AmplitudeFigure& figure = confirmed.effects[0].amplitudes[0];
  EXPECT_NEAR(figure.value, previewed, 0.25 * kCoverageFactor * figure.u);
  EXPECT_NEAR(rms(own->residual()), residual, 0.1 * residual);
  EXPECT_TRUE(own->unknown().empty()) << "nothing is left to be found";
  EXPECT_FALSE(own->unknown_leads());
  const ModelSpec model = own->model();
  ASSERT_EQ(model.effects.size(), 2U);
  EXPECT_EQ(model.effects[0].options.number("amplitude"), figure.value);
  own->add(EffectName::of_parts("reversal", "EZZ", "dir_z", "step"));
  EXPECT_EQ(own->current().effects.size(), 3U);
  EXPECT_EQ(own->current().effects[0].amplitudes[0].value, figure.value) << "held by the fit";
  EXPECT_FALSE(own->is_preview(kReversal));
  EXPECT_THROW(own->remove_preview(kReversal), std::invalid_argument);
  const SessionModel& without = own->take(own->removal(kReversal));
  EXPECT_EQ(without.standing, ModelStanding::Fitted) << "taken out of a full fit by another one";
  EXPECT_EQ(without.effects.size(), 2U);
}

/// What the noise took of an effect for offsets of lines comes back with the refit; the full fit finds the
/// same.
TEST_F(SessionOfTwo, ARefitComesBetweenPreviewAndFullFit) {
  const auto own = open();
  const double previewed = own->add(kReversal).effects[0].amplitudes[0].value;
  const Eigen::VectorXd sigma = own->sigma(1);
  const SessionModel refit = own->take(own->refit());
  EXPECT_EQ(refit.standing, ModelStanding::Refitted);
  EXPECT_EQ(refit.number, 1U);
  EXPECT_EQ(own->models().size(), 2U);
  const Eigen::VectorXd then = own->sigma(1);
  EXPECT_LT(then.sum(), 0.98 * sigma.sum()) << "the noise holds nothing of the effect any more";
  own->take(own->refit());
  EXPECT_EQ(own->sigma(1), then) << "a refit of a refit changes nothing";
  own->undo();
  own->redo();
  EXPECT_EQ(own->current().standing, ModelStanding::Refitted);

  own->add(kOther);
  EXPECT_EQ(own->current().standing, ModelStanding::Preview);
  own->remove_preview(kOther);
  EXPECT_EQ(own->current().standing, ModelStanding::Preview) << "at the noise of the full fit again";
  EXPECT_EQ(own->current().effects[0].amplitudes[0].value, previewed);

  own->go_to(1);
  const SessionModel& confirmed = own->take(own->confirmation());
  const AmplitudeFigure& full = confirmed.effects[0].amplitudes[0];
  const double miss = std::abs(refit.effects[0].amplitudes[0].value - full.value);
  EXPECT_LT(miss, 0.25 * kCoverageFactor * full.u);
  EXPECT_LE(miss, std::abs(previewed - full.value) + 0.02 * full.u);
  EXPECT_NEAR(refit.effects[0].amplitudes[0].u, full.u, 0.05 * full.u);
  EXPECT_EQ(confirmed.standing, ModelStanding::Fitted);
  EXPECT_NEAR(own->sigma(1).sum(), then.sum(), 0.02 * then.sum());
}

/// To the bit, and no stage of them is left for later.
TEST_F(SessionOfTwo, PreparedRefitsAreThoseThatAreMadeWhenAsked) {
  const auto asked = open(), prepared = open();
  EXPECT_FALSE(prepared->is_prepared());
  prepared->take(prepared->preparation());
  ASSERT_TRUE(prepared->is_prepared());
  EXPECT_EQ(prepared->models().size(), 1U);
  EXPECT_EQ(prepared->current().standing, ModelStanding::Fitted);

  std::set<std::string> stages;
  const auto note = [&](const std::string& stage, double /*done*/) {
    stages.insert(stage);
    return true;
  };
  ASSERT_EQ(prepared->rank().front().name, kReversal);
  for (Session* each : {asked.get(), prepared.get()}) each->add(kReversal);
  EXPECT_EQ(prepared->current().standing, ModelStanding::Preview);
  asked->take(asked->refit(), note);
  const std::string noise = "noise with what was added", smoothed = "the model at this noise";
  EXPECT_TRUE(stages.contains(noise) && stages.contains(smoothed));
  stages.clear();
  prepared->take(prepared->refit(), note);
  EXPECT_FALSE(stages.contains(smoothed));

  const SessionModel &one = asked->current(), &other = prepared->current();
  EXPECT_EQ(other.standing, ModelStanding::Refitted);
  EXPECT_EQ(other.effects[0].amplitudes[0].value, one.effects[0].amplitudes[0].value);
  EXPECT_EQ(other.effects[0].amplitudes[0].u, one.effects[0].amplitudes[0].u);
  EXPECT_EQ(other.figures.systematic, one.figures.systematic);
  EXPECT_EQ(prepared->residual(), asked->residual());
  EXPECT_EQ(prepared->sigma(1), asked->sigma(1));
  ASSERT_EQ(prepared->rank().size(), asked->rank().size());
  for (std::size_t i = 0; i < asked->rank().size(); ++i) {
    EXPECT_EQ(prepared->rank()[i].name, asked->rank()[i].name);
    EXPECT_EQ(prepared->rank()[i].gain, asked->rank()[i].gain);
  }
  EXPECT_FALSE(prepared->is_prepared());
  prepared->undo();
  EXPECT_FALSE(prepared->is_prepared()) << "kept for the current model alone";
}

/// What is stopped is made when it is asked for, also where a step of the refit was made before.
TEST_F(SessionOfTwo, APreparationThatIsStoppedLosesNothing) {
  const auto asked = open(), stopped = open();
  for (const int steps : {0, 1}) {
    int begun = 0;
    const auto stop = [&](const std::string& stage, double /*done*/) {
      const bool is_step = stage == "the exact model";
      return !is_step || begun++ < steps;
    };
    ASSERT_THROW(stopped->take(stopped->preparation(), stop), SessionStopped) << "after " << steps;
    EXPECT_FALSE(stopped->is_prepared());
  }
  stopped->take(stopped->preparation());
  EXPECT_TRUE(stopped->is_prepared());
  for (Session* each : {asked.get(), stopped.get()}) {
    each->add(kReversal);
    each->take(each->refit());
    EXPECT_EQ(each->current().standing, ModelStanding::Refitted);
  }
  EXPECT_EQ(stopped->residual(), asked->residual());
  EXPECT_EQ(stopped->rank().size(), asked->rank().size());
}

/// Asked far more often than there are stages; stopped within one, the session is as it was.
TEST_F(SessionOfTwo, IsStoppedWithinAStage) {
  std::map<std::string, int> asked;
  const auto count = [&](const std::string& stage, double /*done*/) {
    ++asked[stage];
    return true;
  };
  session().take(session().scan(), count);
  const std::string scans = "scans without a catalogue";
  ASSERT_GT(asked[scans], 3) << "some tenths of a second, asked every 20 ms";
  session().add(kReversal);
  int left = 3;
  std::string stopped_in;
  const auto stop = [&](const std::string& stage, double /*done*/) {
    if (stage != scans || --left > 0) return true;
    stopped_in = stage;
    return false;
  };
  EXPECT_THROW(session().take(session().scan(), stop), SessionStopped);
  EXPECT_EQ(stopped_in, scans);
  EXPECT_FALSE(session().is_scanned());
  EXPECT_EQ(session().current().standing, ModelStanding::Preview);
}

/// A page holds a lock of its own while it asks for the ranking, and work behind asks for that lock: neither
/// waits for the other.
TEST_F(SessionOfTwo, WorkBehindAsksNothingWhileOthersWaitForIt) {
  session().add(kReversal);
  const SessionWork scan = session().scan();
  std::mutex of_page;
  std::atomic<bool> begun{false};
  const auto under_lock = [&](const std::string& /*stage*/, double /*done*/) {
    begun = true;
    const std::lock_guard lock(of_page);
    return true;
  };
  std::thread behind([&] { scan(under_lock); });
  while (!begun) std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  {
    const std::lock_guard lock(of_page);
    EXPECT_FALSE(session().rank().empty());
  }
  behind.join();
}

TEST_F(SessionOfTwo, AFormulaIsOneMoreTest) {
  const auto own = [](const char* expression) {
    return effect_spec("custom", {{"target", std::string("EYY")}, {"expression", std::string(expression)}});
  };
  const double before = session().preview(kReversal).effect.log10_p;
  const EffectPreview same = session().formula(own("dir_y / 2"));
  const EffectFinding reversal = session().preview(kReversal).effect;
  EXPECT_NEAR(same.effect.amplitudes[0].value, reversal.amplitudes[0].value, 1e-12);
  EXPECT_NEAR(same.effect.log10_p, reversal.log10_p, 1e-6);
  EXPECT_GT(reversal.log10_p, before) << "one more effect was looked at";
  session().formula(own("dir_y / 2"));
  EXPECT_EQ(session().preview(kReversal).effect.log10_p, reversal.log10_p) << "the same again is no test";
  EXPECT_EQ(session().add(same.effect.name).effects.size(), 1U);
  EXPECT_THROW(session().formula(own("dir_q")), InputError);
}

TEST_F(SessionOfTwo, SummarisesWhatWasSelected) {
  const Eigen::VectorXd residual = session().residual();
  std::vector<bool> selected(static_cast<std::size_t>(residual.size()), false);
  double sum = 0.0;
  for (std::size_t i = 0; i < 40; ++i) {
    selected[3 * i] = true;
    sum += residual[static_cast<Eigen::Index>(3 * i)];
  }
  const SelectionSummary summary = session().summary(selected);
  EXPECT_EQ(summary.readings, 40U);
  EXPECT_NEAR(summary.mean, sum / 40.0, 1e-15);
  EXPECT_GT(summary.u, 0.01e-6);
  EXPECT_LT(summary.u, 1e-6);
  EXPECT_EQ(session().summary({}).readings, 0U);
}

TEST_F(SessionOfTwo, IsLeftAsItWasByAStepThatIsStopped) {
  session().add(kReversal);
  const SessionModel before = session().current();
  const Eigen::VectorXd residual = session().residual();
  const auto stop = [](const std::string& /*stage*/, double done) { return done < 0.3; };
  EXPECT_THROW(session().take(session().confirmation(), stop), SessionStopped);
  EXPECT_EQ(session().current().number, before.number);
  EXPECT_EQ(session().current().standing, ModelStanding::Preview);
  EXPECT_EQ(session().residual(), residual);
  const auto never = [](const std::string& /*stage*/, double /*done*/) { return false; };
  EXPECT_THROW(Session(campaign(), testing_support::polynomials(), options_of(never)), SessionStopped);
}

}  // namespace
}  // namespace volcal
