#include "volcal/identify/cli/options/compensated_readings.h"

#include "volcal/identify/solve/evaluate.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal::cli {
namespace {

ApproachDirection direction_of_row(const Readings& readings, std::size_t row) {
  ApproachDirection direction{};
  for (std::size_t k = 0; k < kAxisCount; ++k) {
    if (row < readings.direction[k].size()) direction[k] = readings.direction[k][row];
  }
  return direction;
}

/// A correction as motions of the joints: of each axis along, or about, itself; U, V, W get none.
Eigen::VectorXd as_disturbance(const Correction& correction, const Structure& structure) {
  Eigen::VectorXd moves = Eigen::VectorXd::Zero(kDisturbances);
  for (std::size_t joint = 0; joint < structure.joints.size(); ++joint) {
    const AxisName axis = structure.joints[joint].axis;
    if (is_parallel(axis)) continue;
    const int direction = direction_of(axis);
    moves[static_cast<Eigen::Index>(6 * joint + index_of(axis))] =
        is_rotary(axis) ? correction.rotary[direction] : correction.linear[direction];
  }
  return moves;
}

}  // namespace

Campaign without_corrections(Campaign campaign, const ActiveTables& tables, int threads) {
  const Campaign measured = campaign;
  const MeasurementModel model(measured, frozen_model(nominal_model()));
  const Eigen::VectorXd parameters = evaluate_model(measured, nominal_model(), nullptr, threads).parameters;
  MeasurementModel::DisturbanceRows rows;
  for (std::size_t setup = 0; setup < campaign.setups.size(); ++setup) {
    Readings& readings = campaign.setups[setup].readings;
    for (std::size_t row = 0; row < readings.size(); ++row) {
      const Correction correction =
          tables.correction(readings.commanded_position(row), direction_of_row(readings, row));
      model.disturbance_rows(setup, row, parameters, rows);
      const Eigen::VectorXd moved = rows * as_disturbance(correction, campaign.machine.structure);
      for (int channel = 0; channel < model.bound(setup).channels(); ++channel)
        readings.value[static_cast<std::size_t>(channel)][row] -= moved[channel];
    }
  }
  return campaign;
}

}  // namespace volcal::cli
