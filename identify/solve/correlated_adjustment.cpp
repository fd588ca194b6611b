#include "volcal/identify/solve/correlated_adjustment.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr std::size_t kNoiseSample = 30000;
constexpr std::size_t kNoiseSetups = 300;  // each with parameters of its own
constexpr double kNegligibleStep = 1e-6;   // step^T (M + P) step: a thousandth of a standard deviation
constexpr int kRenewals = 4;               // of what the model holds fixed; then it stays, and steps contract
constexpr int kMostIterations = 50;  // the centre across its circle, held by a prior alone, settles slowly

NoiseGroupEquations sum_of(const std::vector<NoiseGroupEquations>& equations) {
  NoiseGroupEquations total = equations.front();
  for (std::size_t g = 1; g < equations.size(); ++g) {
    total.matrix += equations[g].matrix;
    total.gradient += equations[g].gradient;
    total.squares += equations[g].squares;
    total.observations += equations[g].observations;
  }
  return total;
}

}  // namespace

NoiseEstimate estimate_noise(const MeasurementModel& model, const DatumSpace& datum,
                             const CampaignNoise& noise, const Eigen::VectorXd& z, const GaussianPrior& prior,
                             const NoiseOptions& options, const NoiseEstimate* previous) {
  CampaignNoise sample = sampled(noise, kNoiseSample, kNoiseSetups);
  const bool is_all = sample.places.size() == noise.places.size();
  NoiseProblem problem;
  linearise(model, datum, datum.raw(z), sample.places, problem);
  problem.data = std::move(sample.data);
  problem.prior_precision = prior.precision;
  problem.prior_mean = prior.mean - z;
  if (!is_all) problem = without_unseen_nuisance(std::move(problem), model.layout(), datum);
  return estimate_noise(problem, options, previous);
}

bool is_more_than_white(const NoiseEstimate& estimate) {
  return std::ranges::any_of(estimate.instruments, [](const InstrumentNoise& instrument) {
    return instrument.drift.on || instrument.line.on || instrument.per_metre.on;
  });
}

std::vector<double> total_sigma(const NoiseData& noise, const std::vector<double>& stated_sigma,
                                const std::vector<NoiseParameters>& parameters) {
  std::vector<double> total(stated_sigma.size());
  for (const NoiseSequence& sequence : noise.sequences) {
    const NoiseParameters& own = parameters[sequence.group];
    const double drift = sequence.time.empty() ? 0.0 : own.drift;
    const double line = sequence.line.empty() ? 0.0 : own.line;
    for (const std::size_t i : sequence.observation) {
      const double white = own.white * stated_sigma[i];
      const double proportional = own.per_metre * noise.length[i];
      total[i] = std::sqrt(white * white + proportional * proportional + drift * drift + line * line);
    }
  }
  return total;
}

WhitenedCampaign::WhitenedCampaign(const MeasurementModel& model, const DatumSpace& datum,
                                   const CampaignNoise& noise, const std::vector<NoiseParameters>& parameters,
                                   int threads)
    : model_(model), datum_(datum), noise_(noise), whitener_(noise.data, parameters), threads_(threads) {}

/// Raw derivatives and the error (predicted minus reading) of observations, one column each.
void WhitenedCampaign::fill(const std::vector<std::size_t>& observations, const Eigen::VectorXd& raw,
                            const TabulatedFunctions& tabulated, Eigen::Ref<Eigen::MatrixXd> columns) const {
  const Eigen::Index last = columns.rows() - 1;
  columns.setZero();
  RowJacobian row;
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const auto [setup, reading, channel] = noise_.places[observations[k]];
    model_.linearize(setup, reading, raw, row, &tabulated);
    const auto column = static_cast<Eigen::Index>(k);
    for_each_derivative(model_.layout(), row, channel,
                        [&](int parameter, double derivative) { columns(parameter, column) += derivative; });
    columns(last, column) =
        row.predicted[channel] -
        model_.campaign().setups[setup].readings.value[static_cast<std::size_t>(channel)][reading];
  }
}

std::vector<NoiseGroupEquations> WhitenedCampaign::equations(const Eigen::VectorXd& z) const {
  const Eigen::VectorXd raw = datum_.raw(z);
  const TabulatedFunctions tabulated = model_.tabulate(raw);
  const Eigen::Index size = raw.size();
  std::vector<NoiseGroupEquations> equations;
  for (std::size_t group = 0; group < noise_.groups.size(); ++group) {
    const Whitener::GroupGram sums = whitener_.gram_of_group(
        group, size + 1,
        [&](const std::vector<std::size_t>& observations, Eigen::Ref<Eigen::MatrixXd> columns) {
          fill(observations, raw, tabulated, columns);
        },
        threads_);
    equations.push_back({datum_.reduce_matrix(sums.gram.topLeftCorner(size, size)),
                         datum_.reduce_gradient(sums.gram.col(size).head(size)), sums.gram(size, size),
                         static_cast<double>(sums.observations)});
  }
  return equations;
}

CorrelatedAdjustment adjust_correlated(const WhitenedCampaign& campaign, const GaussianPrior& prior,
                                       int evidence_rounds,
                                       const std::function<void(Eigen::VectorXd& z)>& renew,
                                       std::vector<SmoothingTerm>& terms, Eigen::VectorXd& z) {
  CorrelatedAdjustment result;
  int renewals = 0;
  while (!result.converged && result.iterations < kMostIterations) {
    const std::vector<NoiseGroupEquations> equations = campaign.equations(z);
    if (result.iterations < evidence_rounds && !terms.empty()) {
      const std::vector<double> unscaled(equations.size(), 1.0);
      maximise_evidence(equations, z, prior, {.variance_components = false, .threads = campaign.threads()},
                        unscaled, terms);
    }
    GaussianPrior total = prior;
    add_smoothing(terms, total);
    const NoiseGroupEquations sums = sum_of(equations);
    result.covariance = invert_precision(sums.matrix + total.precision).covariance;
    const Eigen::VectorXd gradient = sums.gradient + total.gradient(z);
    const Eigen::VectorXd step = -(result.covariance * gradient);
    z += step;
    if (renewals < kRenewals) {
      const Eigen::VectorXd before = z;
      renew(z);
      if (z == before) ++renewals;
    }
    ++result.iterations;
    result.squares = sums.squares + 2.0 * sums.gradient.dot(step) + step.dot(sums.matrix * step);
    result.redundancy = sums.observations - result.covariance.cwiseProduct(sums.matrix).sum();
    result.cost = 0.5 * result.squares + total.cost(z);
    result.converged = result.iterations >= evidence_rounds && -gradient.dot(step) < kNegligibleStep;
  }
  return result;
}

}  // namespace volcal
