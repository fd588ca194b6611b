#pragma once
/// Results of models with an effect, their parameters drawn, and poses to ask for their errors at.

#include <random>
#include <vector>

#include "tests/support/random_matrix.h"
#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/pose.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/summaries.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal::testing_support {

inline ModelSpec model_with(const EffectSpec& effect) {
  ModelSpec model;
  model.default_function.basis = "legendre";
  model.default_function.degree = 4;
  model.effects = {effect};
  return model;
}

/// Parameters of the size of real errors, a dense covariance.
inline FitResult result_of_model(const MeasurementModel& model, std::mt19937_64& random) {
  FitResult result;
  result.machine = model.campaign().machine;
  result.identified = model.spec();
  result.layout = model.layout();
  result.parameters = model.initial_parameters();
  for (const FunctionGroup& group : result.layout.groups) {
    for (int i = 0; i < group.size(); ++i) result.parameters[group.offset + i] = uniform(random, 2e-5);
  }
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.kind != ParameterKind::Location && block.kind != ParameterKind::Effect) continue;
    for (int k = 0; k < block.size(); ++k) result.parameters[block.offset + k] = uniform(random, 2e-5);
  }
  const Eigen::MatrixXd root = 1e-6 * test::random_matrix(random, result.layout.size, result.layout.size);
  result.covariance = root * root.transpose();
  result.conditions = recorded_conditions(model.campaign());
  return result;
}

struct Poses {
  std::vector<AxisPosition> positions;
  std::vector<ApproachDirection> directions;
};

inline Poses random_poses(const Machine& machine, std::mt19937_64& random, std::size_t count) {
  Poses poses{std::vector<AxisPosition>(count), std::vector<ApproachDirection>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    for (const Axis& axis : machine.axes) {
      poses.positions[i][index_of(axis.name)] =
          axis.travel_min + axis.travel() * (0.5 + uniform(random, 0.5));
      poses.directions[i][index_of(axis.name)] = uniform(random, 1.0) > 0.0 ? 1 : -1;
    }
  }
  return poses;
}

}  // namespace volcal::testing_support
