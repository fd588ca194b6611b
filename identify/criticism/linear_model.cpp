#include "volcal/identify/criticism/linear_model.h"

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

#include "volcal/identify/solve/datum.h"

namespace volcal {

LinearModel::LinearModel(const Campaign& campaign, const FitResult& result)
    : campaign_(campaign), model_(campaign, result.adjustment.model) {
  model_.expand_effects(result.parameters);
  model_.set_second_order_remainder(result.parameters);
  views_ = setup_views(campaign_, model_.binding(), model_.chain());
  add_observations(result);
  add_sequences();
  problem_.prior_precision = result.adjustment.prior_precision;
  problem_.prior_mean = result.adjustment.prior_mean - result.adjustment.reduced;
}

void LinearModel::add_observations(const FitResult& result) {
  const DatumSpace datum(model_.layout(), campaign_.machine, result.parameters);
  const std::size_t count = result.residuals.size();
  problem_.jacobian.resize(static_cast<Eigen::Index>(count), datum.size());
  problem_.residual.resize(static_cast<Eigen::Index>(count));
  problem_.data.sigma = result.adjustment.stated_sigma;
  sensitivity_.resize(static_cast<Eigen::Index>(count), kDisturbances);
  RowJacobian row;
  MeasurementModel::DisturbanceRows disturbance;
  for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
    const Readings& readings = campaign_.setups[setup].readings;
    parts_.push_back(static_cast<Eigen::Index>(observations_.size()));
    for (std::size_t i = 0; i < readings.size(); ++i) {
      model_.linearize(setup, i, result.parameters, row);
      model_.disturbance_rows(setup, i, result.parameters, disturbance);
      for (int channel = 0; channel < row.channels; ++channel) {
        const auto at = static_cast<Eigen::Index>(observations_.size());
        problem_.jacobian.row(at) = datum.reduce_rows(dense_row(model_.layout(), row, channel).transpose());
        problem_.residual[at] = readings.value[static_cast<std::size_t>(channel)][i] - row.predicted[channel];
        problem_.data.length.push_back(views_[setup].length[static_cast<Eigen::Index>(i)]);
        sensitivity_.row(at) = disturbance.row(channel);
        if (result.residuals[observations_.size()].removed) {
          problem_.data.sigma[observations_.size()] = std::numeric_limits<double>::infinity();
        }
        observations_.push_back({setup, i, channel});
      }
    }
  }
  parts_.push_back(static_cast<Eigen::Index>(observations_.size()));
}

void LinearModel::add_sequences() {
  std::map<std::tuple<std::size_t, std::int32_t, int>, std::size_t> place;
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const Observation& observation = observations_[i];
    const Setup& setup = campaign_.setups[observation.setup];
    const Readings& readings = setup.readings;
    const std::int32_t run = readings.run.empty() ? 0 : readings.run[observation.row];
    const auto [found, is_new] =
        place.try_emplace({observation.setup, run, observation.channel}, problem_.data.sequences.size());
    if (is_new) {
      problem_.data.sequences.emplace_back();
      const auto known = std::ranges::find(instruments_, setup.instrument);
      problem_.data.sequences.back().group = static_cast<std::size_t>(known - instruments_.begin());
      if (known == instruments_.end()) instruments_.push_back(setup.instrument);
    }
    NoiseSequence& sequence = problem_.data.sequences[found->second];
    sequence.observation.push_back(i);
    if (!readings.time.empty()) sequence.time.push_back(readings.time[observation.row]);
    if (!readings.line.empty()) sequence.line.push_back(readings.line[observation.row]);
  }
}

void LinearModel::columns(const Effect& effect, const Eigen::VectorXd& shape, std::size_t setup,
                          Eigen::Ref<Eigen::MatrixXd> out) const {
  const auto& amplitudes = effect.amplitudes();
  const Eigen::Index first = parts_[setup], count = parts_[setup + 1] - first;
  const Eigen::MatrixXd drivers = effect.drivers(views_[setup], shape);
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const auto sensitivity =
        sensitivity_.col(disturbance_of(amplitudes[k].target, campaign_.machine)).segment(first, count);
    if (drivers.rows() == count) {
      out.col(column) = drivers.col(column).cwiseProduct(sensitivity);
      continue;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::size_t row = observations_[static_cast<std::size_t>(first + i)].row;
      out(i, column) = drivers(static_cast<Eigen::Index>(row), column) * sensitivity[i];
    }
  }
}

Eigen::VectorXd LinearModel::direction(int which) const {
  if (which == 3) return sensitivity_.rightCols<kMaxChannels>().rowwise().sum();
  return -sensitivity_.col(kStationDisturbance + which);
}

NoiseData without(const NoiseData& data, const std::vector<bool>& left_out) {
  NoiseData reduced = data;
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    if (left_out[i]) reduced.sigma[i] = std::numeric_limits<double>::infinity();
  }
  return reduced;
}

}  // namespace volcal
