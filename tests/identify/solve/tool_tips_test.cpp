// What the tools of a campaign can tell of the rotations of an axis.

#include "volcal/identify/solve/tool_tips.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace volcal {
namespace {

using ::testing::HasSubstr;

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
  EXPECT_THAT(third_tool(campaign, "EYZ", kPartners),
              HasSubstr("third tool, its tip 100 mm or more to the side in Y"));
}

TEST(ThirdTool, IsProposedWhereThreeTipsLieOnOneLine) {
  const Campaign campaign = campaign_with_tools({{0, 0, -100}, {0, 50, -150}, {0, 100, -200}});
  EXPECT_THAT(third_tool(campaign, "EYZ", kPartners), HasSubstr("to the side in X"));
}

TEST(ThirdTool, HelpsNeitherWithThreeTipsInAPlaneNorWithOneTool) {
  EXPECT_EQ(third_tool(campaign_with_tools({{0, 0, -150}, {100, 0, -200}, {0, 100, -200}}), "EYZ", kPartners),
            "");
  EXPECT_EQ(third_tool(campaign_with_tools({{0, 0, -150}, {0, 0, -150}}), "EYZ", kPartners), "");
}

/// Errors of several axes, or no rotation: other readings are missing.
TEST(ThirdTool, IsForTheRotationsOfOneAxis) {
  const Campaign campaign = campaign_with_tools({{0, 0, -150}, {100, 0, -200}});
  EXPECT_EQ(third_tool(campaign, "EYZ", {"EAZ", "ECY"}), "");
  EXPECT_EQ(third_tool(campaign, "EYZ", {"EA0Z"}), "");
}

}  // namespace
}  // namespace volcal
