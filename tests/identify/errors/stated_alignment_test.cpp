// Stated errors in other machine coordinate systems: what the Jacobian of the parameters gives, without it.

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/support/five_axis.h"
#include "tests/support/identified_machines.h"
#include "volcal/identify/errors/alignment.h"

namespace volcal {
namespace {

/// Errors that are stated are aligned by their values alone, and have no covariance after it.
TEST(AlignmentOfStatedErrors, IsThatOfTheirValues) {
  for (const char* code : {"w X' b Y Z t", "w A' b X Y Z t"}) {
    std::map<std::string, double> locations = {{"EC0Y", 30e-6}, {"EB0Z", -8e-6}, {"EA0Z", 5e-6}};
    const Machine machine = testing_support::five_axis_machine(code);
    if (machine.has_axis(AxisName::A))
      locations.insert({{"EY0A", 4e-6}, {"EZ0A", -3e-6}, {"EB0A", 11e-6}, {"EC0A", -6e-6}});
    FitResult result = testing::result_with(machine,
                                            {.functions = {{"EXX", [](double q) { return 5e-6 * q; }},
                                                           {"EYX", [](double q) { return 4e-6 * q * q; }},
                                                           {"EBY", [](double q) { return 12e-6 * q; }},
                                                           {"ECZ", [](double q) { return -7e-6 * q; }}},
                                             .locations = locations},
                                            4);
    Alignment alignment;
    alignment.datum = {AxisName::Z, AxisName::X};
    alignment.origin = AxisPosition{0.1, 0.05, 0.02};
    const Eigen::Index size = result.parameters.size();
    result.covariance = 1e-12 * Eigen::MatrixXd::Identity(size, size);
    const AlignedResult known = align_result(result, alignment);
    result.covariance.resize(0, 0);
    const AlignedResult stated = align_result(result, alignment);
    EXPECT_EQ(stated.result.covariance.size(), 0);
    EXPECT_TRUE(stated.frame_covariance.isZero(0.0));
    ASSERT_EQ(stated.result.parameters.size(), known.result.parameters.size());
    EXPECT_LT((known.result.parameters - stated.result.parameters).cwiseAbs().maxCoeff(), 1e-12) << code;
    EXPECT_LT((known.frame_rotation - stated.frame_rotation).norm(), 1e-15) << code;
    EXPECT_GT(known.frame_rotation.norm(), 1e-6) << code;
  }
}

}  // namespace
}  // namespace volcal
