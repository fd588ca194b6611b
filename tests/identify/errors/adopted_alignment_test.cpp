#include <gtest/gtest.h>

#include "tests/support/machines.h"
#include "volcal/identify/errors/alignment.h"

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

}  // namespace
}  // namespace volcal
