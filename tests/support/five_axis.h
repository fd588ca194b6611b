#pragma once
/// Five-axis machines whose errors are known, read by an R-test over a grid of two rotary axes: exact
/// transforms of `sim`, functions of three harmonics, and what a fit of the readings predicts elsewhere.

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/sim/machine/truth_machine.h"

namespace volcal::testing_support {

struct FiveAxisErrors {
  double displacement = 3e-6;        ///< RMS of a rotary error motion, m
  double rotation = 15e-6;           ///< rad
  double offset = 15e-6;             ///< of a location, m
  double tilt = 40e-6;               ///< rad
  double linear_displacement = 0.0;  ///< of linear axes, which a fit of rotary errors alone cannot know, m
  double linear_rotation = 0.0;      ///< rad
};

inline double normal(std::mt19937_64& random, double sigma) {
  return std::normal_distribution<double>(0.0, sigma)(random);
}

/// Two rotary axes, tools of 150 and 300 mm and a mandrel 60 mm to the side; linear travel +-400 mm.
inline Machine five_axis_machine(const std::string& structure) {
  Machine machine;
  machine.name = structure;
  machine.structure = Structure::parse(structure);
  for (const Joint& joint : machine.structure.joints) {
    Axis axis;
    axis.name = joint.axis;
    axis.travel_min =
        is_rotary(joint.axis) ? (joint.axis == AxisName::C ? -1.0 : -2.0 / 3.0) * std::numbers::pi : -0.8;
    axis.travel_max = -axis.travel_min;
    if (joint.axis == AxisName::A || joint.axis == AxisName::B) axis.centre = {0.0, 0.02, 0.05};
    machine.axes.push_back(axis);
  }
  machine.tools = {
      {"short", {0.0, 0.0, -0.15}, 0.0}, {"long", {0.0, 0.0, -0.3}, 0.0}, {"side", {0.06, 0.0, -0.2}, 0.0}};
  return machine;
}

/// Of three harmonics, with a given RMS over a turn.
inline sim::ErrorFunction harmonic_function(std::mt19937_64& random, double size) {
  constexpr int kHarmonics = 3;
  std::vector<double> cosine, sine;
  double square = 0.0;
  for (int k = 1; k <= kHarmonics; ++k) {
    cosine.push_back(normal(random, 1.0 / k));
    sine.push_back(normal(random, 1.0 / k));
    square += 0.5 * (std::pow(cosine.back(), 2) + std::pow(sine.back(), 2));
  }
  const double scale = size / std::sqrt(square);
  return [=](double q) {
    double value = 0.0;
    for (int k = 1; k <= kHarmonics; ++k) {
      const auto i = static_cast<std::size_t>(k - 1);
      value += cosine[i] * (std::cos(k * q) - 1.0) + sine[i] * std::sin(k * q);
    }
    return scale * value;
  };
}

inline sim::TruthMachine five_axis_truth(const Machine& machine, const FiveAxisErrors& errors,
                                         std::uint64_t seed) {
  std::mt19937_64 random(seed);
  sim::TruthMachine truth(machine);
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      const bool turns = is_rotation(component);
      if (!is_rotary(axis.name)) {
        const double size = turns ? errors.linear_rotation : errors.linear_displacement;
        const double phase = normal(random, 3.0), amplitude = std::numbers::sqrt2 * size;
        if (size > 0.0) {
          truth.set_error({component, axis.name}, [=](double q) {
            return amplitude * (std::sin(9.0 * q + phase) - std::sin(phase));
          });
        }
        continue;
      }
      truth.set_error({component, axis.name},
                      harmonic_function(random, turns ? errors.rotation : errors.displacement));
      if (turns || direction_of(component) != direction_of(axis.name))
        truth.set_location({component, axis.name}, normal(random, turns ? errors.tilt : errors.offset));
    }
  }
  return truth;
}

inline sim::MachineState state_of(const AxisPosition& position, std::size_t tool) {
  sim::MachineState state;
  state.position = position;
  state.tool = tool;
  return state;
}

/// Linear positions that bring the nominal tool point to a place of the workpiece.
inline AxisPosition followed(const KinematicChain& chain, AxisPosition position, const Tool& tool,
                             const Eigen::Vector3d& place_w) {
  for (const AxisName axis : kLinearAxes) position[index_of(axis)] = 0.0;
  const Eigen::Vector3d start = chain.nominal_point_w(position, tool.offset);
  Eigen::Matrix3d moves;
  for (const AxisName axis : kLinearAxes) {
    AxisPosition moved = position;
    moved[index_of(axis)] = 1.0;
    moves.col(direction_of(axis)) = chain.nominal_point_w(moved, tool.offset) - start;
  }
  const Eigen::Vector3d travel = moves.inverse() * (place_w - start);
  for (const AxisName axis : kLinearAxes) position[index_of(axis)] = travel[direction_of(axis)];
  return position;
}

struct GridPlan {
  int turns = 12;  ///< positions of C
  int tilts = 9;   ///< positions of the other axis
  double noise = 1.5e-6;
  std::vector<Eigen::Vector3d> spheres_w = {{0.1, 0.0, 0.05}, {-0.06, 0.09, 0.05}, {-0.05, -0.08, 0.12}};
};

/// One setup per tool and sphere by the instrument r-test; a sphere stands still while tools are changed.
inline Campaign r_test_campaign(const sim::TruthMachine& truth, const GridPlan& plan, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine = truth.machine();
  const KinematicChain chain(truth.machine());
  const bool by_a = truth.machine().has_axis(AxisName::A);
  const AxisName tilting = by_a ? AxisName::A : AxisName::B;
  const Axis& tilt_axis = truth.machine().axis(tilting);
  for (std::size_t number = 0; number < plan.spheres_w.size() * truth.machine().tools.size(); ++number) {
    const std::size_t tool = number % truth.machine().tools.size(),
                      sphere = number / truth.machine().tools.size();
    Setup setup;
    setup.name = "S" + std::to_string(number + 1);
    setup.options.set("sphere", "S" + std::to_string(sphere + 1));
    setup.instrument = "r-test";
    setup.tool = tool;
    setup.noise.set("constant", plan.noise);
    setup.has_noise = true;
    Readings& readings = setup.readings;
    readings.value.resize(3);
    for (int j = 0; j < plan.tilts; ++j) {
      for (int i = 0; i < plan.turns; ++i) {
        AxisPosition position{};
        position[index_of(AxisName::C)] = 2.0 * std::numbers::pi * i / plan.turns - std::numbers::pi;
        position[index_of(tilting)] = tilt_axis.travel_min + tilt_axis.travel() * j / (plan.tilts - 1);
        position = followed(chain, position, truth.machine().tools[tool], plan.spheres_w[sphere]);
        const Eigen::Vector3d error =
            truth.point_error(state_of(position, tool), truth.machine().tools[tool].offset);
        for (const Axis& axis : truth.machine().axes)
          readings.position[index_of(axis.name)].push_back(position[index_of(axis.name)]);
        for (std::size_t k = 0; k < 3; ++k)
          readings.value[k].push_back(error[static_cast<Eigen::Index>(k)] + normal(random, plan.noise));
        readings.source_line.push_back(static_cast<std::int64_t>(readings.source_line.size()) + 2);
      }
    }
    campaign.setups.push_back(std::move(setup));
  }
  return campaign;
}

/// RMS over random poses of a field less the truth, m, after the datums of a set-up: one shift and rotation
/// of the workpiece.
template <class Field>
double error_after_datums(const sim::TruthMachine& truth, const Field& field, std::uint64_t seed) {
  constexpr int kPoses = 300;
  std::mt19937_64 random(seed);
  const KinematicChain chain(truth.machine());
  Eigen::MatrixXd datums(3 * kPoses, 6);
  Eigen::VectorXd difference(3 * kPoses);
  for (int pose = 0; pose < kPoses; ++pose) {
    const std::size_t tool = static_cast<std::size_t>(pose) % truth.machine().tools.size();
    AxisPosition position{};
    for (const Axis& axis : truth.machine().axes) {
      if (is_rotary(axis.name))
        position[index_of(axis.name)] =
            std::uniform_real_distribution<double>(axis.travel_min, axis.travel_max)(random);
    }
    const Eigen::Vector3d place = Eigen::Vector3d::NullaryExpr(
        [&](Eigen::Index) { return std::uniform_real_distribution<double>(-0.12, 0.12)(random); });
    position = followed(chain, position, truth.machine().tools[tool], place);
    const Eigen::Vector3d actual =
        truth.point_error(state_of(position, tool), truth.machine().tools[tool].offset);
    difference.segment<3>(3 * pose) = actual - field(position, tool);
    for (int k = 0; k < 3; ++k) {
      datums.block<3, 1>(3 * pose, k) = Eigen::Vector3d::Unit(k);
      datums.block<3, 1>(3 * pose, 3 + k) = Eigen::Vector3d::Unit(k).cross(place);
    }
  }
  difference -= datums * datums.colPivHouseholderQr().solve(difference);
  return std::sqrt(difference.squaredNorm() / kPoses);
}

}  // namespace volcal::testing_support
