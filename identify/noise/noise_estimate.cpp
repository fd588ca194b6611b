#include "volcal/identify/noise/noise_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "volcal/identify/noise/noise_search.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/statistics/normal.h"

namespace volcal {
namespace {

constexpr int kWhiteSteps = 8;
constexpr double kLeastRedundancy = 5.0;  // as for variance components
constexpr double kLeastFactor = 1e-6;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Shares of all instruments at their present parameters.
class Shares {
 public:
  explicit Shares(RestrictedLikelihood& likelihood) : likelihood_(likelihood), own_(likelihood.groups()) {}

  void set(std::size_t group, const NoiseParameters& noise) { own_[group] = likelihood_.share(group, noise); }
  const RestrictedLikelihood::Share& own(std::size_t group) const { return own_[group]; }
  RestrictedLikelihood::Share total() const {
    RestrictedLikelihood::Share sum = likelihood_.prior();
    for (const auto& share : own_) {
      sum.gram += share.gram;
      sum.log_determinant += share.log_determinant;
    }
    return sum;
  }
  Eigen::MatrixXd rest(std::size_t group) const {
    Eigen::MatrixXd sum = likelihood_.prior().gram;
    for (std::size_t other = 0; other < own_.size(); ++other) {
      if (other != group) sum += own_[other].gram;
    }
    return sum;
  }

 private:
  RestrictedLikelihood& likelihood_;
  std::vector<RestrictedLikelihood::Share> own_;
};

/// White factors alone: variance components (Foerstner 1979) from the sums at factor one.
void find_white(RestrictedLikelihood& likelihood, std::vector<InstrumentNoise>& instruments,
                std::vector<double>& taken, Eigen::VectorXd& solution) {
  const Eigen::Index p = likelihood.variables();
  std::vector<Eigen::MatrixXd> gram;
  for (std::size_t g = 0; g < instruments.size(); ++g) {
    instruments[g].observations = likelihood.group_data(g).sigma.size();
    gram.push_back(likelihood.share(g, {}).gram);
  }
  for (int step = 0; step < kWhiteSteps; ++step) {
    Eigen::MatrixXd total = likelihood.prior().gram;
    for (std::size_t g = 0; g < gram.size(); ++g)
      total += gram[g] / (instruments[g].parameters.white * instruments[g].parameters.white);
    solution = RestrictedLikelihood::solve(total).at;
    Eigen::MatrixXd covariance(p, p);
    if (p > 0) {
      const auto lower = cholesky_lower(total.topLeftCorner(p, p));
      covariance = lower ? inverse_from_cholesky(*lower) : Eigen::MatrixXd::Zero(p, p);
    }
    Eigen::VectorXd one(p + 1);
    one << solution, -1.0;
    double change = 0.0;
    for (std::size_t g = 0; g < gram.size(); ++g) {
      double& white = instruments[g].parameters.white;
      taken[g] = covariance.cwiseProduct(gram[g].topLeftCorner(p, p)).sum() / (white * white);
      instruments[g].redundancy = static_cast<double>(instruments[g].observations) - taken[g];
      instruments[g].estimated = instruments[g].redundancy >= kLeastRedundancy;
      if (!instruments[g].estimated) continue;
      const double before = white;
      const double squares = std::max(one.dot(gram[g] * one), 0.0);
      white = std::max(std::sqrt(squares / instruments[g].redundancy), kLeastFactor);
      change = std::max(change, std::abs(std::log(white / before)));
    }
    if (change < 1e-3) break;
  }
}

std::string remark(const TermEvidence& evidence, const std::string& missing) {
  if (evidence.on) return "";
  return evidence.possible ? "off: not supported by the readings" : "off: " + missing;
}

NoiseRow row(std::size_t instrument, std::string term, std::string unit, double value, double log_uncertainty,
             double likelihood_ratio, std::string text) {
  const double factor = std::exp(kCoverageFactor * log_uncertainty);
  return {instrument,     std::move(term), std::move(unit),  value,
          value / factor, value * factor,  likelihood_ratio, std::move(text)};
}

}  // namespace

std::vector<NoiseParameters> NoiseEstimate::parameters() const {
  std::vector<NoiseParameters> result;
  for (const InstrumentNoise& instrument : instruments) result.push_back(instrument.parameters);
  return result;
}

namespace {

/// `held`: of the model that the problem holds no columns of.
NoiseEstimate find_noise(RestrictedLikelihood& likelihood, const NoiseOptions& options,
                         const NoiseEstimate* previous, const NoiseEstimate* held) {
  NoiseEstimate estimate;
  estimate.instruments.resize(likelihood.groups());
  for (InstrumentNoise& instrument : estimate.instruments)
    instrument.log_uncertainty = {kNone, kNone, kNone, kNone, kNone};
  std::vector<double> taken(likelihood.groups());
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(likelihood.variables());
  find_white(likelihood, estimate.instruments, taken, solution);

  Shares shares(likelihood);
  std::vector<double> white;
  for (std::size_t g = 0; g < likelihood.groups(); ++g) {
    white.push_back(estimate.instruments[g].parameters.white);
    shares.set(g, estimate.instruments[g].parameters);
  }
  if (previous != nullptr && likelihood.groups() > 1) {
    for (std::size_t g = 0; g < likelihood.groups(); ++g) shares.set(g, previous->instruments[g].parameters);
  }
  const int rounds = likelihood.groups() > 1 ? 2 : 1;
  for (int round = 0; round < rounds; ++round) {
    NoiseOptions of_round = options;
    of_round.uncertainty = options.uncertainty && round + 1 == rounds;
    for (std::size_t g = 0; g < likelihood.groups(); ++g) {
      InstrumentNoise& instrument = estimate.instruments[g];
      if (!instrument.estimated) continue;
      const InstrumentNoise before = round > 0 || previous == nullptr ? instrument : previous->instruments[g];
      NoiseSearch search(likelihood, g, of_round, shares.rest(g), solution, white[g], taken[g]);
      if (held != nullptr) search.hold(held->instruments[g].start);
      search.run(instrument, before);
      estimate.evaluations += search.evaluations();
      shares.set(g, instrument.parameters);
      solution = RestrictedLikelihood::solve(shares.total().gram).at;
    }
  }
  estimate.log_likelihood = likelihood.log_likelihood(shares.total());
  estimate.coefficients = likelihood.coefficients(solution);
  return estimate;
}

}  // namespace

NoiseEstimate estimate_noise(const NoiseProblem& problem, const NoiseOptions& options,
                             const NoiseEstimate* previous) {
  RestrictedLikelihood likelihood(problem, options.threads);
  return find_noise(likelihood, options, previous, nullptr);
}

NoiseEstimate estimate_noise(RestrictedLikelihood& likelihood, const NoiseOptions& options,
                             const NoiseEstimate* previous) {
  return find_noise(likelihood, options, previous, nullptr);
}

double nearby_log_likelihood(RestrictedLikelihood& likelihood, const NoiseOptions& options,
                             const NoiseEstimate& previous) {
  std::vector<InstrumentNoise> instruments(likelihood.groups());
  std::vector<double> taken(likelihood.groups());
  Eigen::VectorXd solution = Eigen::VectorXd::Zero(likelihood.variables());
  find_white(likelihood, instruments, taken, solution);
  Shares shares(likelihood);
  for (std::size_t g = 0; g < likelihood.groups(); ++g) shares.set(g, previous.instruments[g].parameters);
  double gain = 0.0;
  for (std::size_t g = 0; g < likelihood.groups(); ++g) {
    if (!instruments[g].estimated || previous.instruments[g].start.at.size() == 0) continue;
    NoiseSearch search(likelihood, g, options, shares.rest(g), solution, instruments[g].parameters.white,
                       taken[g]);
    const auto nearby = search.nearby_maximum(previous.instruments[g]);
    gain += nearby.gain;
    shares.set(g, nearby.parameters);
    solution = RestrictedLikelihood::solve(shares.total().gram).at;
  }
  return likelihood.log_likelihood(shares.total()) + 0.5 * gain;
}

NoiseEstimate readjust_noise(const NoiseProblem& problem, const NoiseOptions& options,
                             const NoiseEstimate& before) {
  RestrictedLikelihood likelihood(problem, options.threads);
  NoiseEstimate found = find_noise(likelihood, options, &before, &before);
  found.log_likelihood = kNone;
  return found;
}

std::vector<NoiseRow> noise_table(const NoiseEstimate& estimate) {
  std::vector<NoiseRow> rows;
  for (std::size_t g = 0; g < estimate.instruments.size(); ++g) {
    const InstrumentNoise& own = estimate.instruments[g];
    const NoiseParameters& value = own.parameters;
    const NoiseParameters& u = own.log_uncertainty;
    rows.push_back(row(g, "white", "1", value.white, u.white, kNone,
                       own.estimated ? "" : "stated: too few redundant readings"));
    const std::string drift = remark(own.drift, "no times, or too few readings");
    rows.push_back(row(g, "wander", "m or rad", value.drift, u.drift, own.drift.likelihood_ratio, drift));
    rows.push_back(
        row(g, "tau", "s", own.drift.on ? value.tau : 0.0, u.tau, own.drift.likelihood_ratio, drift));
    rows.push_back(row(g, "line", "m or rad", value.line, u.line, own.line.likelihood_ratio,
                       remark(own.line, "no lines of several readings")));
    rows.push_back(row(g, "per_metre", "m/m", value.per_metre, u.per_metre, own.per_metre.likelihood_ratio,
                       remark(own.per_metre, "no different lengths")));
  }
  return rows;
}

}  // namespace volcal
