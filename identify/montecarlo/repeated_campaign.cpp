#include "volcal/identify/montecarlo/repeated_campaign.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "volcal/identify/montecarlo/counter_random.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kNoEigenvalue = 1e-12;  // of the largest

/// Root of a positive semidefinite covariance, columns of the eigenvalues that are not zero.
Eigen::MatrixXd covariance_root(const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return Eigen::MatrixXd(0, 0);
  const SymmetricEigen eigen = eigen_decomposition(covariance);
  const double floor = kNoEigenvalue * std::max(eigen.values.tail(1).value(), 0.0);
  const auto kept = static_cast<Eigen::Index>((eigen.values.array() > floor).count());
  return eigen.vectors.rightCols(kept) * eigen.values.tail(kept).cwiseSqrt().asDiagonal();
}

/// Root of a covariance whose diagonal spans many orders (rad, m, 1): that of its correlations, scaled back.
Eigen::MatrixXd scaled_covariance_root(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = (scale.array() > 0.0).select(scale.cwiseInverse(), 0.0);
  return scale.asDiagonal() * covariance_root(inverse.asDiagonal() * covariance * inverse.asDiagonal());
}

/// Of what is stated to the fit of everything but the error functions; each parameter by itself.
Eigen::VectorXd stated_precision(const DatumSpace& datum, const Eigen::MatrixXd& precision) {
  Eigen::VectorXd stated = Eigen::VectorXd::Zero(precision.rows());
  for (const auto& block : datum.blocks())
    stated.segment(block.offset, block.size) = precision.diagonal().segment(block.offset, block.size);
  return stated;
}

}  // namespace

RepeatedCampaign::RepeatedCampaign(const Campaign& campaign, const FitResult& result, DrawnSources sources)
    : result_(result),
      sources_(std::move(sources)),
      linear_(campaign, result),
      datum_(linear_.model().layout(), campaign.machine, result.parameters),
      identified_(result.adjustment->reduced),
      noise_(fitted_noise(result, linear_.noise_groups())),
      whitener_(linear_.problem().data, noise_),
      sampler_(linear_.problem().data, noise_) {
  require_determined();
  const NoiseProblem& problem = linear_.problem();
  predicted_.resize(problem.residual.size());
  for (std::size_t i = 0; i < linear_.size(); ++i) {
    const ObservationPlace& place = linear_.observations()[i];
    const auto index = static_cast<Eigen::Index>(i);
    const Readings& readings = campaign.setups[place.setup].readings;
    predicted_[index] =
        readings.value[static_cast<std::size_t>(place.channel)][place.row] - problem.residual[index];
  }
  whitener_.whiten(problem.jacobian.whole(), whitened_, 1);
  const auto factor = cholesky_lower(whitened_.transpose() * whitened_ + problem.prior_precision);
  if (!factor) throw std::runtime_error("the normal matrix is not positive definite");
  gain_ = inverse_from_cholesky(*factor);
  set_statements();
  add_disturbances();
  list_sources();
  set_linear_propagation();
}

void RepeatedCampaign::require_determined() const {
  if (result_.status != FitStatus::RankDeficient) return;
  const std::string which =
      result_.rank.invisible.empty() ? "" : ": " + sentence(result_.rank.invisible.front());
  throw InputError({linear_.campaign().file, 0}, "the readings do not determine every error" + which,
                   "measure what volcal fit names, or switch the error off in the model "
                   "(EAX = { basis = \"zero\" }), and draw again");
}

void RepeatedCampaign::set_statements() {
  stated_ = stated_precision(datum_, result_.adjustment->prior.precision);
  fixed_statement_ = Eigen::VectorXd::Zero(parameters());
  roughness_root_.resize(parameters(), 0);
  if (draws_functions()) {
    Eigen::MatrixXd of_functions = prior_precision();
    of_functions.diagonal() -= stated_;
    roughness_root_ = scaled_covariance_root(gain_ * of_functions * gain_ +
                                             amplitude_covariance(linear_.smoothing(), gain_, identified_));
    return;
  }
  for (const SmoothingTerm& term : linear_.smoothing()) {
    const Eigen::Index size = term.precision().rows();
    fixed_statement_.segment(term.offset, size) = -identified_.segment(term.offset, size);
  }
}

void RepeatedCampaign::add_disturbances() {
  std::vector<Eigen::MatrixXd> parts;
  Eigen::Index columns = 0;
  for (const Disturbance& disturbance : sources_.disturbances) {
    const EffectKind* kind = find_effect(disturbance.effect.kind);
    if (kind == nullptr) throw std::invalid_argument("there is no effect " + disturbance.effect.kind);
    const auto effect = kind->make(disturbance.effect, {});
    effect->check(linear_.campaign(), {linear_.campaign().file, 0});
    const auto amplitudes = static_cast<Eigen::Index>(effect->amplitudes().size());
    Eigen::MatrixXd& part = parts.emplace_back(observations(), amplitudes);
    for (std::size_t setup = 0; setup + 1 < linear_.parts().size(); ++setup) {
      const Eigen::Index first = linear_.parts()[setup], count = linear_.parts()[setup + 1] - first;
      linear_.columns(*effect, effect->shape_values(), setup, part.middleRows(first, count));
    }
    disturbance_sigma_.insert(disturbance_sigma_.end(), effect->amplitudes().size(), disturbance.sigma);
    disturbance_shape_.insert(disturbance_shape_.end(), effect->amplitudes().size(), disturbance.shape);
    amplitudes_.push_back(amplitudes);
    columns += amplitudes;
  }
  disturbance_columns_.resize(observations(), columns);
  Eigen::Index column = 0;
  for (const Eigen::MatrixXd& part : parts) {
    disturbance_columns_.middleCols(column, part.cols()) = part;
    column += part.cols();
  }
}

/// Of each instrument: C J_g^T Sigma_g^-1 J_g C, instruments being independent.
void RepeatedCampaign::list_noise() {
  const std::vector<NoiseSequence>& sequences = linear_.problem().data.sequences;
  for (std::size_t group = 0; group < linear_.noise_groups().size(); ++group) {
    std::vector<Eigen::Index> rows;
    for (const NoiseSequence& sequence : sequences) {
      if (sequence.group == group)
        rows.insert(rows.end(), sequence.observation.begin(), sequence.observation.end());
    }
    const Eigen::MatrixXd own = whitened_(rows, Eigen::all);
    uncertainty_sources_.push_back(
        {"noise of " + linear_.noise_groups()[group], gain_ * scaled_covariance_root(own.transpose() * own)});
  }
}

void RepeatedCampaign::list_statements() {
  for (const auto& block : datum_.blocks()) {
    const Eigen::VectorXd stated = stated_.segment(block.offset, block.size);
    if (stated.isZero(0.0)) continue;
    uncertainty_sources_.push_back(
        {"prior of " + linear_.model().layout().blocks[block.block].name,
         gain_.middleCols(block.offset, block.size) * stated.cwiseSqrt().asDiagonal()});
  }
}

void RepeatedCampaign::list_sources() {
  list_noise();
  list_statements();
  if (draws_functions())
    uncertainty_sources_.push_back({"roughness of the error functions", roughness_root_});
  Eigen::MatrixXd whitened_columns;
  whitener_.whiten(disturbance_columns_, whitened_columns, 1);
  const Eigen::Map<const Eigen::VectorXd> sigma(disturbance_sigma_.data(), disturbance_columns_.cols());
  disturbance_response_ = gain_ * (whitened_.transpose() * whitened_columns) * sigma.asDiagonal();
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < sources_.disturbances.size(); ++i) {
    uncertainty_sources_.push_back(
        {sources_.disturbances[i].words, disturbance_response_.middleCols(column, amplitudes_[i])});
    column += amplitudes_[i];
  }
}

void RepeatedCampaign::set_linear_propagation() {
  bias_ = gain_ * (prior_precision() * fixed_statement_);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(parameters(), parameters());
  for (const UncertaintySource& source : uncertainty_sources_)
    covariance += source.root * source.root.transpose();
  std::vector<Eigen::Index> rectangular;
  for (Eigen::Index k = 0; k < disturbance_response_.cols(); ++k) {
    if (disturbance_shape_[static_cast<std::size_t>(k)] == DistributionShape::Rectangular)
      rectangular.push_back(k);
  }
  rectangular_response_ = disturbance_response_(Eigen::all, rectangular);
  covariance -= rectangular_response_ * rectangular_response_.transpose();
  root_ = scaled_covariance_root(0.5 * (covariance + covariance.transpose()));
}

namespace {

/// Uniform on (0, 1] to a rectangular distribution of standard deviation 1.
double rectangular_from(double uniform) { return std::numbers::sqrt3 * (2.0 * uniform - 1.0); }

std::span<double> span_of(Eigen::Ref<Eigen::VectorXd> values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

}  // namespace

void RepeatedCampaign::draw_linear(std::uint64_t seed, std::uint64_t first,
                                   Eigen::Ref<Eigen::MatrixXd> normals,
                                   Eigen::Ref<Eigen::MatrixXd> amplitudes) const {
  for (Eigen::Index k = 0; k < normals.cols(); ++k) {
    const std::uint64_t number = first + static_cast<std::uint64_t>(k);
    CounterRandom(seed, number, RandomSource::Parameters).normals(span_of(normals.col(k)));
    if (amplitudes.rows() == 0) continue;
    CounterRandom(seed, number, RandomSource::Disturbances).uniforms(span_of(amplitudes.col(k)));
    amplitudes.col(k) = amplitudes.col(k).unaryExpr(&rectangular_from);
  }
}

std::vector<CampaignDraw> RepeatedCampaign::draws(std::uint64_t seed, std::uint64_t first,
                                                  Eigen::Index count) const {
  std::vector<CampaignDraw> draws;
  Eigen::MatrixXd normals(roughness_root_.cols(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::uint64_t number = first + static_cast<std::uint64_t>(k);
    draws.push_back(readings_and_statements(seed, number));
    CounterRandom(seed, number, RandomSource::Roughness).normals(span_of(normals.col(k)));
  }
  const Eigen::MatrixXd roughness = product(roughness_root_, normals);
  for (Eigen::Index k = 0; k < count; ++k) draws[static_cast<std::size_t>(k)].roughness = roughness.col(k);
  return draws;
}

CampaignDraw RepeatedCampaign::draw(std::uint64_t seed, std::uint64_t number) const {
  return std::move(draws(seed, number, 1).front());
}

/// A draw without its roughness.
CampaignDraw RepeatedCampaign::readings_and_statements(std::uint64_t seed, std::uint64_t number) const {
  CampaignDraw draw{Eigen::VectorXd(observations()), fixed_statement_, {}};
  sampler_.draw(seed, number, span_of(draw.errors));
  Eigen::VectorXd normal(parameters());
  CounterRandom(seed, number, RandomSource::Statements).normals(span_of(normal));
  draw.statement.array() += (stated_.array() > 0.0).select(normal.array() * stated_.array().rsqrt(), 0.0);
  if (disturbance_sigma_.empty()) return draw;
  const std::size_t count = disturbance_sigma_.size();
  std::vector<double> uniform(count), normals(count);
  const CounterRandom random(seed, number, RandomSource::Disturbances);
  random.uniforms(uniform);
  random.normals(normals);
  for (std::size_t k = 0; k < count; ++k) {
    const double standard =
        disturbance_shape_[k] == DistributionShape::Normal ? normals[k] : rectangular_from(uniform[k]);
    draw.errors += disturbance_sigma_[k] * standard * disturbance_columns_.col(static_cast<Eigen::Index>(k));
  }
  return draw;
}

Eigen::MatrixXd RepeatedCampaign::linear_estimates(const std::vector<CampaignDraw>& draws) const {
  const auto count = static_cast<Eigen::Index>(draws.size());
  Eigen::MatrixXd errors(observations(), count), gradient = Eigen::MatrixXd::Zero(parameters(), count);
  Eigen::MatrixXd statements(parameters(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    errors.col(k) = draws[static_cast<std::size_t>(k)].errors;
    statements.col(k) = draws[static_cast<std::size_t>(k)].statement;
  }
  whitener_.whiten(errors, errors, 1);
  add_transposed_product(whitened_, errors, gradient);
  gradient += product(prior_precision(), statements);
  return product(gain_, gradient);
}

}  // namespace volcal
