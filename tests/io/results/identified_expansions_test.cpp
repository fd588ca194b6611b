// Identified expansions of scales in what is written of a result and read again.

#include "volcal/identify/result/identified_expansions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expanding_scale.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/report/text/fit_summary.h"
#include "volcal/studies/files/study_reader.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing_support::kIdentified;
using testing_support::points_at;

/// At 29 degC, 1 m from home.
double ex_of_warm_end(const FitResult& result) {
  Conditions conditions;
  conditions.temperature_degC["scale"] = 29.0;
  AxisPosition end{};
  end[index_of(AxisName::X)] = 1.0;
  return ErrorField(result, result.machine.tools.front(), conditions).at(end)[0];
}

TEST(IdentifiedExpansions, AreTheSameInAllThatIsWritten) {
  const testing::ScratchFolder folder;
  const Campaign campaign = points_at(30.0, kIdentified);
  const FitResult result = testing_support::fitted(campaign);
  EXPECT_NEAR(ex_of_warm_end(result), 90e-6, 0.01e-6);
  const std::string written = (folder.path() / "result").string();
  write_result_folder(result, campaign, written);
  EXPECT_NEAR(ex_of_warm_end(read_known_errors(written)), ex_of_warm_end(result), 1e-15);
  const FitResult stated = read_known_errors(written + "/identified.toml");
  EXPECT_NEAR(ex_of_warm_end(stated), ex_of_warm_end(result), 1e-15);
  for (const char* errors : {"", "/identified.toml"}) {
    const auto truth = known_truth(written + errors, points_at(30.0, 0.0, 0.0).machine);
    EXPECT_NEAR(truth.expansions.at(AxisName::X).per_kelvin, kIdentified, 1e-9) << errors;
  }
}

TEST(IdentifiedExpansions, StandInTheTextsOfAFit) {
  const Campaign campaign = points_at(30.0, kIdentified);
  const FitResult result = testing_support::fitted(campaign);
  EXPECT_THAT(fit_summary_text(result),
              HasSubstr("  expansion X by T_scale: 10.000 +- 0.040 um/m/K (machine file 14.0 +- 5.9)\n"));
  EXPECT_THAT(fit_text(result, campaign), HasSubstr("Expansion of scales [um/m/K]"));
}

}  // namespace
}  // namespace volcal
