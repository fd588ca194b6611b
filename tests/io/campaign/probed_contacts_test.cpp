// What a campaign says of contacts on a sphere and cannot mean.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/broken_campaigns.h"
#include "tests/support/refusal.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// One contact on the +X side of a sphere, its normal as given; what reading or binding it says.
std::string answer_to(const std::string& normal, const std::string& radius) {
  const testing::ScratchFolder scratch;
  std::string machine = "format = \"volcal-machine-1\"\nstructure = \"w X' b Y Z t\"\n";
  for (const char axis : {'X', 'Y', 'Z'})
    machine += std::string("[axes.") + axis + "]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\n";
  testing::spill(scratch.path() / "machine.toml", machine + "[tools.probe]\noffset_mm = [0.0, 0.0, 0.0]\n");
  testing::spill(scratch.path() / "contacts.csv",
                 "x_mm,y_mm,z_mm,tip_x_mm,tip_y_mm,tip_z_mm,n_x,n_y,n_z\n"
                 "118,100,100,118,100,100,1,0,0\n"
                 "118,100,100,118,100,100," +
                     normal + "\n");
  testing::spill(scratch.path() / "campaign.toml",
                 "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[[setups]]\nname = \"S\"\n"
                 "instrument = \"probed-sphere\"\ndata = \"contacts.csv\"\nradius_mm = " +
                     radius + "\nnoise = { constant_um = 1.0 }\n");
  return testing::refusal([&] {
    const Campaign campaign = read_campaign((scratch.path() / "campaign.toml").string());
    ModelSpec nothing;
    nothing.default_function.basis = "zero";
    MeasurementModel(campaign, nothing);
  });
}

TEST(ProbedContacts, ARadiusIsNotNegative) {
  EXPECT_EQ(answer_to("1,0,0", "18.0"), "");
  EXPECT_THAT(answer_to("1,0,0", "-18.0"), AllOf(HasSubstr("campaign.toml:7"), HasSubstr("radius_mm is -18"),
                                                 HasSubstr("it must not be negative")));
}

/// sqrt(0.6^2 + 0.6^2) = 0.8485; twice the unit vector; nothing.
TEST(ProbedContacts, ANormalHasTheLengthOne) {
  EXPECT_EQ(answer_to("0.6,0.8,0", "18.0"), "");
  EXPECT_THAT(answer_to("0.6,0.6,0", "18.0"),
              AllOf(HasSubstr("contacts.csv:3"), HasSubstr("have the length 0.848528"),
                    HasSubstr("divide n_x, n_y and n_z of every contact by their length")));
  EXPECT_THAT(answer_to("0,0,2", "18.0"), AllOf(HasSubstr("have the length 2"), HasSubstr("divide n_x")));
  EXPECT_THAT(answer_to("0,0,0", "18.0"), HasSubstr("give the direction out of the sphere"));
}

}  // namespace
}  // namespace volcal
