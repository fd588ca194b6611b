#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/five_axis.h"
#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "volcal/identify/errors/alignment.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

/// Model files do not say that they are aligned: another datum does, and an offset that is a turn of the
/// former.
TEST(AdoptedAlignment, OfErrorsThatDoNotSayItIsKnownByTheirDatum) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("w X' b Y Z t");
  campaign.machine.tools = {{"turned", {0.1, 0.0, -0.2}, 0.0}, {"other", {0.1, 0.0, -0.2}, 0.0}};
  const Machine former = campaign.machine;
  FitResult errors;
  errors.machine = former;
  errors.machine.tools[0].offset.y() += 20e-6;
  errors.machine.tools[1].offset.z() -= 0.01;
  EXPECT_FALSE(is_in_other_frame(errors, former));
  adopt_alignment(campaign, errors);
  EXPECT_EQ(campaign.machine.tools[0].offset, former.tools[0].offset);

  errors.machine.datum = {AxisName::Y, AxisName::Z};
  errors.machine.axes[0].home += 0.3;
  EXPECT_TRUE(is_in_other_frame(errors, former));
  adopt_alignment(campaign, errors);
  EXPECT_EQ(campaign.machine.datum.primary, AxisName::Y);
  EXPECT_EQ(campaign.machine.axes[0].home, errors.machine.axes[0].home);
  EXPECT_EQ(campaign.machine.tools[0].offset, errors.machine.tools[0].offset);
  EXPECT_EQ(campaign.machine.tools[1].offset, former.tools[1].offset);
}

/// Readings of a sphere by an R-test are the errors at its poses less their mean, from the point of the
/// offset that the control knows. Where a table turns the aligned errors are about that point, too. Of a
/// description with turned offsets (3 um, which turn with the table) they are once the readings are restated
/// for these.
TEST(AdoptedAlignment, ReadingsCountFromThePointThatTheControlMoves) {
  const Machine machine = testing_support::five_axis_machine("w C' A' b X Y Z t");
  testing::GivenErrors given;
  for (const LocationSymbol symbol : independent_locations(machine)) given.locations[symbol.name()] = 0.0;
  given.locations["EC0Y"] = 50e-6;
  const FitResult result = testing::result_with(machine, given, 4);
  Alignment alignment;
  alignment.datum = {AxisName::Y, AxisName::X};
  const FitResult aligned = align_result(result, alignment).result;
  constexpr std::size_t kMandrel = 2;
  const Eigen::Vector3d offset = machine.tools[kMandrel].offset;
  EXPECT_EQ(aligned.machine.tools[kMandrel].offset, offset);
  const Eigen::Vector3d displaced =
      ErrorField(aligned, machine.tools[kMandrel]).tool_displacement(AxisPosition{});
  EXPECT_NEAR(displaced.norm(), 3e-6, 1e-9);
  FitResult turned = aligned;
  turned.identified.effects.clear();
  turned.machine.tools[kMandrel].offset += displaced;
  testing_support::GridPlan plan;
  plan.noise = 0.0;
  Campaign campaign = testing_support::r_test_campaign(
      testing_support::five_axis_truth(machine, {0.0, 0.0, 0.0, 0.0}, 1), plan, 1);
  const auto spread = [&](const FitResult& errors, const Campaign& readings) {
    double largest = 0.0;
    for (const auto& setup : readings.setups) {
      if (setup.tool != kMandrel) continue;
      Eigen::MatrixXd left(3, static_cast<Eigen::Index>(setup.readings.size()));
      for (std::size_t row = 0; row < setup.readings.size(); ++row) {
        const AxisPosition position = setup.readings.commanded_position(row);
        for (int k = 0; k < 3; ++k)
          left(k, static_cast<Eigen::Index>(row)) = setup.readings.value[static_cast<std::size_t>(k)][row];
        left.col(static_cast<Eigen::Index>(row)) -=
            volumetric_error(errors, position, machine.tools[kMandrel]).value.head<3>();
      }
      largest = std::max(largest, (left.colwise() - left.rowwise().mean()).cwiseAbs().maxCoeff());
    }
    return largest;
  };
  for (auto& setup : campaign.setups) {
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      const AxisPosition position = setup.readings.commanded_position(row);
      const auto error = volumetric_error(result, position, machine.tools[setup.tool]).value;
      for (std::size_t k = 0; k < 3; ++k) setup.readings.value[k][row] = error[static_cast<Eigen::Index>(k)];
    }
  }
  EXPECT_LT(spread(result, campaign), 1e-15);
  EXPECT_LT(spread(aligned, campaign), 1e-9);
  EXPECT_GT(spread(turned, campaign), 1e-6);
  Campaign as_it_was = campaign;
  adopt_alignment(as_it_was, aligned);
  EXPECT_LT(spread(aligned, as_it_was), 1e-9);
  adopt_alignment(campaign, turned);
  EXPECT_LT(spread(turned, campaign), 1e-9);
}

}  // namespace
}  // namespace volcal
