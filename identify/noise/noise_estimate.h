#pragma once
/// Noise model of a campaign by restricted maximum likelihood (restricted_likelihood.h).
///
/// Per instrument: white, correlated drift, tau, line and per_metre. Starts come from the variance and
/// the half squared differences of successive readings (or of returns to the same point) and a grid of tau;
/// the search then alternates between a function that costs one whitened column, -2 l with the correction x
/// held and log|J^T Sigma^-1 J + P| linear, and the exact value. Terms are dropped one by
/// one, the least supported first, while 2 (l - l without) stays below a threshold; white noise stays white.
/// Several instruments are taken in turn, the others held, twice.

#include <array>
#include <string>
#include <vector>

#include "volcal/identify/noise/restricted_likelihood.h"

namespace volcal {

struct NoiseOptions {
  bool drift = true;
  bool line = true;
  bool per_metre = true;
  /// 2 (l - l without) that a term must reach. A variance at its bound 0 follows 1/2 chi2_0 + 1/2 chi2_1
  /// (Self and Liang 1987, JASA 82, 605): 4 keeps 2.3 % of terms that are not there. The correlated drift has
  /// a tau that is free without it (Davies 1987, Biometrika 74, 33) and needs more.
  double threshold = 4.0;
  double drift_threshold = 7.0;
  bool uncertainty = true;  ///< of the parameters; costs as much as a search that starts near its end
  int threads = 1;
};

struct TermEvidence {
  bool possible =
      false;  ///< the data can speak about it: times, lines of several readings, different lengths
  bool on = false;
  /// 2 (l - l without), or, for a term that was dropped, what it would have added. Above 30 an upper bound:
  /// the likelihood without was then not maximised to the end.
  double likelihood_ratio = 0.0;
  double threshold = 0.0;
};

/// Where a search ended, in its own variables (noise_search.h): the search of nearly the same problem begins
/// there.
struct NoiseStart {
  Eigen::VectorXd at;
  Eigen::VectorXd slope;
  std::array<bool, 3> active{};
  double scale = 0.0;
};

struct InstrumentNoise {
  NoiseParameters parameters;
  /// Standard uncertainties of the logarithms from the second derivatives of l, 3 where it says nothing; NaN:
  /// off.
  NoiseParameters log_uncertainty;
  /// Covariance of the same logarithms, in the order white, correlated drift, tau, line, per_metre; 0 where
  /// off.
  Eigen::Matrix<double, 5, 5> log_covariance = Eigen::Matrix<double, 5, 5>::Zero();
  TermEvidence drift;
  TermEvidence line;
  TermEvidence per_metre;
  std::size_t observations = 0;
  double redundancy = 0.0;  ///< observations minus what the linear model takes, white noise
  bool estimated = true;    ///< false: too few redundant observations, stated sigma kept
  NoiseStart start;
};

struct NoiseEstimate {
  std::vector<InstrumentNoise> instruments;  ///< per group
  double log_likelihood = 0.0;               ///< restricted
  Eigen::VectorXd coefficients;              ///< x at the estimate
  int evaluations = 0;                       ///< of the exact likelihood

  std::vector<NoiseParameters> parameters() const;
};

/// `previous`: estimate for nearly the same problem (the same observations, a few columns more or less). The
/// search then begins at its end, and over again when a term comes or goes or the residuals have another
/// size, since the likelihood has several maxima; evidence that was overwhelming is kept as it was.
NoiseEstimate estimate_noise(const NoiseProblem& problem, const NoiseOptions& options = {},
                             const NoiseEstimate* previous = nullptr);

/// The same of the residuals that `likelihood` holds, whose problem stays with the caller.
NoiseEstimate estimate_noise(RestrictedLikelihood& likelihood, const NoiseOptions& options = {},
                             const NoiseEstimate* previous = nullptr);

/// Log restricted likelihood of the maximum next to the noise `previous`, or to the same with little
/// correlated drift, and with what one term more adds there: what estimate_noise() will not exceed by much
/// unless it finds another maximum. In a tenth of its time.
double nearby_log_likelihood(RestrictedLikelihood& likelihood, const NoiseOptions& options,
                             const NoiseEstimate& previous);

/// estimate_noise() in milliseconds, once little is added to the model of `before`. `problem` holds what is
/// added alone, its columns after projection off that model, and the residuals of all. That model's own
/// solution is held but for what it gives up to these columns, and its log information is linear from the
/// noise of `before`; without likelihoods. The observations must be the same.
NoiseEstimate readjust_noise(const NoiseProblem& problem, const NoiseOptions& options,
                             const NoiseEstimate& before);

/// One line of a table of the result, SI.
struct NoiseRow {
  std::size_t instrument = 0;
  std::string term;    ///< "white", "wander", "tau", "line", "per_metre"
  std::string unit;    ///< "1", "m or rad", "s", "m/m"
  double value = 0.0;  ///< 0 = off
  double low = 0.0;    ///< 95 % interval, value exp(-+1.96 u); NaN without uncertainty
  double high = 0.0;
  double likelihood_ratio = 0.0;  ///< NaN for white; tau has that of the correlated drift
  std::string remark;             ///< "", "off: not supported", "off: no times", ...
};
std::vector<NoiseRow> noise_table(const NoiseEstimate& estimate);

}  // namespace volcal
