#include "reference_problem.h"

#include <cstdint>
#include <string>
#include <vector>

#include "volcal/identify/solve/normals/datum.h"
#include "volcal/model/observation/measurement_model.h"
#include "volcal/sim/machine/random.h"

namespace volcal::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr double kStationMiss = 2e-3;       // m
constexpr double kErrorCoefficient = 6e-6;  // m or rad, standard deviation
constexpr double kSquareness = 20e-6;       // rad, standard deviation
constexpr std::array<int, 3> kIntervals = {7, 5, 4};

Axis linear_axis(AxisName name, double travel, const Eigen::Vector3d& reference_point) {
  Axis axis;
  axis.name = name;
  axis.travel_max = travel;
  axis.reference_point = reference_point;
  return axis;
}

Machine reference_machine() {
  Machine machine;
  machine.name = "reference";
  machine.structure = Structure::parse("w X' b Y Z t");
  machine.axes = {linear_axis(AxisName::X, 1.0, {0.1, -0.2, -0.4}),
                  linear_axis(AxisName::Y, 0.6, {-0.1, 0.05, -0.3}),
                  linear_axis(AxisName::Z, 0.5, {0.15, 0.2, 0.1})};
  machine.tools = {{"long", {0.0, 0.0, -0.25}, 0.0},
                   {"side", {0.12, 0.0, -0.12}, 0.0},
                   {"front", {0.0, -0.12, -0.12}, 0.0}};
  return machine;
}

ModelSpec reference_model(const Machine& machine) {
  ModelSpec model;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const Axis& axis = machine.axes[i];
    FunctionSpec function;
    function.knots = KnotChoice::Explicit;
    for (int k = 0; k <= kIntervals[i]; ++k) {
      function.breakpoints.push_back(axis.travel_min + axis.travel() * k / kIntervals[i]);
    }
    for (const Component component : kAllComponents) model.functions[{component, axis.name}] = function;
  }
  return model;
}

Readings grid_readings(const Machine& machine, const std::array<int, 3>& grid) {
  Readings readings;
  readings.value.resize(1);
  const auto at = [&](std::size_t axis, int i) {
    return machine.axes[axis].travel_min + machine.axes[axis].travel() * i / (grid[axis] - 1);
  };
  for (int x = 0; x < grid[0]; ++x) {
    for (int y = 0; y < grid[1]; ++y) {
      for (int z = 0; z < grid[2]; ++z) {
        readings.position[index_of(AxisName::X)].push_back(at(0, x));
        readings.position[index_of(AxisName::Y)].push_back(at(1, y));
        readings.position[index_of(AxisName::Z)].push_back(at(2, z));
        readings.source_line.push_back(static_cast<std::int64_t>(readings.size()) + 2);
      }
    }
  }
  return readings;
}

Setup tracer_setup(std::size_t number, const Eigen::Vector3d& station_w, const Machine& machine,
                   const std::array<int, 3>& grid) {
  Setup setup;
  setup.name = "S" + std::to_string(number + 1);
  setup.instrument = "laser-tracer";
  setup.tool = number % machine.tools.size();
  setup.options.set("station", station_w);
  setup.noise.set("constant", 0.2e-6);
  setup.noise.set("per_metre", 0.3e-6);
  setup.has_noise = true;
  setup.readings = grid_readings(machine, grid);
  const KinematicChain chain(machine);
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    AxisPosition position{};
    for (const Axis& axis : machine.axes) {
      position[index_of(axis.name)] = setup.readings.position[index_of(axis.name)][row];
    }
    const Eigen::Vector3d point_w = chain.nominal_point_w(position, machine.tools[setup.tool].offset);
    setup.readings.value[0].push_back((point_w - station_w).norm());
  }
  return setup;
}

/// Random errors that keep the datum.
Eigen::VectorXd true_parameters(const MeasurementModel& model, sim::RandomStream& random) {
  const DatumSpace datum(model.layout(), model.campaign().machine, model.initial_parameters());
  Eigen::VectorXd z = datum.reduced(model.initial_parameters());
  for (const auto& function : datum.functions()) {
    for (int k = 0; k < function.size(); ++k) z[function.offset + k] = kErrorCoefficient * random.normal();
  }
  for (const auto& block : datum.blocks()) {
    if (model.layout().blocks[block.block].location) z[block.offset] = kSquareness * random.normal();
  }
  return datum.raw(z);
}

}  // namespace

ReferenceProblem reference_problem(const std::array<int, 3>& grid) {
  const std::vector<Eigen::Vector3d> stations_w = {{-0.4, -0.3, -0.5}, {1.4, -0.35, -0.45},
                                                   {1.35, 0.9, -0.5},  {-0.35, 0.95, -0.4},
                                                   {0.5, -0.6, 0.5},   {0.45, 1.2, 0.45}};
  ReferenceProblem problem;
  Campaign& campaign = problem.campaign;
  campaign.machine = reference_machine();
  problem.model = reference_model(campaign.machine);
  for (std::size_t i = 0; i < stations_w.size(); ++i) {
    campaign.setups.push_back(tracer_setup(i, stations_w[i], campaign.machine, grid));
  }

  sim::RandomStream random(kSeed, "reference problem");
  const MeasurementModel truth(campaign, problem.model);
  const Eigen::VectorXd parameters = true_parameters(truth, random);
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const double dead_path = truth.bound(i).noise_length(0, 0);
    std::vector<double>& value = campaign.setups[i].readings.value[0];
    for (std::size_t row = 0; row < value.size(); ++row) {
      double predicted = 0.0;
      truth.predict(i, row, parameters, &predicted);
      value[row] = predicted - dead_path + truth.sigma(i, row, 0, parameters) * random.normal();
    }
  }
  for (std::size_t i = 0; i < stations_w.size(); ++i) {
    const Eigen::Vector3d guess_w = stations_w[i] + kStationMiss * random.normal_vector().normalized();
    campaign.setups[i].options.set("station", guess_w);
  }
  return problem;
}

EffectSpec coupling() {
  EffectSpec effect;
  effect.kind = "product-coupling";
  effect.options.set("symbol", std::string("EAY"));
  effect.options.set("axis", std::string("Y"));
  effect.options.set("second_axis", std::string("Z"));
  return effect;
}

}  // namespace volcal::bench
