#include "volcal/identify/criticism/projection/linear_model.h"

#include <limits>
#include <memory>
#include <utility>

#include "volcal/identify/solve/adjustment.h"

namespace volcal {

LinearModel::Fixed::Fixed(const Campaign& of, const FitResult& result)
    : campaign(of),
      model(of, result.adjustment->model),
      base_prior(result.adjustment->prior),
      reduced(result.adjustment->reduced),
      stated_sigma(result.adjustment->stated_sigma),
      outlier_critical_value(result.outlier_critical_value) {
  model.expand_effects(result.parameters);
  model.set_second_order_remainder(result.parameters);
  views = setup_views(campaign, model.binding(), model.chain());
}

LinearModel::LinearModel(const Campaign& campaign, const FitResult& result) {
  const auto fixed = std::make_shared<Fixed>(campaign, result);
  std::vector<bool> removed;
  for (const ResidualRecord& record : result.residuals) {
    if (record.removed && !record.left_out) removed_.push_back(removed.size());
    removed.push_back(record.removed);
  }
  CampaignNoise noise = campaign_noise(fixed->model, fixed->stated_sigma, removed);
  fixed->observations = std::move(noise.places);
  fixed->noise_groups = std::move(noise.groups);
  const auto problem = std::make_shared<NoiseProblem>();
  problem->data = std::move(noise.data);
  const DatumSpace datum(fixed->model.layout(), campaign.machine, result.parameters);
  linearise(fixed->model, datum, result.parameters, fixed->observations, *problem);
  problem->local =
      std::make_shared<LocalRows>(local_rows(fixed->model, datum, result.parameters, fixed->observations));
  fixed->find_sensitivity(result.parameters);
  fixed_ = fixed;
  set_smoothing(result.adjustment->smoothing, problem);
}

void LinearModel::set_smoothing(std::vector<SmoothingTerm> smoothing,
                                const std::shared_ptr<NoiseProblem>& problem) {
  GaussianPrior prior = fixed_->base_prior;
  add_smoothing(smoothing, prior);
  problem->prior_precision = std::move(prior.precision);
  problem->prior_mean = prior.mean - fixed_->reduced;
  problem_ = problem;
  smoothing_ = std::move(smoothing);
}

LinearModel LinearModel::with_smoothing(std::vector<SmoothingTerm> smoothing) const {
  LinearModel other = *this;
  other.set_smoothing(std::move(smoothing), std::make_shared<NoiseProblem>(*problem_));
  return other;
}

LinearModel LinearModel::smoothed(const Eigen::MatrixXd& gram, std::size_t observations) const {
  if (smoothing_.empty()) return *this;
  const Eigen::Index count = gram.rows() - 1, own = fixed_->reduced.size();
  const NoiseGroupEquations equations{gram.topLeftCorner(count, count), -gram.col(count).head(count),
                                      gram(count, count), static_cast<double>(observations)};
  Eigen::VectorXd from = Eigen::VectorXd::Zero(count);
  from.head(own) = fixed_->reduced;
  GaussianPrior prior = GaussianPrior::none(static_cast<int>(count));
  prior.precision.topLeftCorner(own, own) = fixed_->base_prior.precision;
  prior.mean.head(own) = fixed_->base_prior.mean;
  std::vector<SmoothingTerm> smoothing = smoothing_;
  maximise_evidence({equations}, from, prior, {.variance_components = false}, {1.0}, smoothing);
  return with_smoothing(std::move(smoothing));
}

void LinearModel::Fixed::find_sensitivity(const Eigen::VectorXd& parameters) {
  const std::size_t size = observations.size();
  sensitivity.resize(static_cast<Eigen::Index>(size), kDisturbances);
  MeasurementModel::DisturbanceRows disturbance;
  for (std::size_t i = 0; i < size; ++i) {
    const Observation& place = observations[i];
    while (parts.size() <= place.setup) parts.push_back(static_cast<Eigen::Index>(i));
    if (place.channel == 0) model.disturbance_rows(place.setup, place.row, parameters, disturbance);
    sensitivity.row(static_cast<Eigen::Index>(i)) = disturbance.row(place.channel);
  }
  parts.resize(campaign.setups.size() + 1, static_cast<Eigen::Index>(size));
}

LinearModel LinearModel::with_reinstated(const std::vector<std::size_t>& observations) const {
  LinearModel other = *this;
  const auto problem = std::make_shared<NoiseProblem>(*problem_);
  for (const std::size_t observation : observations) {
    problem->data.sigma[observation] = stated_sigma()[observation];
    std::erase(other.removed_, observation);
  }
  other.problem_ = problem;
  return other;
}

void LinearModel::columns(const Effect& effect, const Eigen::VectorXd& shape, std::size_t setup,
                          Eigen::Ref<Eigen::MatrixXd> out) const {
  const auto& amplitudes = effect.amplitudes();
  const Eigen::Index first = parts()[setup], count = parts()[setup + 1] - first;
  const Eigen::MatrixXd drivers = effect.drivers(views()[setup], shape);
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const auto sensitivity = fixed_->sensitivity.col(disturbance_of(amplitudes[k].target, campaign().machine))
                                 .segment(first, count);
    if (drivers.rows() == count) {
      out.col(column) = drivers.col(column).cwiseProduct(sensitivity);
      continue;
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      const std::size_t row = observations()[static_cast<std::size_t>(first + i)].row;
      out(i, column) = drivers(static_cast<Eigen::Index>(row), column) * sensitivity[i];
    }
  }
}

Eigen::VectorXd LinearModel::direction(int which) const {
  if (which == 3) return fixed_->sensitivity.rightCols<kMaxChannels>().rowwise().sum();
  return -fixed_->sensitivity.col(kStationDisturbance + which);
}

Eigen::VectorXd LinearModel::motion(ErrorSymbol symbol) const {
  return fixed_->sensitivity.col(disturbance_of({TargetKind::Motion, symbol, 0}, campaign().machine));
}

NoiseData without(const NoiseData& data, const std::vector<bool>& left_out) {
  NoiseData reduced = data;
  for (std::size_t i = 0; i < left_out.size(); ++i) {
    if (left_out[i]) reduced.sigma[i] = std::numeric_limits<double>::infinity();
  }
  return reduced;
}

}  // namespace volcal
