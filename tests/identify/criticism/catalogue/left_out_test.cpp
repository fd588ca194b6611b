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
  for (const LeftOutError& error : left_out_errors(bound)) names.insert(error.effect->name().target);
  return names;
}

TEST(LeftOut, ListsWhatTheModelLacks) {
  EXPECT_TRUE(targets({}).empty());
  ModelSpec model = without({"EAZ", "EBX", "EYY"});
  model.locations_off = {*LocationSymbol::parse("EC0Y")};
  EXPECT_EQ(targets(model), (std::set<std::string>{"EBX", "EAZ", "EYY", "EBX EAZ", "EC0Y"}));
}

TEST(LeftOut, IsNamedAndGivenBack) {
  const ModelSpec model = without({"EBX"});
  const FitResult result = fit(campaign_of_tracking(), model);
  const Diagnosis diagnosis = diagnose(campaign_of_tracking(), result, DiagnoseOptions{});
  ASSERT_FALSE(diagnosis.effects.empty());
  const EffectFinding& found = diagnosis.effects.front();
  EXPECT_EQ(found.name, (EffectName{"left-out", "EBX", "x", "function"}));
  EXPECT_LT(found.log10_p, -20.0);
  EXPECT_EQ(left_out_symbols(found.spec), (std::vector<std::string>{"EBX"}));
  ModelSpec extended = model;
  ASSERT_TRUE(restore_left_out(found.spec, campaign_of_tracking().machine, extended));
  EXPECT_TRUE(extended.functions.empty());
  EXPECT_LT(fit(campaign_of_tracking(), extended).chi2, 0.8 * result.chi2);
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
