// Drivers as polynomials of the positions against the drivers of the catalogue, pose by pose.

#include "volcal/identify/errors/driver_polynomials.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/solve/summaries.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using testing_support::effect_campaign;
using testing_support::uniform;

constexpr double kSameDriver = 1e-12;  // of the largest

Conditions warm_and_late() {
  Conditions conditions;
  conditions.temperature_degC = {{"air", 22.1}, {"spindle", 24.3}};
  conditions.time = 1234.0;
  conditions.feed = 0.02;
  return conditions;
}

FitResult result_with(const Campaign& campaign, const EffectSpec& effect) {
  ModelSpec spec;
  spec.default_function.basis = "legendre";
  spec.default_function.degree = 3;
  spec.effects = {effect};
  const MeasurementModel model(campaign, spec);
  FitResult result;
  result.machine = campaign.machine;
  result.identified = model.spec();
  result.layout = model.layout();
  result.parameters = model.initial_parameters();
  result.conditions = recorded_conditions(campaign);
  return result;
}

/// Up to half a travel beyond the ends, every combination of directions and the mean of both among them.
void random_poses(const Machine& machine, std::mt19937_64& random, std::vector<AxisPosition>& positions,
                  std::vector<ApproachDirection>& directions) {
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (const Axis& axis : machine.axes) {
      const std::size_t a = index_of(axis.name);
      positions[i][a] = axis.travel_min + axis.travel() * (0.5 + uniform(random, 1.0));
      directions[i][a] = static_cast<std::int8_t>(std::uniform_int_distribution<int>(-1, 1)(random));
    }
  }
}

TEST(DriverPolynomials, AreTheDriversOfEveryKindThatIsDeclaredOne) {
  const Campaign campaign = effect_campaign("w X' b Y Z t");
  std::mt19937_64 random(31);
  std::vector<AxisPosition> positions(60);
  std::vector<ApproachDirection> directions(60);
  random_poses(campaign.machine, random, positions, directions);
  std::set<std::string> held_kinds;
  for (const EffectKind* kind : effect_kinds()) {
    for (const EffectSpec& spec : kind->examples(campaign)) {
      const FitResult result = result_with(campaign, spec);
      const MachineEffects effects(result, campaign.machine.tools.front(), warm_and_late());
      const std::vector<std::size_t> held = DriverPolynomials::held_by(effects);
      EXPECT_TRUE(kind->schema().polynomial || held.empty()) << spec.kind;
      if (held.empty()) continue;
      held_kinds.insert(spec.kind);
      const DriverPolynomials polynomials(effects.subset(held), campaign.machine);
      const Eigen::MatrixXd wanted = effects.drivers(positions, directions);
      const double largest = wanted.cwiseAbs().maxCoeff();
      for (std::size_t i = 0; i < positions.size(); ++i) {
        const auto powers = polynomials.powers_at(positions[i]);
        for (Eigen::Index c = 0; c < wanted.cols(); ++c)
          ASSERT_NEAR(polynomials.driver(static_cast<std::size_t>(c), powers, directions[i]),
                      wanted(static_cast<Eigen::Index>(i), c), kSameDriver * largest)
              << spec.kind << " column " << c;
      }
    }
  }
  for (const char* kind : {"axis-coupling", "product-coupling", "triple-coupling", "reversal",
                           "position-reversal", "curved-reversal", "scale-expansion", "common-expansion"})
    EXPECT_TRUE(held_kinds.contains(kind)) << kind;
}

// A dent 1 mm wide lies between any few positions at which one would look: such a driver is no polynomial,
// however well one fits elsewhere.
TEST(DriverPolynomials, ANarrowDentIsNotLost) {
  const Campaign campaign = effect_campaign("w X' b Y Z t");
  const Axis& axis = campaign.machine.axis(AxisName::X);
  const double dent = axis.travel_min + 0.43217 * axis.travel();
  EffectSpec spec;
  spec.kind = "custom";
  spec.options.set("target", std::string("EXX"));
  spec.options.set("expression", "exp(-((x - " + std::to_string(1e3 * dent) + ") / 1)^2)");
  FitResult result = result_with(campaign, spec);
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.kind == ParameterKind::Effect) result.parameters[block.offset] = 5e-6;
  }
  const DisplacementField fast = displacement_field(result, campaign.machine.tools.front(), {});
  AxisPosition position{};
  position[index_of(AxisName::X)] = std::stod(std::to_string(1e3 * dent)) * 1e-3;
  EXPECT_NEAR(fast(position, kTowardsPlus).norm(), 5e-6, 1e-9);
}

}  // namespace
}  // namespace volcal
