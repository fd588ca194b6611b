// Archives of GTC: names that are tags, leaves that are correlated or stand alone.

#include "volcal/identify/io/exports/gtc_archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
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
  ASSERT_EQ(leaf("a").at("correlation").size(), 2U);
  EXPECT_EQ(leaf("a").at("correlation").at(leaf("a").at("uid").get<std::string>()), 1.0);
  EXPECT_EQ(leaf("a").at("correlation").at(leaf("b").at("uid").get<std::string>()), -0.5);
  EXPECT_THAT(leaf("b").at("ensemble"), ElementsAre(leaf("a").at("uid"), leaf("b").at("uid")));
  EXPECT_EQ(leaf("c").at("independent"), true);
  EXPECT_FALSE(leaf("c").contains("ensemble"));
}

/// 2 a + b and b + c at two positions: variances 4 x 4 + 9 - 4 x 3 = 13 and 9, covariance 2 x (-3) + 9 = 3.
JointTable two_functions() {
  JointTable table;
  table.rows.names = {"EXX", "EXX"};
  table.rows.units = {"um", "um"};
  table.rows.values = Eigen::Vector2d(1.0, 5.0);
  table.rows.covariance = (Eigen::Matrix2d() << 13, 3, 3, 9).finished();
  table.positions = Eigen::Vector2d(100.0, -12.5);
  table.position_units = {"mm", "mm"};
  table.directions = {0, 1};
  table.extrapolated = {false, false};
  table.derivatives = (Eigen::Matrix<double, 2, 3>() << 2, 1, 0, 0, 1, 1).finished();
  return table;
}

/// As GTC computes it (GTC/lib.py, std_covariance_real): over the correlated leaves of both, each with itself
/// too.
double gtc_covariance(const nlohmann::json& archive, const char* one, const char* other) {
  const auto& a = archive.at("tagged_real").at(one).at("d_components");
  const auto& b = archive.at("tagged_real").at(other).at("d_components");
  double covariance = 0.0;
  for (std::size_t i = 0; i < a.at("index").size(); ++i) {
    const auto& correlation =
        archive.at("leaf_nodes").at(a.at("index")[i].get<std::string>()).at("correlation");
    for (std::size_t j = 0; j < b.at("index").size(); ++j)
      covariance += a.at("value")[i].get<double>() * b.at("value")[j].get<double>() *
                    correlation.value(b.at("index")[j].get<std::string>(), 0.0);
  }
  return covariance;
}

TEST(GtcArchive, HasRowsOfTablesAsFunctionsOfTheValues) {
  EXPECT_THAT(gtc_row_names(two_functions()),
              ElementsAre("EXX at 100 mm", "EXX at minus 12.5 mm towards plus"));
  const auto archive = nlohmann::json::parse(gtc_archive(two_correlated_and_one_known(), two_functions()));
  const auto& row = archive.at("tagged_real").at("EXX_at_100_mm");
  EXPECT_EQ(row.at("CLASS"), "IntermediateReal");
  EXPECT_EQ(row.at("value"), 1.0);
  EXPECT_EQ(row.at("label"), "EXX at 100 mm [um]");
  const auto node = archive.at("intermediate_uids").at(row.at("uid").get<std::string>());
  EXPECT_DOUBLE_EQ(node.at(1).get<double>(), std::sqrt(13.0));
  EXPECT_EQ(row.at("i_components").at("index"), nlohmann::json::array({row.at("uid")}));
  const char* other = "EXX_at_minus_12_5_mm_towards_plus";
  EXPECT_DOUBLE_EQ(gtc_covariance(archive, "EXX_at_100_mm", "EXX_at_100_mm"), 13.0);
  EXPECT_DOUBLE_EQ(gtc_covariance(archive, "EXX_at_100_mm", other), 3.0);
  EXPECT_DOUBLE_EQ(gtc_covariance(archive, other, other), 9.0);  // c is known and contributes nothing
  EXPECT_TRUE(row.at("u_components").at("index").empty());
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
