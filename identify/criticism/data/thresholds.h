#pragma once
/// Every threshold that model criticism judges by: what it compares, in which unit, what happens on either
/// side, and where its value comes from. Rows (`null`, `listed`, `unlisted`, `left-out`, `pairs`, `partial`)
/// are those of `volcal study criticism` in docs/studies.md, which counted the values together and not one by
/// one. "Gain" is LM less its price, what the extended BIC compares (Chen and Chen 2008, Biometrika 95, 759);
/// it and LM are twice a log likelihood. Limits of lists and of numerical procedures stand where they are
/// used.

#include <cmath>
#include <cstddef>

namespace volcal {

struct Thresholds {
  // Risks: probabilities, family-wise over all tests of their kind. At or below: above the noise.

  /// An effect of the catalogue exceeds the noise; above: it is not looked at. `null`: 1 alarm in 200
  /// campaigns.
  double family_risk = 0.005;
  /// The same of a scan without a catalogue, polynomials, kernels and waves each. Stricter, because a scan
  /// that exceeds also keeps names from being certain. `null`.
  double scan_risk = 0.002;
  /// log10. A fit is contradicted by its screening; above: no word of it. No study: one fit in a thousand.
  double screening_log10_risk = -3.0;
  /// The same where the noise is more than white: its parameters are estimated and taken as known, which
  /// chi-squared does not count. No study.
  double screening_log10_risk_of_drift = -6.0;
  /// log10, family-wise. An effect stands out beside error functions that the model holds at zero
  /// (open_errors.h); above: it is not named while these are missing. As strict as for screening and for the
  /// same reason: their variances and the noise are estimated and taken as known. `volcal study mills`.
  double open_errors_log10_risk = -6.0;
  /// Chi-squared. Readings that are multiplied by -1 or 1000 lower it by more: said. As 5 standard deviations
  /// of one setup among some sixty; no study.
  double reading_factor_gain = 30.0;
  /// Of the best factor's. The slip's is less: another factor explains the readings better.
  double reading_factor_of_best = 0.8;
  /// Standard uncertainties, and share of the factor, by which the others may expect another one.
  double reading_factor_u = 4.0;
  double reading_factor_share = 0.25;
  /// Observations beyond what the parameters take. Fewer: nothing is screened.
  double screening_spare_observations = 5.0;
  /// Observations. More: an even choice of as many is screened. A shift of a twentieth of sigma between two
  /// halves of them still stands 5.6 standard deviations out.
  std::size_t screening_most_observations = 50000;
  /// Setups. More: an even choice of as many is screened. Each has parameters, and suspects, of its own: the
  /// work grows with the cube of their number.
  std::size_t screening_most_setups = 300;

  // Names against each other.

  /// Gain. Nearer than this: the readings do not tell two names apart, ONE_OF; farther: the better one
  /// replaces the other. 2 ln of a Bayes factor of 20 (Kass and Raftery 1995, JASA 90, 773, "strong").
  /// `listed`, `pairs`.
  double indistinguishable_gain = 6.0;
  /// LM. Nearer: a rival whatever its number of amplitudes, two standard deviations of one amplitude.
  /// `listed`.
  double indistinguishable_lm = 4.0;
  /// Exchanges, departures and new climbs at most; after them what stands is reported. No search has needed
  /// more.
  int most_changes = 4;

  // Scans against names. Beyond any of the margins a scan does better, and the name alone is none.

  /// Gain of a polynomial over that of the leading name. `unlisted`: names that a scan beats are wrong ones.
  double scan_gain_margin = 2.0;
  /// The same over names that leave no scan above the noise: as far as two names have to be apart. `pairs`.
  double scan_gain_margin_of_sufficient_names = indistinguishable_gain;
  /// Share of log10 p by which a scan is less probable, beside one decade. `unlisted`: kernels see bumps and
  /// kinks.
  double scan_probability_margin = 0.03;
  /// The same against a displacement whose components cost probability where they are absent. `listed`.
  double scan_probability_margin_of_components = 0.1;
  /// Names added together against a scan. `pairs`: 67 to 83 %.
  int most_together = 3;

  // Surfaces (surface_search.h).

  /// Log evidence over the model without it. Less: the surface is not drawn. Very strong evidence (Kass and
  /// Raftery 1995, JASA 90, 773).
  double surface_evidence = 5.0;
  /// Surfaces that are drawn at most; what still exceeds then is reported.
  int most_surfaces = 4;

  // What is no name (rejection.h).

  /// Probability that the amplitude is constant, per name. At or below: the name is rejected. `unlisted`.
  double constancy_risk = 0.01;
  /// At or above: plainly constant. Twins vary nearly alike, so a rival replaces a rejected name only where
  /// it is not in doubt itself. `listed`, `unlisted`.
  double plainly_constant = 0.1;
  /// Standard uncertainties by which the readings ask for a shape beyond the end of its scan. More: no name;
  /// a two-sided 5 % test. `unlisted`.
  double beyond_scan = 2.0;
  /// Share of the systematic error of held-out readings. More is left: the verdict keeps the reserve that
  /// more remains. No study: a name with s >= 12 recovers 0.9 (`listed`).
  double heldout_error_left = 0.8;

  // Scanned shapes.

  /// Gain below the leading test, and log10 p of the family for itself. Within both: the shape is refined
  /// between the values of its scan; refinement adds less than the first. `listed`.
  double worth_refining_gain = 40.0;
  double worth_refining_log10_p = -2.0;
  /// Cosine of projected columns. Less: neighbours of a scan have nothing to do with each other, no
  /// refinement.
  double related_neighbours = 0.3;
  /// Second difference over first. More: the readings do not depend smoothly on the shape, which then has no
  /// uncertainty.
  double smooth_dependence = 0.2;
  /// Share of the distance to the neighbour. Nearer to an end of the scan counts as at the end.
  double at_end_of_scan = 0.02;
  /// Share of a shape's derivative that survives the projection. Less: it enters no model.
  double visible_derivative = 1e-3;

  // Noise.

  /// 2 (l - l without). A drift that reaches it is kept in tests, on less evidence than in a fit (7): one
  /// that is missing raises alarms, one too many costs little. `null`: 7 of 1,000 alarms before, 1 of 200
  /// with it.
  double drift_evidence = 4.0;
  /// Rounds in which noise and smoothing are found in turn, each taking the other's part.
  int noise_rounds = 2;
  /// Share of its drift at which noise holds hardly any effect: what exceeds there is tested jointly.
  /// `left-out`.
  double reduced_drift = 0.3;
  /// 2 l that noise estimated jointly may add to the bound. Farther below: not worth estimating. `left-out`.
  double worth_joint_estimate = 20.0;
  /// 2 l. Farther than this below the ratio that counts, next to the noise that was estimated without an
  /// effect: no other maximum is looked for. No study.
  double another_maximum = 10.0;
  /// Effects, and scans of each instrument, that are tested jointly with the noise: the best. Cost alone.
  std::size_t most_joint_tests = 3;
  /// Scans. More exceed: something is there beyond doubt, and none is judged by F; fewer may be noise that is
  /// hardly known. A weak finding is seen by some scans, a strong one by most. `null`.
  std::size_t most_doubtful_scans = 40;

  // Visibility.

  /// Share |g~| / |g_w| of a direction that survives the projection. Less carries no information: rounding.
  double invisible_share = 1e-4;
  /// The same of an effect. Less: not visible to the campaign, NOT_VISIBLE where that holds for most.
  /// `partial`.
  double visible_fraction = 0.02;
  /// Squared sine of the angle between hypotheses. Less: they predict the same readings.
  double same_squared_sine = 1e-6;
  /// Power of the smallest detectable amplitude. `mdb`.
  double power = 0.8;

  // What is reported of an effect without a name.

  /// Share of log10 p. Within it of the least probable scan the simplest is reported first. `unlisted`.
  double nearly_as_improbable = 0.1;
  /// log10 p, and share of it, whichever is more. Nearer: another variable explains as much as the second,
  /// and only the first is certain. `unlisted`: 77 to 80 %.
  double same_second_variable = 1.0;
  double same_second_variable_share = 0.05;

  // Next measurement; s^2 in units of the noise variance (next_measurement.h).

  /// Ratio of s^2. Less: no proposal.
  double helpful_gain = 1.05;
  /// The same where the two make the same of the machine in the measured volume, so that a name alone is won.
  double worth_a_name = 1.5;
  /// s^2 that a measurement must reach: one standard deviation. Less: nothing tells the two apart.
  double separated = 1.0;
  /// Ratio of s^2 by which a measurement for one pair must beat the one for all pairs, to be proposed beside
  /// it.
  double much_better = 1.5;
  /// Ratio by which what needs an instrument or a tool that is not at hand must be better.
  double effort = 2.0;
};

inline constexpr Thresholds kThresholds{};

/// log10 of the family-wise probability at or below which an effect, or a scan, exceeds the noise.
inline double log10_family_risk() { return std::log10(kThresholds.family_risk); }
inline double log10_scan_risk() { return std::log10(kThresholds.scan_risk); }

}  // namespace volcal
