// What the tools of a campaign can tell of the rotations of an axis.

#include "volcal/identify/solve/tool_tips.h"

#include <gtest/gtest.h>

#include "tests/support/effect_campaign.h"

namespace volcal {
namespace {

/// One setup per tool, in which Z moves by 100 mm; offsets in mm.
Campaign campaign_with_tools(const std::vector<Eigen::Vector3d>& offsets_mm) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("w b X Y Z t");
  campaign.machine.tools.clear();
  for (const Eigen::Vector3d& offset : offsets_mm) {
    volcal::Setup& setup = campaign.setups.emplace_back();
    setup.tool = campaign.machine.tools.size();
    for (const double z : {0.0, 0.1}) {
      for (const AxisName axis : kAllAxes)
        setup.readings.position[index_of(axis)].push_back(axis == AxisName::Z ? z : 0.0);
      setup.readings.source_line.push_back(2);
    }
    setup.readings.value = {{0.0, 0.0}};
    campaign.machine.tools.push_back({"tool " + std::to_string(setup.tool), offset * 1e-3, 0.0});
  }
  return campaign;
}

std::vector<MachineError> errors(const std::vector<std::string>& names) {
  std::vector<MachineError> all;
  for (const std::string& name : names) all.push_back(MachineError::parse(name));
  return all;
}

const MachineError kStraightness{ErrorSymbol{Component::Y, AxisName::Z}};
const std::vector<MachineError> kPartners = errors({"EAZ", "ECZ", "EA0Z", "station P1"});

TEST(ThirdTool, IsProposedAcrossTheLineOfTwo) {
  const Campaign campaign = campaign_with_tools({{0, 0, -150}, {100, 0, -200}});
  EXPECT_EQ(third_tool_across(campaign, kStraightness, kPartners), 'Y');
}

TEST(ThirdTool, IsProposedWhereThreeTipsLieOnOneLine) {
  const Campaign campaign = campaign_with_tools({{0, 0, -100}, {0, 50, -150}, {0, 100, -200}});
  EXPECT_EQ(third_tool_across(campaign, kStraightness, kPartners), 'X');
}

TEST(ThirdTool, HelpsNeitherWithThreeTipsInAPlaneNorWithOneTool) {
  const Campaign in_a_plane = campaign_with_tools({{0, 0, -150}, {100, 0, -200}, {0, 100, -200}});
  EXPECT_EQ(third_tool_across(in_a_plane, kStraightness, kPartners), std::nullopt);
  EXPECT_EQ(third_tool_across(campaign_with_tools({{0, 0, -150}, {0, 0, -150}}), kStraightness, kPartners),
            std::nullopt);
}

/// A tool on a setup where Z stands still tells nothing of its errors, and gives the line no third tip.
TEST(ThirdTool, IsNotOneWithWhichTheAxisStandsStill) {
  Campaign campaign = campaign_with_tools({{0, 0, -150}, {100, 0, -200}, {0, 100, -200}});
  campaign.setups[2].readings.position[index_of(AxisName::Z)] = {0.05, 0.05};
  EXPECT_EQ(tools_moved_by(campaign, AxisName::Z), (std::set<std::size_t>{0, 1}));
  EXPECT_TRUE(tools_moved_by(campaign, AxisName::X).empty());
  EXPECT_EQ(third_tool_across(campaign, kStraightness, kPartners), 'Y');
}

/// A tool that stands at another position on each of two setups is moved.
TEST(ToolsMovedBy, CountsPositionsOfAllSetups) {
  Campaign campaign = campaign_with_tools({{0, 0, -150}, {100, 0, -200}});
  campaign.setups[1].tool = 0;
  campaign.setups[0].readings.position[index_of(AxisName::Z)] = {0.0, 0.0};
  campaign.setups[1].readings.position[index_of(AxisName::Z)] = {0.1, 0.1};
  EXPECT_EQ(tools_moved_by(campaign, AxisName::Z), (std::set<std::size_t>{0}));
}

/// Errors of several axes, or no rotation: other readings are missing.
TEST(ThirdTool, IsForTheRotationsOfOneAxis) {
  const Campaign campaign = campaign_with_tools({{0, 0, -150}, {100, 0, -200}});
  EXPECT_EQ(third_tool_across(campaign, kStraightness, errors({"EAZ", "ECY"})), std::nullopt);
  EXPECT_EQ(third_tool_across(campaign, kStraightness, errors({"EA0Z"})), std::nullopt);
  EXPECT_EQ(third_tool_across(campaign, MachineError{"station P1"}, kPartners), 'Y');
}

}  // namespace
}  // namespace volcal
