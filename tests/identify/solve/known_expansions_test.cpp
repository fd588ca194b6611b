// What a model says of the expansion of scales, in evaluations, fits and outputs. Points along X, from home
// to the end of a travel of 1 m, are off by a (T - 20 degC) x.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/expanding_scale.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/result/identified_expansions.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/evaluate.h"

namespace volcal {
namespace {

using testing_support::fitted;
using testing_support::kIdentified;
using testing_support::kPoints;
using testing_support::kStated;
using testing_support::kStatedSigma;
using testing_support::model_of_points;
using testing_support::points_at;

ModelSpec knowing(double per_kelvin) {
  ModelSpec model = model_of_points();
  model.expansions[AxisName::X] = per_kelvin;
  return model;
}

double largest_along_x(const std::vector<ResidualRecord>& residuals) {
  double largest = 0.0;
  for (const ResidualRecord& record : residuals) largest = std::max(largest, std::abs(record.residual()));
  return largest;
}

double coefficient_of(const FitResult& result) { return identified_expansions(result).at(0).per_kelvin; }

double ex_at_end(const FitResult& result, double temperature_degC) {
  Conditions conditions;
  conditions.temperature_degC["scale"] = temperature_degC;
  AxisPosition end{};
  end[index_of(AxisName::X)] = 1.0;
  return ErrorField(result, result.machine.tools.front(), conditions).at(end)[0];
}

/// Of the readings alone: at 30 degC a point at x says a with 0.4 um / (10 K x), all 11 together with
/// 0.4 / (10 sqrt(3.85)) um/m/K, which the statement of 3 um/m/K changes by a part in 10^4.
TEST(KnownExpansions, AreIdentifiedWithTheirUncertainty) {
  const FitResult result = fitted(points_at(30.0, kIdentified));
  ASSERT_EQ(identified_expansions(result).size(), 1U);
  const IdentifiedExpansion expansion = identified_expansions(result).front();
  EXPECT_EQ(expansion.axis, AxisName::X);
  EXPECT_EQ(expansion.channel, "scale");
  EXPECT_EQ(expansion.stated, kStated);
  EXPECT_EQ(expansion.stated_u, kStatedSigma);
  EXPECT_NEAR(expansion.per_kelvin, kIdentified, 1e-9);
  EXPECT_NEAR(expansion.u, 0.04e-6 / std::sqrt(3.85), 1e-11);
  EXPECT_EQ(result.identified.expansions.at(AxisName::X), expansion.per_kelvin);
  EXPECT_EQ(model_of_result(result).expansions.at(AxisName::X), expansion.per_kelvin);
}

/// 20 in place of 10 um/m/K, 13 K above 20 degC, over 1 m.
TEST(KnownExpansions, AreHeldInEvaluations) {
  for (const double sigma : {kStatedSigma, 0.0}) {
    const Evaluation wrong = evaluate_model(points_at(33.0, 2.0 * kIdentified, sigma), knowing(kIdentified));
    EXPECT_NEAR(largest_along_x(wrong.residuals), 130e-6, 1e-10) << sigma;
    const Evaluation right = evaluate_model(points_at(33.0, kIdentified, sigma), knowing(kIdentified));
    EXPECT_LT(largest_along_x(right.residuals), 1e-10) << sigma;
  }
}

/// A machine without errors has the expansion that its file states.
TEST(KnownExpansions, OfTheNominalMachineAreThoseStated) {
  const Evaluation nominal = evaluate_model(points_at(33.0, 2.0 * kIdentified), nominal_model());
  EXPECT_NEAR(largest_along_x(nominal.residuals), 6.0 * 13.0e-6, 1e-10);
}

/// rms of 10 um/m/K * 13 K * x over x = 0, 0.1 ... 1: 130 um * sqrt(0.35).
TEST(KnownExpansions, ThatAreWrongFailAValidation) {
  const FitResult result = fitted(points_at(30.0, kIdentified));
  const ValidationFigures wrong = validate(points_at(33.0, 2.0 * kIdentified), result).figures;
  EXPECT_NEAR(wrong.rms_after, 130e-6 * std::sqrt(0.35), 0.1e-6);
  EXPECT_LT(wrong.coverage95, 0.75);  // x y z of 11 points, of which x misses at 10
  for (const double sigma : {kStatedSigma, 0.0}) {
    const ValidationFigures right = validate(points_at(33.0, kIdentified, sigma), result).figures;
    EXPECT_LT(right.rms_after, 0.01e-6) << sigma;
    EXPECT_EQ(right.coverage95, 1.0) << sigma;
  }
}

TEST(KnownExpansions, BringTheirUncertaintyIntoPredictions) {
  const FitResult result = fitted(points_at(30.0, kIdentified));
  const double u = identified_expansions(result).front().u;
  for (const double sigma : {kStatedSigma, 0.0}) {
    const Evaluation evaluation =
        evaluate_model(points_at(33.0, kIdentified, sigma), model_of_result(result), &result);
    EXPECT_NEAR(evaluation.model_u[3 * (kPoints - 1)], u * 13.0, 1e-12) << sigma;
  }
}

/// A model that knows none leaves the machine file's statement as it is, with its uncertainty.
TEST(KnownExpansions, OfTheMachineFileAloneAreAsUncertainAsItSays) {
  const FitResult result = fitted(points_at(30.0, kStated, 0.0));
  ASSERT_TRUE(identified_expansions(result).empty());
  const Evaluation evaluation = evaluate_model(points_at(33.0, kStated), model_of_result(result), &result);
  EXPECT_NEAR(evaluation.model_u[3 * (kPoints - 1)], kStatedSigma * 13.0, 1e-10);
}

TEST(KnownExpansions, ThatTheMachineFileCallsExactStayInAFit) {
  const FitResult result = fitted(points_at(30.0, kIdentified, 0.0), knowing(kIdentified));
  EXPECT_NEAR(coefficient_of(result), kIdentified, 1e-18);
  EXPECT_EQ(identified_expansions(result).front().u, 0.0);
  EXPECT_LT(largest_along_x(result.residuals), 1e-10);
}

TEST(KnownExpansions, ThatTheMachineFileCallsUncertainAreEstimatedAnewByAFit) {
  const Campaign campaign = points_at(30.0, kIdentified);
  const FitResult anew = fitted(campaign, knowing(25e-6));
  EXPECT_EQ(anew.parameters, fitted(campaign).parameters);
}

/// 10 um/m/K, 9 K, 1 m, whatever another machine file of that machine states.
TEST(KnownExpansions, OfAModelFileAreThoseOfTheResult) {
  const FitResult result = fitted(points_at(30.0, kIdentified));
  EXPECT_NEAR(ex_at_end(result, 29.0), 90e-6, 0.01e-6);
  const ModelSpec model = model_of_result(result);
  EXPECT_TRUE(states_errors(model));
  FitResult again = stated_result(result.machine, model);
  EXPECT_NEAR(ex_at_end(again, 29.0), ex_at_end(result, 29.0), 1e-15);
  again = stated_result(points_at(30.0, 0.0, 0.0).machine, model);
  EXPECT_NEAR(ex_at_end(again, 29.0), ex_at_end(result, 29.0), 1e-15);
}

}  // namespace
}  // namespace volcal
