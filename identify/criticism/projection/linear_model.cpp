#include "volcal/identify/criticism/projection/linear_model.h"

#include <array>
#include <limits>
#include <memory>
#include <utility>

#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/solve/priors/evidence.h"

namespace volcal {

LinearModel::Fixed::Fixed(const Campaign& of, const FitResult& result)
    : campaign(of),
      model(of, result.adjustment->model),
      stated_sigma(result.adjustment->stated_sigma),
      outlier_critical_value(result.outlier_critical_value) {
  model.expand_effects(result.parameters);
  model.set_second_order_remainder(result.parameters);
  views = setup_views(campaign, model.binding(), model.chain());
  for (const Axis& axis : campaign.machine.axes)
    measured[index_of(axis.name)] = measured_range(campaign, axis.name);
}

namespace {

std::vector<bool> removed_by(const FitResult& result) {
  std::vector<bool> removed;
  for (const ResidualRecord& record : result.residuals) removed.push_back(record.removed);
  return removed;
}

}  // namespace

LinearModel::LinearModel(const Campaign& campaign, const FitResult& result)
    : LinearModel(campaign, result, nullptr) {}

LinearModel::LinearModel(const Campaign& campaign, const FitResult& result,
                         const std::vector<std::size_t>& chosen)
    : LinearModel(campaign, result, &chosen) {}

LinearModel::LinearModel(const Campaign& campaign, const FitResult& result,
                         const std::vector<std::size_t>* chosen)
    : base_prior_(result.adjustment->prior), reduced_(result.adjustment->reduced) {
  const auto fixed = std::make_shared<Fixed>(campaign, result);
  CampaignNoise noise = campaign_noise(fixed->model, fixed->stated_sigma, removed_by(result));
  if (chosen) {
    noise = restricted(noise, *chosen);
    fixed->stated_sigma.clear();
    for (const std::size_t i : *chosen) fixed->stated_sigma.push_back(result.adjustment->stated_sigma[i]);
  }
  for (std::size_t i = 0; i < noise.places.size(); ++i) {
    const ResidualRecord& record = result.residuals[chosen ? (*chosen)[i] : i];
    if (record.removed && !record.left_out) removed_.push_back(i);
  }
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
  GaussianPrior prior = base_prior_;
  add_smoothing(smoothing, prior);
  problem->prior_precision = std::move(prior.precision);
  problem->prior_mean = prior.mean - reduced_;
  problem_ = problem;
  smoothing_ = std::move(smoothing);
}

LinearModel LinearModel::with_smoothing(std::vector<SmoothingTerm> smoothing) const {
  LinearModel other = *this;
  other.set_smoothing(std::move(smoothing), std::make_shared<NoiseProblem>(*problem_));
  return other;
}

GaussianPrior LinearModel::base_prior_of(Eigen::Index size) const {
  const Eigen::Index own = reduced_.size();
  GaussianPrior prior = GaussianPrior::none(static_cast<int>(size));
  prior.precision.topLeftCorner(own, own) = base_prior_.precision;
  prior.mean.head(own) = base_prior_.mean;
  return prior;
}

Eigen::VectorXd LinearModel::reduced_of(Eigen::Index size) const {
  Eigen::VectorXd reduced = Eigen::VectorXd::Zero(size);
  reduced.head(reduced_.size()) = reduced_;
  return reduced;
}

LinearModel LinearModel::smoothed(const Eigen::MatrixXd& gram, std::size_t observations, int threads) const {
  if (smoothing_.empty()) return *this;
  const Eigen::Index count = gram.rows() - 1;
  const NoiseGroupEquations equations{gram.topLeftCorner(count, count), -gram.col(count).head(count),
                                      gram(count, count), static_cast<double>(observations)};
  std::vector<SmoothingTerm> smoothing = smoothing_;
  maximise_evidence({equations}, reduced_of(count), base_prior_of(count),
                    {.variance_components = false, .threads = threads}, {1.0}, smoothing);
  return with_smoothing(std::move(smoothing));
}

LinearModel LinearModel::with_surface(const Effect& effect) const {
  LinearModel other = *this;
  const Eigen::Index before = reduced_.size(), count = static_cast<Eigen::Index>(effect.amplitudes().size());
  other.base_prior_ = base_prior_of(before + count);
  other.reduced_ = reduced_of(before + count);
  const auto problem = std::make_shared<NoiseProblem>(*problem_);
  problem->jacobian.edit([&](Eigen::MatrixXd& jacobian) {
    jacobian.conservativeResize(Eigen::NoChange, before + count);
    for (std::size_t setup = 0; setup + 1 < parts().size(); ++setup) {
      const Eigen::Index first = parts()[setup], rows = parts()[setup + 1] - first;
      columns(effect, effect.shape_values(), setup, jacobian.block(first, before, rows, count));
    }
  });
  std::vector<SmoothingTerm> smoothing = smoothing_;
  smoothing.push_back(surface_term(*effect.surface(), static_cast<int>(before)));
  other.set_smoothing(std::move(smoothing), problem);
  return other;
}

LinearModel LinearModel::without_surface(std::size_t term) const {
  LinearModel other = *this;
  const int first = smoothing_[term].offset, count = static_cast<int>(smoothing_[term].precision().rows());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < reduced_.size(); ++i) {
    if (i < first || i >= first + count) kept.push_back(i);
  }
  other.base_prior_.precision = base_prior_.precision(kept, kept);
  other.base_prior_.mean = base_prior_.mean(kept);
  other.reduced_ = reduced_(kept);
  const auto problem = std::make_shared<NoiseProblem>(*problem_);
  problem->jacobian = problem_->jacobian(Eigen::all, kept).eval();
  std::vector<SmoothingTerm> smoothing = smoothing_;
  smoothing.erase(smoothing.begin() + static_cast<std::ptrdiff_t>(term));
  for (SmoothingTerm& each : smoothing) {
    if (each.offset > first) each.offset -= count;
  }
  other.set_smoothing(std::move(smoothing), problem);
  return other;
}

LinearModel LinearModel::with_imitated_left_to_the_rest(const Eigen::MatrixXd& gram) const {
  const Eigen::Index count = gram.rows() - 1;
  std::vector<SmoothingTerm> smoothing = smoothing_;
  leave_imitated_to_the_rest(gram.topLeftCorner(count, count), base_prior_of(count), smoothing);
  return with_smoothing(std::move(smoothing));
}

Eigen::VectorXd LinearModel::imitated_unless_smoothed(const Eigen::MatrixXd& gram, std::size_t term,
                                                      const Eigen::MatrixXd& functions) const {
  const Eigen::Index count = gram.rows() - 1;
  return volcal::imitated_unless_smoothed(gram.topLeftCorner(count, count), base_prior_of(count), smoothing_,
                                          term, functions);
}

Eigen::VectorXd LinearModel::exact_residual_at(const Eigen::VectorXd& correction) const {
  MeasurementModel exact(campaign(), model().spec());
  const DatumSpace datum(exact.layout(), campaign().machine, exact.initial_parameters());
  const Eigen::VectorXd parameters = datum.raw((reduced_ + correction).head(datum.size()));
  exact.expand_effects(parameters);
  exact.set_second_order_remainder(parameters);
  Eigen::VectorXd residual = problem_->jacobian * correction;
  std::array<double, kMaxChannels> predicted{};
  for (std::size_t i = 0; i < size(); ++i) {
    const Observation& place = observations()[i];
    const Readings& readings = campaign().setups[place.setup].readings;
    if (i == 0 || place.row != observations()[i - 1].row || place.setup != observations()[i - 1].setup)
      exact.predict(place.setup, place.row, parameters, predicted.data());
    const auto channel = static_cast<std::size_t>(place.channel);
    residual[static_cast<Eigen::Index>(i)] += readings.value[channel][place.row] - predicted[channel];
  }
  return residual;
}

LinearModel LinearModel::with_residual(Eigen::VectorXd residual) const {
  const auto problem = std::make_shared<NoiseProblem>(*problem_);
  problem->residual = std::move(residual);
  LinearModel other = *this;
  other.problem_ = problem;
  return other;
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

namespace {

/// Of every observation of a setup: its row's drivers, a column for each term.
Eigen::MatrixXd drivers_of_observations(const LinearModel& model, const Effect& effect,
                                        const Eigen::VectorXd& shape, std::size_t setup) {
  Eigen::MatrixXd of_rows = effect.drivers(model.views()[setup], shape);
  const Eigen::Index first = model.parts()[setup], count = model.parts()[setup + 1] - first;
  if (of_rows.rows() == count) return of_rows;
  Eigen::MatrixXd drivers(count, of_rows.cols());
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t row = model.observations()[static_cast<std::size_t>(first + i)].row;
    drivers.row(i) = of_rows.row(static_cast<Eigen::Index>(row));
  }
  return drivers;
}

}  // namespace

void LinearModel::columns(const Effect& effect, const Eigen::VectorXd& shape, std::size_t setup,
                          Eigen::Ref<Eigen::MatrixXd> out) const {
  const std::vector<EffectTerm> terms = effect.terms();
  const Eigen::MatrixXd drivers = drivers_of_observations(*this, effect, shape, setup);
  out.setZero();
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const auto sensitivity = fixed_->sensitivity.col(disturbance_of(terms[k].target, campaign().machine));
    out.col(static_cast<Eigen::Index>(terms[k].amplitude)) +=
        drivers.col(static_cast<Eigen::Index>(k))
            .cwiseProduct(sensitivity.segment(parts()[setup], drivers.rows()));
  }
}

void LinearModel::add_products(const Effect& effect, const Eigen::VectorXd& shape, std::size_t setup,
                               const Eigen::Ref<const Eigen::MatrixXd>& rows,
                               Eigen::Ref<Eigen::MatrixXd> sum) const {
  const std::vector<EffectTerm> terms = effect.terms();
  const Eigen::MatrixXd drivers = drivers_of_observations(*this, effect, shape, setup);
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const auto sensitivity = fixed_->sensitivity.col(disturbance_of(terms[k].target, campaign().machine));
    const auto moved = drivers.col(static_cast<Eigen::Index>(k))
                           .cwiseProduct(sensitivity.segment(parts()[setup], drivers.rows()));
    for (Eigen::Index column = 0; column < rows.cols(); ++column)
      sum(static_cast<Eigen::Index>(terms[k].amplitude), column) += moved.dot(rows.col(column));
  }
}

Eigen::VectorXd LinearModel::direction(ScanDirection direction) const {
  if (direction == ScanDirection::Beam) return fixed_->sensitivity.rightCols<kMaxChannels>().rowwise().sum();
  return -fixed_->sensitivity.col(kStationDisturbance + static_cast<int>(index_of(direction)));
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
