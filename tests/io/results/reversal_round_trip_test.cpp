// A fit with reversal, written to a folder and read back, predicts the same readings.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

constexpr double kReversal = 6e-6;

TEST(ReversalRoundTrip, IdentifiedModelPredictsTheSameReadings) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.truth.reversals[*ErrorSymbol::parse("EXX")] = kReversal;
  sim::Tracking tracking;
  tracking.grid = {5, 4, 4};
  study.measurements.emplace_back().settings = tracking;
  const Campaign campaign = sim::simulate(study).campaign;

  ModelSpec model;
  model.default_function.knots = KnotChoice::IntervalCount;
  model.default_function.intervals = 3;
  EffectSpec reversal;
  reversal.kind = "reversal";
  reversal.options.set("symbol", std::string("EXX"));
  model.effects.push_back(reversal);
  const FitResult result = fit(campaign, model);

  const ::volcal::testing::ScratchFolder scratch;
  const auto folder = scratch.path() / "result";
  write_result_folder(result, campaign, folder.string());
  const ModelSpec again = read_model((folder / "identified.toml").string(), campaign.machine);
  ASSERT_EQ(again.effects.size(), 1U);

  const Evaluation written = evaluate_model(campaign, again);
  const Evaluation direct = evaluate_model(campaign, result.identified);
  ModelSpec without = again;
  without.effects.clear();
  const Evaluation one_sided = evaluate_model(campaign, without);
  ASSERT_EQ(written.residuals.size(), result.residuals.size());
  double largest = 0.0, against_fit = 0.0, effect = 0.0;
  for (std::size_t i = 0; i < written.residuals.size(); ++i) {
    const double predicted = written.residuals[i].predicted;
    largest = std::max(largest, std::abs(predicted - direct.residuals[i].predicted));
    against_fit = std::max(against_fit, std::abs(predicted - result.residuals[i].predicted));
    effect = std::max(effect, std::abs(predicted - one_sided.residuals[i].predicted));
  }
  EXPECT_LT(largest, 1e-12);
  EXPECT_LT(against_fit, 0.2e-6) << "stations are estimated again, with the stated weights";
  EXPECT_GT(effect, 0.3 * kReversal) << "the reversal takes part in the prediction";

  const double found = *again.effects[0].options.number("amplitude");
  EXPECT_NEAR(found, kReversal, 0.5e-6);
}

}  // namespace
}  // namespace volcal
