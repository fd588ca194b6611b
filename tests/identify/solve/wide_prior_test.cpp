// The wide prior stands on what readings do not determine, and pulls nothing that they do. Diagonals of a
// printed square of 100 mm, as published for the calibration of printers.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/machines.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/rank.h"

namespace volcal {
namespace {

constexpr double kSide = 0.1;                                        // m
constexpr double kAC = 141.22e-3, kBD = 141.45e-3, kAD = 100.06e-3;  // m

struct Line {
  const char* name;
  std::array<double, 2> from, to;
  double length;
};

Campaign printed_square(double sigma) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("wbXYZt");
  for (Axis& axis : campaign.machine.axes) axis.travel_max = kSide;
  campaign.machine.tools = {{"nozzle", Eigen::Vector3d::Zero(), 0.0}};
  for (const Line& line :
       {Line{"AC", {0.0, 0.0}, {kSide, kSide}, kAC}, Line{"BD", {0.0, kSide}, {kSide, 0.0}, kBD},
        Line{"AD", {0.0, 0.0}, {kSide, 0.0}, kAD}}) {
    Setup& setup = campaign.setups.emplace_back();
    setup.name = line.name;
    setup.instrument = "displacement";
    setup.noise.set("constant", sigma);
    setup.readings.position[0] = {line.from[0], line.to[0]};
    setup.readings.position[1] = {line.from[1], line.to[1]};
    setup.readings.position[2] = {0.0, 0.0};
    setup.readings.value = {{0.0, line.length}};
    setup.readings.source_line = {2, 3};
  }
  return campaign;
}

ModelSpec straight_scales() {
  ModelSpec model;
  model.default_function.basis = "zero";
  for (const auto& [component, axis] :
       {std::pair(Component::X, AxisName::X), std::pair(Component::Y, AxisName::Y),
        std::pair(Component::Z, AxisName::Z)}) {
    model.functions[{component, axis}].basis = "legendre";
    model.functions[{component, axis}].degree = 1;
  }
  return model;
}

double squareness_of(const FitResult& result) {
  return result.parameters[result.layout.find_block("EC0Y")->offset];
}

const Observability& figure_with_prior(const FitResult& result, const std::string& symbol) {
  return *std::ranges::find(result.rank.errors, MachineError::parse(symbol), &Observability::symbol);
}

// With AB = BC the printer firmware Marlin computes tan(skew) from the diagonals and a side:
// AB = sqrt(2 AC^2 + 2 BD^2 - 4 AD^2) / 2, skew = tan(pi/2 - acos((AC^2 - AB^2 - AD^2) / (2 AB AD))).
double skew_by_the_cosine_rule() {
  const double ab = 0.5 * std::sqrt(2.0 * kAC * kAC + 2.0 * kBD * kBD - 4.0 * kAD * kAD);
  return std::tan(0.5 * M_PI - std::acos((kAC * kAC - ab * ab - kAD * kAD) / (2.0 * ab * kAD)));
}

TEST(WidePrior, DoesNotPullASquarenessAtAnyStatedNoise) {
  EXPECT_NEAR(skew_by_the_cosine_rule(), -0.0016273, 1e-6);
  for (const double sigma : {0.5e-6, 3e-6, 10e-6, 20e-6, 50e-6}) {
    const FitResult result = fit(printed_square(sigma), straight_scales());
    EXPECT_NEAR(squareness_of(result), -skew_by_the_cosine_rule(), 2e-6) << sigma;
    EXPECT_TRUE(figure_with_prior(result, "EC0Y").visible) << sigma;
    EXPECT_FALSE(figure_with_prior(result, "EB0Z").visible) << "Z stands still";
    EXPECT_EQ(result.status, FitStatus::RankDeficient);
  }
}

TEST(WidePrior, WidthIsThatOfTheModel) {
  ModelSpec model = straight_scales();
  const FitResult by_default = fit(printed_square(10e-6), model);
  model.priors.squareness = 5e-2;
  const FitResult wider = fit(printed_square(10e-6), model);
  EXPECT_NEAR(squareness_of(wider), squareness_of(by_default), 1e-9);
  EXPECT_TRUE(figure_with_prior(wider, "EC0Y").visible);
  EXPECT_NEAR(figure_with_prior(wider, "EC0Y").u_rms / figure_with_prior(by_default, "EC0Y").u_rms, 1.0,
              1e-3);
  const auto u_of_unseen = [](const FitResult& result) {
    const int at = result.layout.find_block("EB0Z")->offset;
    return std::sqrt(result.covariance(at, at));
  };
  EXPECT_NEAR(u_of_unseen(wider), 5e-2, 5e-4) << "what no reading sees is as uncertain as the model says";
  model.priors.squareness = 3e-4;  // twice u
  EXPECT_FALSE(figure_with_prior(fit(printed_square(10e-6), model), "EC0Y").visible);
}

GaussianPrior metre_prior(int size) {
  GaussianPrior prior = GaussianPrior::none(size);
  prior.precision.setIdentity();
  return prior;
}

/// Two parameters of which readings of 1e-9 m see the sum alone: of a prior of 1 m nothing is left in the
/// difference beside 1e18, so that both are held to 1e-12 of that, 1 mm.
TEST(AboveRounding, HoldsWhatIsOneToPreciseReadings) {
  const Eigen::Matrix2d one = 1e18 * Eigen::Matrix2d::Ones();
  const GaussianPrior held = above_rounding(one, metre_prior(2));
  EXPECT_NEAR(held.precision(0, 0), 1e6, 1.0);
  EXPECT_NEAR(held.precision(1, 1), 1e6, 1.0);
  EXPECT_EQ(held.precision(0, 1), 0.0);
}

TEST(AboveRounding, LeavesWhatReadingsTellApartOrHardlySee) {
  Eigen::Matrix2d apart;
  apart << 1e18, 0.5e18, 0.5e18, 1e18;
  EXPECT_TRUE(above_rounding(apart, metre_prior(2)).precision.isIdentity(0.0));
  EXPECT_TRUE(above_rounding(1e6 * Eigen::Matrix2d::Ones(), metre_prior(2)).precision.isIdentity(0.0));
  EXPECT_EQ(above_rounding(Eigen::MatrixXd(0, 0), metre_prior(0)).precision.size(), 0);
}

}  // namespace
}  // namespace volcal
