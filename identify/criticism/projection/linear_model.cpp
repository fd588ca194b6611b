#include "volcal/identify/criticism/projection/linear_model.h"

#include <limits>
#include <memory>
#include <utility>

#include "volcal/identify/solve/adjustment.h"

namespace volcal {

LinearModel::LinearModel(const Campaign& campaign, const FitResult& result)
    : campaign_(campaign),
      model_(campaign, result.adjustment->model),
      base_prior_(result.adjustment->prior),
      reduced_(result.adjustment->reduced),
      smoothing_as_fitted_(result.adjustment->smoothing),
      stated_sigma_(result.adjustment->stated_sigma),
      outlier_critical_value_(result.outlier_critical_value) {
  model_.expand_effects(result.parameters);
  model_.set_second_order_remainder(result.parameters);
  views_ = setup_views(campaign_, model_.binding(), model_.chain());
  std::vector<bool> removed;
  for (const ResidualRecord& record : result.residuals) {
    if (record.removed && !record.left_out) removed_by_fit_.push_back(removed.size());
    removed.push_back(record.removed);
  }
  removed_ = removed_by_fit_;
  CampaignNoise noise = campaign_noise(model_, stated_sigma_, removed);
  observations_ = std::move(noise.places);
  noise_groups_ = std::move(noise.groups);
  problem_.data = std::move(noise.data);
  const DatumSpace datum(model_.layout(), campaign_.machine, result.parameters);
  linearise(model_, datum, result.parameters, observations_, problem_);
  problem_.local = std::make_shared<LocalRows>(local_rows(model_, datum, result.parameters, observations_));
  add_sensitivity(result.parameters);
  set_smoothing(smoothing_as_fitted_);
}

void LinearModel::set_smoothing(std::vector<SmoothingTerm> smoothing) {
  smoothing_ = std::move(smoothing);
  GaussianPrior prior = base_prior_;
  add_smoothing(smoothing_, prior);
  problem_.prior_precision = std::move(prior.precision);
  problem_.prior_mean = prior.mean - reduced_;
}

void LinearModel::smooth(const Eigen::MatrixXd& gram, std::size_t observations) {
  if (smoothing_.empty()) return;
  const Eigen::Index count = gram.rows() - 1, own = reduced_.size();
  const NoiseGroupEquations equations{gram.topLeftCorner(count, count), -gram.col(count).head(count),
                                      gram(count, count), static_cast<double>(observations)};
  Eigen::VectorXd from = Eigen::VectorXd::Zero(count);
  from.head(own) = reduced_;
  GaussianPrior prior = GaussianPrior::none(static_cast<int>(count));
  prior.precision.topLeftCorner(own, own) = base_prior_.precision;
  prior.mean.head(own) = base_prior_.mean;
  std::vector<SmoothingTerm> smoothing = smoothing_;
  maximise_evidence({equations}, from, prior, {.variance_components = false}, {1.0}, smoothing);
  set_smoothing(std::move(smoothing));
}

void LinearModel::add_sensitivity(const Eigen::VectorXd& parameters) {
  sensitivity_.resize(static_cast<Eigen::Index>(size()), kDisturbances);
  MeasurementModel::DisturbanceRows disturbance;
  for (std::size_t i = 0; i < size(); ++i) {
    const Observation& place = observations_[i];
    while (parts_.size() <= place.setup) parts_.push_back(static_cast<Eigen::Index>(i));
    if (place.channel == 0) model_.disturbance_rows(place.setup, place.row, parameters, disturbance);
    sensitivity_.row(static_cast<Eigen::Index>(i)) = disturbance.row(place.channel);
  }
  parts_.resize(campaign_.setups.size() + 1, static_cast<Eigen::Index>(size()));
}

std::size_t LinearModel::take_up(const std::function<bool(std::size_t)>& explained) {
  return std::erase_if(removed_, [&](std::size_t observation) {
    if (!explained(observation)) return false;
    problem_.data.sigma[observation] = stated_sigma_[observation];
    return true;
  });
}

void LinearModel::return_to_fit() {
  set_smoothing(smoothing_as_fitted_);
  removed_ = removed_by_fit_;
  for (const std::size_t observation : removed_) {
    problem_.data.sigma[observation] = std::numeric_limits<double>::infinity();
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

Eigen::VectorXd LinearModel::motion(ErrorSymbol symbol) const {
  return sensitivity_.col(disturbance_of({TargetKind::Motion, symbol, 0}, campaign_.machine));
}

NoiseData without(const NoiseData& data, const std::vector<bool>& left_out) {
  NoiseData reduced = data;
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    if (left_out[i]) reduced.sigma[i] = std::numeric_limits<double>::infinity();
  }
  return reduced;
}

}  // namespace volcal
