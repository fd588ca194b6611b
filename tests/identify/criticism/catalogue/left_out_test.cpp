// Errors that a model leaves out. The campaigns come from sim/.

#include "volcal/identify/criticism/catalogue/left_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

const Campaign& campaign_of_tracking() {
  static const sim::SimulatedCampaign simulated = [] {
    sim::Study study;
    study.machine = sim::reference_machines()[0];
    study.seed = 44;
    study.truth.random.wave_scale = 0.0;  // functions that polynomials() holds
    sim::Tracking tracking;
    tracking.grid = {5, 4, 4};
    study.measurements.emplace_back().settings = tracking;
    study.validation.points = 10;
    return sim::simulate(study);
  }();
  return simulated.campaign;
}

ModelSpec without(std::initializer_list<const char*> symbols) {
  ModelSpec model = testing_support::polynomials();
  for (const char* symbol : symbols) model.functions[*ErrorSymbol::parse(symbol)].basis = "zero";
  return model;
}

std::set<std::string> targets(const ModelSpec& model) {
  const MeasurementModel bound(campaign_of_tracking(), resolve_knots(model, campaign_of_tracking()));
  std::set<std::string> names;
  for (const LeftOutError& error : left_out_errors(bound)) names.insert(error.effect->name().target.name());
  return names;
}

TEST(LeftOut, ListsWhatTheModelLacks) {
  EXPECT_TRUE(targets({}).empty());
  ModelSpec model = without({"EAZ", "EBX", "EYY"});
  model.locations_off = {*LocationSymbol::parse("EC0Y")};
  EXPECT_EQ(targets(model), (std::set<std::string>{"EBX", "EAZ", "EYY", "EC0Y"}));
}

TEST(LeftOut, IsNamedAndGivenBack) {
  const ModelSpec model = without({"EBX"});
  const FitResult result = fit(campaign_of_tracking(), model);
  const Diagnosis diagnosis = diagnose(campaign_of_tracking(), result, DiagnoseOptions{});
  ASSERT_FALSE(diagnosis.effects.empty());
  const EffectFinding& found = diagnosis.effects.front();
  EXPECT_EQ(found.name, EffectName::of_parts("left-out", "EBX", "x", "function"));
  EXPECT_LT(found.log10_p, -20.0);
  ASSERT_GE(found.amplitudes.size(), 2u);
  EXPECT_EQ(found.amplitudes[1].label, found.label + " P2") << "which error it is, in any table";
  EXPECT_EQ(names_of(errors_given_back(found.spec)), (std::vector<std::string>{"EBX"}));
  ModelSpec extended = model;
  ASSERT_TRUE(restore_left_out(found.spec, campaign_of_tracking().machine, extended));
  EXPECT_TRUE(extended.functions.empty());
  EXPECT_LT(fit(campaign_of_tracking(), extended).chi2, 0.8 * result.chi2);
}

/// The machine has no errors but a scale and a bend of X, a pitch of X and a squareness.
sim::SimulatedCampaign campaign_of_few() {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 71;
  study.truth.perfect = true;
  const auto polynomial = [](std::vector<double> coefficients) {
    FunctionSpec function;
    function.basis = "legendre";
    function.degree = static_cast<int>(coefficients.size()) - 1;
    function.coefficients = std::move(coefficients);
    return function;
  };
  study.truth.functions[*ErrorSymbol::parse("EXX")] = polynomial({0.0, 15e-6, -6e-6});
  study.truth.functions[*ErrorSymbol::parse("EBX")] = polynomial({0.0, 0.0, 12e-6});
  study.truth.locations[*LocationSymbol::parse("EC0Y")] = 20e-6;
  sim::Tracking tracking;
  tracking.grid = {4, 3, 3};
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 10;
  return sim::simulate(study);
}

std::set<std::string> targets_of(const std::vector<EffectFinding>& findings) {
  std::set<std::string> names;
  for (const EffectFinding& found : findings) names.insert(found.name.target.name());
  return names;
}

TEST(LeftOut, FewOfManyAreNamedOneAfterAnother) {
  const Campaign campaign = campaign_of_few().campaign;
  ModelSpec rigid;
  rigid.default_function.basis = "zero";
  for (const char* symbol : {"EC0Y", "EA0Z", "EB0Z"})
    rigid.locations_off.push_back(*LocationSymbol::parse(symbol));
  DiagnoseOptions options;
  options.climb = true;
  options.compare = options.figures = false;
  const DiagnosedModel diagnosed = diagnose_model(campaign, rigid, options);
  const Diagnosis& diagnosis = diagnosed.diagnosis;
  EXPECT_EQ(targets_of(diagnosis.effects), (std::set<std::string>{"EXX", "EBX", "EC0Y"}));
  for (const EffectFinding& found : diagnosis.effects) {
    for (const AmplitudeFigure& amplitude : found.amplitudes) {
      EXPECT_GT(amplitude.u, 1e-9) << found.label << ": as many amplitudes as the model has columns of it";
      EXPECT_LT(amplitude.u, 1e-4) << found.label;
    }
  }
  EXPECT_TRUE(diagnosis.one_of.empty());
  EXPECT_TRUE(diagnosis.surfaces.empty());
  EXPECT_TRUE(diagnosis.unknown.empty());
  ASSERT_EQ(diagnosis.ladder.size(), 4u);
  for (std::size_t i = 1; i < diagnosis.ladder.size(); ++i)
    EXPECT_LT(diagnosis.ladder[i].rms_heldout, diagnosis.ladder[i - 1].rms_heldout) << i;
  EXPECT_LT(diagnosis.ladder.back().systematic, 0.2 * diagnosis.ladder.front().systematic);
}

TEST(LeftOut, RotaryErrorsGoBackInAsManyHarmonicsAsWereFound) {
  EffectSpec spec;
  spec.kind = kLeftOut;
  spec.options.set("symbol", std::string("EBC"));
  ModelSpec model;
  model.functions[*ErrorSymbol::parse("EBC")].basis = "zero";
  ModelSpec most = model;
  state_order(6, spec);
  ASSERT_TRUE(restore_left_out(spec, campaign_of_tracking().machine, most));
  EXPECT_TRUE(most.functions.empty()) << "three were looked for: the model's own choice";
  state_order(4, spec);
  ASSERT_TRUE(restore_left_out(spec, campaign_of_tracking().machine, model));
  EXPECT_EQ(model.functions.at(*ErrorSymbol::parse("EBC")).basis, "fourier");
  EXPECT_EQ(model.functions.at(*ErrorSymbol::parse("EBC")).degree, 2);
}

TEST(LeftOut, GoesBackToTheModelItCameFrom) {
  EffectSpec spec;
  spec.kind = kLeftOut;
  spec.options.set("symbol", std::string("EAX EC0Y"));
  ModelSpec model;
  model.default_function.basis = "zero";
  model.locations_off = {*LocationSymbol::parse("EC0Y")};
  EXPECT_TRUE(restore_left_out(spec, campaign_of_tracking().machine, model));
  EXPECT_EQ(model.functions.at(*ErrorSymbol::parse("EAX")).basis, "bspline");
  EXPECT_TRUE(model.locations_off.empty());
  spec.kind = "reversal";
  EXPECT_FALSE(restore_left_out(spec, campaign_of_tracking().machine, model));
}

}  // namespace
}  // namespace volcal
