// Six choices of primary and secondary axis describe one machine: their functional-point errors differ by a
// rigid motion.

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing_support::error_of;
using testing_support::machine_of;
using testing_support::random_vector;

constexpr std::array<Datum, 6> kDatums = {{{AxisName::X, AxisName::Y},
                                           {AxisName::X, AxisName::Z},
                                           {AxisName::Y, AxisName::X},
                                           {AxisName::Y, AxisName::Z},
                                           {AxisName::Z, AxisName::X},
                                           {AxisName::Z, AxisName::Y}}};

/// Cosines of the angles between the directions of travel: XY, XZ, YZ at [i + j - 1]. They belong to the
/// machine, not to the datum.
using Cosines = std::array<double, 3>;

/// alpha_k of axis j turns e_j by alpha_k e_k x e_j, which lies on the remaining axis i: cos(i, j) =
/// +-alpha_k.
PoseErrors<double> squareness_from(const Cosines& cosines, const Datum& datum) {
  PoseErrors<double> errors;
  for (const LocationSymbol symbol : datum.squareness()) {
    const int k = direction_of(symbol.component);
    const int j = direction_of(symbol.axis);
    const int i = 3 - j - k;
    const double sign = Vector3d::Unit(k).cross(Vector3d::Unit(j))[i];
    error_of(errors, symbol.name()) = sign * cosines[static_cast<std::size_t>(i + j - 1)];
  }
  return errors;
}

TEST(Datum, NamesTheSymbolsOfEachChoice) {
  std::vector<std::string> names;
  for (const Datum& datum : kDatums) {
    for (const LocationSymbol symbol : datum.squareness()) names.push_back(symbol.name());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"EC0Y", "EA0Z", "EB0Z",     // primary X, secondary Y
                                             "EB0Z", "EA0Y", "EC0Y",     // X, Z
                                             "EC0X", "EB0Z", "EA0Z",     // Y, X
                                             "EA0Z", "EB0X", "EC0X",     // Y, Z
                                             "EB0X", "EC0Y", "EA0Y",     // Z, X
                                             "EA0Y", "EC0X", "EB0X"}));  // Z, Y
}

TEST(Datum, AllChoicesGiveTheSameErrorsUpToARigidMotion) {
  const Cosines cosines = {80e-6, -50e-6, 120e-6};
  std::mt19937_64 random(11);
  for (const char* code : {"w X b Y Z t", "w X' Y' b Z t", "w b X Y Z t", "w Y' b X Z t", "w Z' b Y X t"}) {
    const KinematicChain chain(machine_of(code));
    const Vector3d tool = random_vector(random, 0.3);
    PoseErrors<double> reference = squareness_from(cosines, kDatums[0]);
    std::vector<Vector3d> points;
    std::vector<AxisPosition> positions;
    for (int i = 0; i < 60; ++i) {
      const Vector3d q = random_vector(random, 1.0);
      positions.push_back({q[0], q[1], q[2], 0, 0, 0});
      points.push_back(chain.nominal_point_w(positions.back(), tool));
    }
    for (const Datum& datum : kDatums) {
      const PoseErrors<double> errors = squareness_from(cosines, datum);
      std::vector<Vector3d> first_order;
      std::vector<Vector3d> exact;
      for (const AxisPosition& position : positions) {
        first_order.emplace_back(chain.first_order(position, tool, errors).displacement_w -
                                 chain.first_order(position, tool, reference).displacement_w);
        exact.emplace_back(chain.exact_pose<double>(position, tool, errors).point_w -
                           chain.exact_pose<double>(position, tool, reference).point_w);
      }
      EXPECT_LT(sim::rms_after_alignment(points, first_order), 1e-17) << code;
      EXPECT_LT(sim::rms_after_alignment(points, exact), 0.1e-6) << code;  // 300 urad squared times 1 m
    }
  }
}

}  // namespace
}  // namespace volcal
