// The rigid-body model nearest to effects that no rigid body has.

#include "volcal/identify/errors/rigid_compromise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
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

struct Coupling {
  std::string symbol, axis, shape;
};

/// Every coefficient 0.
FitResult result_of_model_with(const Coupling& coupling, const Campaign& campaign) {
  std::mt19937_64 random(8);
  EffectSpec effect;
  effect.kind = "axis-coupling";
  effect.options.set("symbol", coupling.symbol);
  effect.options.set("axis", coupling.axis);
  effect.options.set("shape", coupling.shape);
  const MeasurementModel model(campaign, model_with(effect));
  FitResult result = result_of_model(model, random);
  result.parameters.setZero();
  return result;
}

/// EAY that goes with the height, its coefficient alone not 0: an error function is zero at home, which
/// random coefficients are not.
FitResult result_of_coupling(const std::string& shape, const std::string& amplitude, double value) {
  FitResult result = result_of_model_with({"EAY", "Z", shape}, effect_campaign());
  result.parameters[result.layout.find_block(amplitude)->offset] = value;
  return result;
}

std::map<std::string, std::vector<ErrorTableRow>> rows_by_symbol(const FitResult& result, int positions) {
  std::map<std::string, std::vector<ErrorTableRow>> rows;
  for (const ErrorTableRow& row : error_table(result, {.positions = positions}))
    rows[row.symbol.name()].push_back(row);
  return rows;
}

/// Least squares over the travel by the trapezoidal rule, rad.
double slope_of(const std::vector<ErrorTableRow>& rows) {
  const double middle = 0.5 * (rows.front().position + rows.back().position);
  double moment = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double weight = i == 0 || i + 1 == rows.size() ? 0.5 : 1.0, from_middle = rows[i].position - middle;
    moment += weight * from_middle * rows[i].value;
    spread += weight * from_middle * from_middle;
  }
  return moment / spread;
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

/// EAY = a z, a = 50 urad/m, turns the functional point about Y's reference point, z - 0.1 m below it: y by
/// -a z (z - 0.1). Its least-squares slope over 0 <= z <= 1 m is -a (1 - 0.1), since that of z^2 is 1: Z
/// leans by EA0Z = 45 urad, and EYZ keeps a z (1 - z), zero at both ends and 12.5 um in the middle.
TEST(RigidCompromise, SlopesOfStraightnessAreSquareness) {
  const FitResult result = result_of_coupling("linear", "EAY by z", 50e-6);
  const auto rows = rows_by_symbol(result, 11);
  ASSERT_EQ(rows.at("EA0Z").size(), 1u);
  EXPECT_NEAR(rows.at("EA0Z")[0].value, 45e-6, 1e-15);
  const double per_amplitude = 0.9;
  const int amplitude = result.layout.find_block("EAY by z")->offset;
  const int own = result.layout.find_block("EA0Z")->offset;
  const double variance = result.covariance(own, own) +
                          2.0 * per_amplitude * result.covariance(own, amplitude) +
                          per_amplitude * per_amplitude * result.covariance(amplitude, amplitude);
  EXPECT_NEAR(rows.at("EA0Z")[0].u, std::sqrt(variance), 1e-9 * std::sqrt(variance));
  for (const ErrorTableRow& row : rows.at("EYZ"))
    EXPECT_NEAR(row.value, 50e-6 * row.position * (1.0 - row.position), 1e-15);
  for (const char* other : {"EC0Y", "EB0Z"}) EXPECT_EQ(rows.at(other)[0].value, 0.0) << other;
}

/// ... where the model leaves the squareness out, too.
TEST(RigidCompromise, SquarenessThatHasNoParameterHasARowWhereEffectsLean) {
  EffectSpec effect;
  effect.kind = "axis-coupling";
  effect.options.set("symbol", std::string("EAY"));
  effect.options.set("axis", std::string("Z"));
  ModelSpec spec = model_with(effect);
  spec.locations_off = {{Component::A, AxisName::Z}, {Component::C, AxisName::Y}};
  const Campaign campaign = effect_campaign();
  std::mt19937_64 random(8);
  FitResult result = result_of_model(MeasurementModel(campaign, spec), random);
  result.parameters.setZero();
  result.parameters[result.layout.find_block("EAY by z")->offset] = 50e-6;
  const auto rows = rows_by_symbol(result, 11);
  ASSERT_EQ(rows.count("EA0Z"), 1u);
  EXPECT_NEAR(rows.at("EA0Z")[0].value, 45e-6, 1e-15);
  EXPECT_EQ(rows.count("EC0Y"), 0u);
}

/// At the positions of the tables, where nothing is interpolated, tables with their squareness apart correct
/// what the displacement of the nearest rigid body is, which knows of no squareness. The straightness that is
/// left has no angle between the axes: slopes of two axes against each other are opposite, a rotation of
/// both.
TEST(RigidCompromise, SquarenessApartChangesNoCorrectedPosition) {
  const std::vector<Coupling> couplings = {{"EAY", "Z", "quadratic"}, {"ECX", "Y", "linear"},
                                           {"EBX", "Z", "cubic"},     {"EXY", "Z", "quadratic"},
                                           {"EYX", "Z", "linear"},    {"EZZ", "X", "quadratic"}};
  const TableFormat& format = *find_table_format("csv");
  for (const double home : {0.0, 0.3}) {
    Campaign campaign = effect_campaign();
    for (Axis& axis : campaign.machine.axes) axis.home = home;
    for (const Coupling& coupling : couplings) {
      SCOPED_TRACE(coupling.symbol + " by " + coupling.axis + ", home " + std::to_string(home));
      FitResult result = result_of_model_with(coupling, campaign);
      for (const ParameterBlock& block : result.layout.blocks) {
        if (block.kind == ParameterKind::Effect) result.parameters[block.offset] = 5e-5;
      }
      TableFormatOptions options;
      options.functions.positions = 11;
      const CompensationTables tables = format.read(write_tables(format, result, options));
      const RigidCompromise rigid(result, result.machine.tools[0], {});
      std::mt19937_64 random(10);
      std::uniform_int_distribution<int> node(0, 10);
      double largest = 0.0;
      for (int i = 0; i < 200; ++i) {
        AxisPosition position{};
        for (std::size_t axis = 0; axis < 3; ++axis) position[axis] = 0.1 * node(random);
        const Vector3d error = rigid.at(position, {});
        EXPECT_LT((error + tables.correction(position, {}).linear).norm(), 1e-12);
        largest = std::max(largest, error.norm());
      }
      EXPECT_GT(largest, 1e-6);
      const auto rows = rows_by_symbol(result, 401);
      EXPECT_NEAR(slope_of(rows.at("EYX")) + slope_of(rows.at("EXY")), 0.0, 1e-9);
      EXPECT_NEAR(slope_of(rows.at("EZX")) + slope_of(rows.at("EXZ")), 0.0, 1e-9);
      EXPECT_NEAR(slope_of(rows.at("EZY")) + slope_of(rows.at("EYZ")), 0.0, 1e-9);
    }
  }
}

}  // namespace
}  // namespace volcal
