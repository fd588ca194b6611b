#include "volcal/identify/report/values/measured_error.h"

#include <utility>

#include "volcal/identify/result/fitted_readings.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
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

/// Stations, centres and alignments are those that the readings give: guesses of them may be far off.
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

}  // namespace

MeasuredError measured_error(const Campaign& campaign, int threads) {
  const Evaluation evaluation = evaluate_model(campaign, nominal_model(), nullptr, threads);
  return {campaign.file, campaign.active_compensations, campaign.setups.size(),
          error_sizes(campaign, evaluation.residuals)};
}

MeasuredError take_out_tables(const ActiveTables& tables, const FitResult& errors, Campaign& campaign,
                              int threads) {
  if (tables.is_doubtful)
    campaign.notes.push_back(
        {FindingCode::CompensationsInTables, {{"identified", errors.active_compensations}}});
  if (!names_compensations(campaign.active_compensations)) {
    Finding unstated{FindingCode::CompensationsUnstated};
    if (!campaign.active_compensations.empty()) unstated.data["stated"] = campaign.active_compensations;
    campaign.notes.push_back(std::move(unstated));
  }
  MeasuredError measured = measured_error(campaign, threads);
  campaign = without_corrections(std::move(campaign), tables, threads);
  return measured;
}

void require_campaign_of(const FitResult& result, const Campaign& campaign) {
  const FittedReadings fitted = fitted_readings(campaign, result);
  if (fitted.readings > 0) return;
  if (result.setups.empty())
    throw InputError({},
                     "a certificate states what was identified from readings, and these errors were stated",
                     "give the result folder of volcal fit");
  throw InputError({campaign.file, 0}, "the result was not identified from the readings of this campaign",
                   "give the campaign.toml that volcal fit has read");
}

}  // namespace volcal
