#include "volcal/studies/files/run_points.h"

#include <gtest/gtest.h>

#include <string>

namespace volcal {
namespace {

std::vector<sim::CommandedPoint> points(const std::string& rows) {
  return parse_run_points("x_mm,y_mm,z_mm,b_deg,dir_y,line,run\n" + rows, "points.csv");
}

TEST(RunPoints, ReadsPositionsDirectionsAndLines) {
  const auto read = points("1,2,-3,180,-1,4,5\n0,0,0,0,0,0,0\n");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_DOUBLE_EQ(read[0].position[0], 0.001);
  EXPECT_DOUBLE_EQ(read[0].position[2], -0.003);
  EXPECT_NEAR(read[0].position[4], 3.14159265358979, 1e-14);
  EXPECT_EQ(read[0].direction[1], -1);
  EXPECT_EQ(read[0].line, 4);
  EXPECT_EQ(read[0].run, 5);
}

TEST(RunPoints, RefusesWhatNoRunHolds) {
  for (const char* row : {"1,2,3,0,2,0,0", "1,2,3,0,1e300,0,0", "1,2,3,0,0.5,0,0", "1e9,2,3,0,0,0,0",
                          "1,2,3,0,0,0.5,0", "1,2,3,0,0,0,1e10"}) {
    try {
      points(std::string("0,0,0,0,0,0,0\n") + row + "\n");
      ADD_FAILURE() << row;
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().line, 3) << row;
      EXPECT_FALSE(error.remedy().empty()) << row;
    }
  }
}

}  // namespace
}  // namespace volcal
