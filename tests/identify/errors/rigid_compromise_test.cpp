// The rigid-body model nearest to effects that no rigid body has.

#include "volcal/identify/errors/rigid_compromise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "tests/support/effect_results.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing_support::effect_campaign;
using testing_support::model_with;
using testing_support::Poses;
using testing_support::random_poses;
using testing_support::result_of_model;

/// EAY that goes with the height, its coefficient alone not 0: an error function is zero at home, which
/// random coefficients are not.
FitResult result_of_coupling(const std::string& shape, const std::string& amplitude, double value) {
  std::mt19937_64 random(8);
  EffectSpec effect;
  effect.kind = "axis-coupling";
  effect.options.set("symbol", std::string("EAY"));
  effect.options.set("axis", std::string("Z"));
  effect.options.set("shape", shape);
  const Campaign campaign = effect_campaign();
  const MeasurementModel model(campaign, model_with(effect));
  FitResult result = result_of_model(model, random);
  result.parameters.setZero();
  result.parameters[result.layout.find_block(amplitude)->offset] = value;
  return result;
}

/// What is left of EAY by y z is orthogonal to what the rotation of Y about x does to the axis behind it, and
/// to every displacement of Y.
TEST(RigidCompromise, IsTheLeastSquaresOne) {
  std::mt19937_64 random(7);
  const Campaign campaign = effect_campaign();
  EffectSpec effect;
  effect.kind = "product-coupling";
  effect.options.set("symbol", std::string("EAY"));
  effect.options.set("axis", std::string("Y"));
  effect.options.set("second_axis", std::string("Z"));
  const MeasurementModel model(campaign, model_with(effect));
  const FitResult result = result_of_model(model, random);
  const Tool& tool = result.machine.tools[1];
  const RigidCompromise compromise(result, tool, {});
  ASSERT_FALSE(compromise.empty());
  const LinearDisplacements displacements(result, tool, {});
  constexpr int kPlaces = 60;
  const auto place = [&](AxisName axis, int i) {
    return result.machine.axis(axis).travel_min + result.machine.axis(axis).travel() * (i + 0.5) / kPlaces;
  };
  const Axis& z = result.machine.axis(AxisName::Z);
  const double middle_z = z.travel_min + 0.5 * z.travel();
  const auto left_at = [&](const AxisPosition& q) -> Vector3d {
    return displacements.coupled(q, {}) - compromise.at(q, {});
  };
  double size = 0.0;
  Vector3d mean = Vector3d::Zero();
  std::vector<Vector3d> by_y, by_y_times_z;
  for (int j = 0; j < kPlaces; j += 6) {
    by_y.emplace_back(Vector3d::Zero());
    by_y_times_z.emplace_back(Vector3d::Zero());
    for (int k = 0; k < kPlaces; ++k) {
      AxisPosition q{};
      q[1] = place(AxisName::Y, j);
      q[2] = place(AxisName::Z, k);
      const Vector3d left = left_at(q);
      by_y.back() += left / kPlaces;
      by_y_times_z.back() += left * ((q[2] - middle_z) / z.travel() / kPlaces);
      size = std::max(size, displacements.coupled(q, {}).norm());
    }
    mean += by_y.back() / 10.0;
  }
  EXPECT_GT(size, 1e-8);
  for (std::size_t j = 0; j < by_y.size(); ++j) {
    EXPECT_LT((by_y[j] - mean).norm(), 2e-3 * size);
    EXPECT_LT(std::abs(by_y_times_z[j].y()), 2e-3 * size);
  }
}

TEST(RigidCompromise, TablesOfErrorsWithItLeaveLessThanWithout) {
  const FitResult result = result_of_coupling("quadratic", "EAY by z^2", 3e-4);
  FitResult rigid = result;
  rigid.identified.effects.clear();
  std::mt19937_64 random(8);
  const Poses poses = random_poses(result.machine, random, 300);
  const auto left = [&](const FitResult& tables_of) {
    const TableFormat& format = *find_table_format("csv");
    TableFormatOptions options;
    options.step = 0.01;
    const CompensationTables tables = format.read(write_tables(format, tables_of, options));
    const DisplacementField truth = displacement_field(result, result.machine.tools[0], {});
    const Vector3d at_home = truth(home_of(result.machine), kTowardsPlus);
    double squares = 0.0;
    for (std::size_t i = 0; i < poses.positions.size(); ++i)
      squares += (truth(poses.positions[i], {}) - at_home + tables.correction(poses.positions[i], {}).linear)
                     .squaredNorm();
    return std::sqrt(squares / 300.0);
  };
  EXPECT_LT(left(result), 0.75 * left(rigid));
}

/// EAY = a z moves the axis behind it by functions of z alone, so that tables hold all of it; as every error
/// they are zero at home, where the machine is right.
TEST(RigidCompromise, IsZeroAtHomeAndHoldsWhatOneAxisCan) {
  const FitResult result = result_of_coupling("linear", "EAY by z", 50e-6);
  int at_home = 0;
  for (const ErrorTableRow& row : error_table(result)) {
    if (!row.axis || row.position != result.machine.axis(*row.axis).home) continue;
    ++at_home;
    EXPECT_NEAR(row.value, 0.0, 1e-15) << row.symbol.name();
  }
  EXPECT_GT(at_home, 10);
  const TableFormat& format = *find_table_format("csv");
  TableFormatOptions options;
  options.step = 0.01;
  const CompensationTables tables = format.read(write_tables(format, result, options));
  const DisplacementField truth = displacement_field(result, result.machine.tools[0], {});
  std::mt19937_64 random(9);
  const Poses poses = random_poses(result.machine, random, 50);
  for (const AxisPosition& position : poses.positions)
    EXPECT_LT((truth(position, {}) + tables.correction(position, {}).linear).norm(), 5e-9);
}

}  // namespace
}  // namespace volcal
