#include "volcal/studies/five_axis_campaign.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

#include "volcal/sim/measurement/measurements.h"
#include "volcal/studies/files/five_axis_machines.h"

namespace volcal::studies {
namespace {

constexpr int kFreshPoses = 300;

double normal(std::mt19937_64& random, double sigma) {
  return std::normal_distribution<double>(0.0, sigma)(random);
}

/// Of three harmonics, with a given RMS over a turn.
sim::ErrorFunction harmonic_function(std::mt19937_64& random, double size) {
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

/// Rotary positions in the order of measurement, linear axes at 0.
std::vector<AxisPosition> rotary_positions(const Machine& machine, const GridPlan& plan) {
  const Axis& tilt = machine.axis(tilting_axis(machine));
  const auto turned = [&](int i) { return 2.0 * std::numbers::pi * i / plan.turns - std::numbers::pi; };
  const auto tilted = [&](int j) { return tilt.travel_min + tilt.travel() * j / (plan.tilts - 1); };
  std::vector<AxisPosition> positions;
  const auto add = [&](double c, double other) {
    AxisPosition& position = positions.emplace_back();
    position[index_of(AxisName::C)] = c;
    position[index_of(tilt.name)] = other;
  };
  if (plan.singly) {
    for (int i = 0; i < plan.turns; ++i) add(turned(i), 0.0);
    for (int j = 0; j < plan.tilts; ++j) add(0.0, tilted(j));
    return positions;
  }
  for (int j = 0; j < plan.tilts; ++j) {
    for (int i = 0; i < plan.turns; ++i) add(turned(i), tilted(j));
  }
  return positions;
}

}  // namespace

sim::TruthMachine five_axis_truth(const Machine& machine, const FiveAxisErrors& errors, std::uint64_t seed) {
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

sim::MachineState state_of(const AxisPosition& position, std::size_t tool) {
  sim::MachineState state;
  state.position = position;
  state.tool = tool;
  return state;
}

AxisPosition followed(const KinematicChain& chain, AxisPosition position, const Tool& tool,
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

Campaign r_test_campaign(const sim::TruthMachine& truth, const GridPlan& plan, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Campaign campaign;
  campaign.file = "campaign.toml";
  campaign.machine = truth.machine();
  const KinematicChain chain(truth.machine());
  for (std::size_t number = 0; number < plan.spheres_w.size() * plan.tools; ++number) {
    const std::size_t tool = number % plan.tools, sphere = number / plan.tools;
    Setup setup;
    setup.name = "S" + std::to_string(number + 1);
    setup.options.set("sphere", "S" + std::to_string(sphere + 1));
    setup.instrument = sim::kRTest;
    setup.tool = tool;
    setup.noise.set("constant", plan.noise);
    setup.has_noise = true;
    Readings& readings = setup.readings;
    readings.value.resize(3);
    for (const AxisPosition& rotary : rotary_positions(truth.machine(), plan)) {
      const AxisPosition position =
          followed(chain, rotary, truth.machine().tools[tool], plan.spheres_w[sphere]);
      const Eigen::Vector3d error =
          truth.point_error(state_of(position, tool), truth.machine().tools[tool].offset);
      for (const Axis& axis : truth.machine().axes)
        readings.position[index_of(axis.name)].push_back(position[index_of(axis.name)]);
      for (std::size_t k = 0; k < 3; ++k)
        readings.value[k].push_back(error[static_cast<Eigen::Index>(k)] + normal(random, plan.noise));
      readings.source_line.push_back(static_cast<std::int64_t>(readings.source_line.size()) + 2);
    }
    campaign.setups.push_back(std::move(setup));
  }
  return campaign;
}

std::vector<FreshPose> fresh_poses(const Machine& machine, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const KinematicChain chain(machine);
  std::vector<FreshPose> poses;
  for (int pose = 0; pose < kFreshPoses; ++pose) {
    const std::size_t tool = static_cast<std::size_t>(pose) % machine.tools.size();
    AxisPosition position{};
    for (const Axis& axis : machine.axes) {
      if (is_rotary(axis.name))
        position[index_of(axis.name)] =
            std::uniform_real_distribution<double>(axis.travel_min, axis.travel_max)(random);
    }
    Eigen::Vector3d place;
    for (double& coordinate : place) coordinate = std::uniform_real_distribution<double>(-0.12, 0.12)(random);
    poses.push_back({followed(chain, position, machine.tools[tool], place), tool});
  }
  return poses;
}

Eigen::MatrixXd setup_datums(const Machine& machine, const std::vector<FreshPose>& poses) {
  const KinematicChain chain(machine);
  const auto rows = 3 * static_cast<Eigen::Index>(poses.size());
  Eigen::MatrixXd datums(rows, 6);
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    const auto row = 3 * static_cast<Eigen::Index>(pose);
    const Eigen::Vector3d at_w =
        chain.nominal_point_w(poses[pose].position, machine.tools[poses[pose].tool].offset);
    for (int k = 0; k < 3; ++k) {
      datums.block<3, 1>(row, k) = Eigen::Vector3d::Unit(k);
      datums.block<3, 1>(row, 3 + k) = Eigen::Vector3d::Unit(k).cross(at_w);
    }
  }
  return datums.householderQr().householderQ() * Eigen::MatrixXd::Identity(rows, 6);
}

double error_after_datums(
    const sim::TruthMachine& truth,
    const std::function<Eigen::Vector3d(const AxisPosition& position, std::size_t tool)>& predicted,
    std::uint64_t seed) {
  const std::vector<FreshPose> poses = fresh_poses(truth.machine(), seed);
  Eigen::VectorXd difference(3 * static_cast<Eigen::Index>(poses.size()));
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    const auto& [position, tool] = poses[pose];
    difference.segment<3>(3 * static_cast<Eigen::Index>(pose)) =
        truth.point_error(state_of(position, tool), truth.machine().tools[tool].offset) -
        predicted(position, tool);
  }
  const Eigen::MatrixXd datums = setup_datums(truth.machine(), poses);
  difference -= datums * (datums.transpose() * difference).eval();
  return std::sqrt(difference.squaredNorm() / static_cast<double>(poses.size()));
}

}  // namespace volcal::studies
