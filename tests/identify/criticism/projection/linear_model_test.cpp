// Readings that a fit took for outliers, in the linear model.

#include "volcal/identify/criticism/projection/linear_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/solve/adjustment.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(LinearModel, ReinstatesReadingsInAnotherModel) {
  testing_support::FittedStudy study(testing_support::hiding({}, {3, 3, 3}));
  for (const std::size_t observation : {4U, 9U, 20U}) study.result.residuals[observation].removed = true;
  const LinearModel model(study.simulated.campaign, study.result);
  const auto& sigma = model.problem().data.sigma;
  EXPECT_THAT(model.removed(), ElementsAre(4U, 9U, 20U));
  EXPECT_TRUE(std::isinf(sigma[4]) && std::isinf(sigma[9]) && std::isinf(sigma[20]));
  EXPECT_TRUE(std::isfinite(sigma[5]));

  const LinearModel other = model.with_reinstated({4U, 20U});
  const auto& of_other = other.problem().data.sigma;
  EXPECT_THAT(other.removed(), ElementsAre(9U));
  EXPECT_EQ(of_other[4], model.stated_sigma()[4]);
  EXPECT_EQ(of_other[20], model.stated_sigma()[20]);
  EXPECT_TRUE(std::isinf(of_other[9]));
  EXPECT_THAT(other.with_reinstated({9U}).removed(), IsEmpty());

  EXPECT_THAT(model.removed(), ElementsAre(4U, 9U, 20U));
  EXPECT_TRUE(std::isinf(sigma[4]) && std::isinf(sigma[9]) && std::isinf(sigma[20]));
}

/// A model of every third reading has the rows of the whole one, an effect that remembers earlier readings
/// included, and takes the readings that the fit removed for removed.
TEST(LinearModel, OfSomeReadingsHasTheirRows) {
  testing_support::FittedStudy study(testing_support::hiding({}, {4, 3, 3}));
  study.result.residuals[6].removed = study.result.residuals[7].removed = true;
  const LinearModel all(study.simulated.campaign, study.result);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < all.size(); i += 3) chosen.push_back(i);
  const LinearModel some(study.simulated.campaign, study.result, chosen);
  ASSERT_EQ(some.size(), chosen.size());
  EXPECT_THAT(some.removed(), ElementsAre(2U));
  EffectSpec spec{.kind = "pre-travel", .options = {}};
  spec.options.set("symbol", std::string("EXX"));
  spec.options.set("length", 0.05);
  const std::unique_ptr<Effect> effect = find_effect("pre-travel")->make(spec, "test");
  const auto columns_of = [&](const LinearModel& model) {
    Eigen::MatrixXd columns(static_cast<Eigen::Index>(model.size()),
                            static_cast<Eigen::Index>(effect->amplitudes().size()));
    for (std::size_t setup = 0; setup + 1 < model.parts().size(); ++setup) {
      const Eigen::Index first = model.parts()[setup];
      model.columns(*effect, effect->shape_values(), setup,
                    columns.middleRows(first, model.parts()[setup + 1] - first));
    }
    return columns;
  };
  const Eigen::MatrixXd whole = columns_of(all), part = columns_of(some);
  EXPECT_GT(whole.norm(), 0.0);
  std::size_t in_sequences = 0;
  for (const NoiseSequence& sequence : some.problem().data.sequences)
    in_sequences += sequence.observation.size();
  EXPECT_EQ(in_sequences, chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const auto own = static_cast<Eigen::Index>(k), of_all = static_cast<Eigen::Index>(chosen[k]);
    EXPECT_EQ(some.problem().jacobian.row(own), all.problem().jacobian.row(of_all));
    EXPECT_EQ(some.problem().residual[own], all.problem().residual[of_all]);
    EXPECT_EQ(some.problem().data.sigma[k], all.problem().data.sigma[chosen[k]]);
    EXPECT_EQ(some.stated_sigma()[k], all.stated_sigma()[chosen[k]]);
    EXPECT_EQ(part.row(own), whole.row(of_all));
  }
}

TEST(LinearModel, ChoosesWholeReadingsEvenly) {
  std::vector<ObservationPlace> places;
  for (std::size_t row = 0; row < 1000; ++row) {
    for (int channel = 0; channel < 3; ++channel) places.push_back({row / 500, row % 500, channel});
  }
  const std::vector<std::size_t> chosen = evenly_chosen(places, 301);
  ASSERT_EQ(chosen.size(), 300U);
  for (std::size_t k = 0; k < chosen.size(); ++k) EXPECT_EQ(chosen[k] % 3, k % 3);
  const auto in_first = std::ranges::count_if(chosen, [](std::size_t i) { return i < 1500; });
  EXPECT_NEAR(static_cast<double>(in_first), 150.0, 45.0);
  EXPECT_EQ(evenly_chosen(places, 3000).size(), 3000U);
}

/// The functions' columns from what each reading depends on.
TEST(LinearModel, LocalRowsAreTheSameColumns) {
  const testing_support::FittedStudy study(testing_support::hiding({}, {5, 4, 3}));
  const LinearModel model(study.simulated.campaign, study.result);
  const NoiseProblem& problem = model.problem();
  const LocalRows& local = *problem.local;
  Eigen::MatrixXd coefficients = Eigen::MatrixXd::Zero(problem.jacobian.rows(), local.coefficients);
  for (const LocalRows::Group& group : local.groups) {
    for (Eigen::Index i = 0; i < coefficients.rows(); ++i) {
      coefficients.row(i).segment(group.first[static_cast<std::size_t>(i)], group.derivatives.rows()) =
          group.derivatives.col(i);
    }
  }
  ASSERT_GT(local.columns(), 21);
  EXPECT_LT(local.columns(), problem.jacobian.cols());
  for (const LocalRows::Combination& function : local.combinations) {
    const auto columns = problem.jacobian.middleCols(function.column, function.basis.cols());
    EXPECT_LT((coefficients(Eigen::all, function.coefficients) * function.basis - columns).norm(),
              1e-13 * columns.norm());
  }
}

/// Residuals that follow a wave along X of 3 um: the functions of X may be rougher than without it, and what
/// a column without prior explains asks for no roughness.
TEST(LinearModel, SmoothsByWhatTheReadingsAsk) {
  const testing_support::FittedStudy study(testing_support::hiding({}, {7, 4, 4}), ModelSpec{});
  const LinearModel model(study.simulated.campaign, study.result);
  const auto roughness = [&](const Eigen::VectorXd& residual, bool explained) {
    Projector projector = testing_support::white_projector(model, residual);
    if (explained) projector.accept(residual);
    const LinearModel smoothed = model.smoothed(projector.gram(), projector.observations(), 1);
    const auto term =
        std::ranges::find(smoothed.smoothing(), *ErrorSymbol::parse("EXX"), &SmoothingTerm::symbol);
    return 1.0 / std::sqrt(term->lambda);
  };
  Eigen::VectorXd wave = model.direction(ScanDirection::X);
  for (Eigen::Index i = 0; i < wave.size(); ++i) {
    const auto& [setup, row, channel] = model.observations()[static_cast<std::size_t>(i)];
    wave[i] *= 3e-6 * std::sin(25.0 * study.simulated.campaign.setups[setup].readings.position[0][row]);
  }
  std::mt19937_64 random(8);
  const Eigen::VectorXd noise = testing_support::white_residual(model, random);
  const double rough = roughness(wave + noise, false);
  EXPECT_GT(rough, 1.3 * roughness(noise, false));
  EXPECT_LT(roughness(wave + 1e-3 * noise, true), rough);
  const auto as_fitted = study.result.adjustment->smoothing.front().lambda;
  EXPECT_EQ(model.smoothing().front().lambda, as_fitted);
}

}  // namespace
}  // namespace volcal
