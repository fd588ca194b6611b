// Archives of GTC: names that are tags, leaves that are correlated or stand alone.

#include "volcal/identify/io/exports/gtc_archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace volcal {
namespace {

using ::testing::ElementsAre;

TEST(GtcArchive, MakesATagOfEveryName) {
  EXPECT_THAT(gtc_tags({"EXX 0", "station P1 x", "2nd", "a-b", "a b", "a_b", ""}),
              ElementsAre("EXX_0", "station_P1_x", "_2nd", "a_b", "a_b_2", "a_b_3", "_"));
}

/// Three values of variance 4, 9 and 0, the first two with covariance -3: r = -3 / (2 x 3).
JointValues two_correlated_and_one_known() {
  JointValues joint;
  joint.names = {"a", "b", "c"};
  joint.units = {"um", "urad", "mm"};
  joint.values = Eigen::Vector3d(1.5, -2.0, 7.0);
  joint.covariance = (Eigen::Matrix3d() << 4, -3, 0, -3, 9, 0, 0, 0, 0).finished();
  return joint;
}

TEST(GtcArchive, CorrelatesWhatIsCorrelated) {
  const auto archive = nlohmann::json::parse(gtc_archive(two_correlated_and_one_known()));
  const auto leaf = [&](const char* tag) {
    return archive.at("leaf_nodes").at(archive.at("tagged_real").at(tag).at("uid").get<std::string>());
  };
  EXPECT_EQ(archive.at("tagged_real").at("b").at("x"), -2.0);
  EXPECT_EQ(leaf("a").at("u"), 2.0);
  EXPECT_EQ(leaf("b").at("u"), 3.0);
  EXPECT_EQ(leaf("a").at("label"), "a [um]");
  ASSERT_EQ(leaf("a").at("correlation").size(), 1U);
  EXPECT_EQ(leaf("a").at("correlation").at(leaf("b").at("uid").get<std::string>()), -0.5);
  EXPECT_THAT(leaf("b").at("ensemble"), ElementsAre(leaf("a").at("uid"), leaf("b").at("uid")));
  EXPECT_EQ(leaf("c").at("independent"), true);
  EXPECT_FALSE(leaf("c").contains("ensemble"));
}

TEST(GtcArchive, OtherValuesHaveOtherIdentities) {
  JointValues other = two_correlated_and_one_known();
  const std::string before = gtc_archive(other);
  EXPECT_EQ(before, gtc_archive(other));
  other.values[0] = 1.6;
  const auto first_leaf = [](const std::string& text) {
    return nlohmann::json::parse(text).at("leaf_nodes").begin().key();
  };
  EXPECT_NE(first_leaf(before), first_leaf(gtc_archive(other)));
}

}  // namespace
}  // namespace volcal
