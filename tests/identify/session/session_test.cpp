// A session against the diagnosis and the fit that it stands on, and its history.

#include "volcal/identify/session/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using testing_support::hiding;
using testing_support::reversal;

const EffectName kReversal{"reversal", "EYY", "dir_y", "step"};
const EffectName kOther{"reversal", "EXX", "dir_x", "step"};

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

TEST_F(SessionOfTwo, APreviewIsWhatAddingGives) {
  const EffectPreview preview = session().preview(kReversal);
  const double before = rms(session().residual());
  const SessionModel& added = session().add(kReversal);
  EXPECT_EQ(added.change, "+ reversal EYY");
  EXPECT_EQ(added.standing, ModelStanding::Preview);
  EXPECT_EQ(added.parent, 0U);
  ASSERT_EQ(added.effects.size(), 1U);
  const AmplitudeFigure& figure = added.effects[0].amplitudes[0];
  EXPECT_NEAR(figure.value, preview.effect.amplitudes[0].value, 1e-9 * std::abs(figure.value));
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
  own->add({"reversal", "EZZ", "dir_z", "step"});
  EXPECT_EQ(own->current().effects.size(), 3U);
  EXPECT_EQ(own->current().effects[0].amplitudes[0].value, figure.value) << "held by the fit";
  EXPECT_FALSE(own->is_preview(kReversal));
  EXPECT_THROW(own->remove_preview(kReversal), std::invalid_argument);
  const SessionModel& without = own->take(own->removal(kReversal));
  EXPECT_EQ(without.standing, ModelStanding::Fitted) << "taken out of a full fit by another one";
  EXPECT_EQ(without.effects.size(), 2U);
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
