// What the tools of a campaign can tell of the rotations of an axis.

#include "volcal/identify/solve/tool_tips.h"

#include <gtest/gtest.h>

namespace volcal {
namespace {

/// One setup per tool; offsets in mm.
Campaign campaign_with_tools(const std::vector<Eigen::Vector3d>& offsets_mm) {
  Campaign campaign;
  for (const Eigen::Vector3d& offset : offsets_mm) {
    volcal::Setup& setup = campaign.setups.emplace_back();
    setup.tool = campaign.machine.tools.size();
    campaign.machine.tools.push_back({"tool " + std::to_string(setup.tool), offset * 1e-3, 0.0});
  }
  return campaign;
}

const std::vector<std::string> kPartners = {"EAZ", "ECZ", "EA0Z", "station P1"};

TEST(ThirdTool, IsProposedAcrossTheLineOfTwo) {
  const Campaign campaign = campaign_with_tools({{0, 0, -150}, {100, 0, -200}});
  EXPECT_EQ(third_tool_across(campaign, "EYZ", kPartners), 'Y');
}

TEST(ThirdTool, IsProposedWhereThreeTipsLieOnOneLine) {
  const Campaign campaign = campaign_with_tools({{0, 0, -100}, {0, 50, -150}, {0, 100, -200}});
  EXPECT_EQ(third_tool_across(campaign, "EYZ", kPartners), 'X');
}

TEST(ThirdTool, HelpsNeitherWithThreeTipsInAPlaneNorWithOneTool) {
  const Campaign in_a_plane = campaign_with_tools({{0, 0, -150}, {100, 0, -200}, {0, 100, -200}});
  EXPECT_EQ(third_tool_across(in_a_plane, "EYZ", kPartners), std::nullopt);
  EXPECT_EQ(third_tool_across(campaign_with_tools({{0, 0, -150}, {0, 0, -150}}), "EYZ", kPartners),
            std::nullopt);
}

/// Errors of several axes, or no rotation: other readings are missing.
TEST(ThirdTool, IsForTheRotationsOfOneAxis) {
  const Campaign campaign = campaign_with_tools({{0, 0, -150}, {100, 0, -200}});
  EXPECT_EQ(third_tool_across(campaign, "EYZ", {"EAZ", "ECY"}), std::nullopt);
  EXPECT_EQ(third_tool_across(campaign, "EYZ", {"EA0Z"}), std::nullopt);
}

}  // namespace
}  // namespace volcal
