/// A campaign on a machine file that is given beside it: tools go by their names, other machines are refused.

#include "volcal/identify/io/campaign/campaign_on_machine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

Machine machine_of_three_tools() {
  Machine machine = sim::reference_machines()[3];
  machine.file = "own.toml";
  machine.tools = {
      {"short", {0.0, 0.0, -0.15}, 0.0}, {"side", {0.11, 0.0, -0.24}, 3e-6}, {"long", {0.0, 0.0, -0.3}, 0.0}};
  return machine;
}

/// Measured with short and side.
Campaign campaign_of_two_tools() {
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine = machine_of_three_tools();
  campaign.setups.resize(2);
  campaign.setups[0].name = "P1_short";
  campaign.setups[1].name = "P1_side";
  campaign.setups[1].tool = 1;
  campaign.setups[1].source_line = 12;
  return campaign;
}

std::string refusal_on(const Machine& machine) {
  try {
    campaign_on_machine(campaign_of_two_tools(), machine);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CampaignOnMachine, FindsToolsByTheirNames) {
  Machine machine = machine_of_three_tools();
  std::rotate(machine.tools.begin(), machine.tools.begin() + 1, machine.tools.end());
  machine.file = "other.toml";
  const Campaign campaign = campaign_on_machine(campaign_of_two_tools(), machine);
  EXPECT_EQ(campaign.machine.file, "other.toml");
  EXPECT_EQ(campaign.machine.tools[campaign.setups[0].tool].name, "short");
  EXPECT_EQ(campaign.machine.tools[campaign.setups[1].tool].name, "side");
}

TEST(CampaignOnMachine, NeedsOnlyTheToolsOfItsSetups) {
  Machine machine = machine_of_three_tools();
  machine.tools.pop_back();
  EXPECT_EQ(refusal_on(machine), "");
  machine.tools.pop_back();
  EXPECT_THAT(refusal_on(machine),
              HasSubstr("campaign.toml:12: setup \"P1_side\": the machine that is given has no tool side "
                        "(add [tools.side] to it, or give the machine file of the campaign, own.toml)"));
}

TEST(CampaignOnMachine, RefusesAToolOfAnotherOffset) {
  Machine machine = machine_of_three_tools();
  machine.tools[1].offset.x() = 0.12;
  EXPECT_THAT(refusal_on(machine),
              HasSubstr("setup \"P1_side\": the tool side has the offset [110, 0, -240] mm, on the machine "
                        "that is given [120, 0, -240] mm"));
}

TEST(CampaignOnMachine, RefusesAnotherMachine) {
  Machine machine = machine_of_three_tools();
  machine.axes[0].reference_point.y() += 0.05;
  EXPECT_THAT(refusal_on(machine), HasSubstr("the campaign's machine is not the one that is given: reference "
                                             "point of "));
  machine = machine_of_three_tools();
  std::swap(machine.structure.joints[0], machine.structure.joints[1]);
  EXPECT_THAT(refusal_on(machine),
              HasSubstr("the campaign's machine is not the one that is given: structure"));
  Campaign in_memory = campaign_of_two_tools();
  in_memory.machine.file.clear();
  try {
    campaign_on_machine(in_memory, machine);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_EQ(error.remedy(), "give the machine of the campaign");
  }
}

}  // namespace
}  // namespace volcal
