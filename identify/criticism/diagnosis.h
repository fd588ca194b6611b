#pragma once
/// Where a model fails to explain the readings, and which physical effect is missing.
///
///   1. the noise model by restricted likelihood,
///   2. score tests of every named family, after projection off the model,
///   3. generic scans, because the catalogue is never complete,
///   4. a verdict in the user's words; effects are added one by one until nothing is left, and told all with
///      `climb`, else the first.
///
/// A share of the lines is held out: they never choose, and judge every step.

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "volcal/identify/criticism/catalogue/detectable.h"
#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/figures/diagnosis_figures.h"
#include "volcal/identify/criticism/proposals/confounding.h"
#include "volcal/identify/criticism/proposals/next_measurement.h"
#include "volcal/identify/criticism/scans/generic_scan.h"
#include "volcal/identify/noise/noise_estimate.h"

namespace volcal {

enum class Verdict { Named, NamedMoreRemains, OneOf, Unknown, NothingAbove, NotVisible };
/// "NAMED", "NAMED_MORE_REMAINS", "ONE_OF", "UNKNOWN", "NOTHING_ABOVE", "NOT_VISIBLE".
std::string to_string(Verdict verdict);
/// Throws std::invalid_argument for another text.
Verdict verdict_from(const std::string& text);

/// log10 of the family-wise probability below which an effect, or a generic test, is above the noise.
double log10_family_risk();
double log10_generic_risk();

/// One amplitude of a named effect, or of a candidate.
struct AmplitudeFigure {
  std::string label;
  double value = 0.0;  ///< SI
  double u = 0.0;
  double mdb = 0.0;  ///< smallest amplitude found with 80 % power at the family-wise level; NaN: never
  std::string unit;  ///< edge
  double si_per_unit = 1.0;
  /// Smallest amplitude that is also told apart from every rival (confounding.h); infinite: never; NaN: not
  /// computed.
  double mib = std::numeric_limits<double>::quiet_NaN();
  std::string mib_rival = {};  ///< the worst rival; empty: none is near
};

struct EffectFinding {
  EffectName name;
  std::string label;
  EffectSpec spec;  ///< with the estimated amplitudes and shape: can be put into a model file
  std::vector<AmplitudeFigure> amplitudes;
  std::string shape_text;  ///< "period 10.02 mm"; empty without shape parameters
  double log10_p = 0.0;    ///< family-wise
  double lm = 0.0;
  int dof = 0;
  double gain = 0.0;
  double visible_fraction = 0.0;
  bool resolution = false;  ///< more of an error function, no effect
};

/// Something moves the readings, and no effect of the catalogue explains it better.
struct UnknownFinding {
  std::vector<std::string> variables;
  std::vector<std::string> with_one_of;  ///< and one of these, which the readings do not tell apart; or empty
  std::string direction;                 ///< of kScanDirections
  std::string rotation;  ///< "EBX": with the arms of this error motion; empty: as a displacement
  double rms = 0.0;      ///< SI
  double log10_p = 0.0;  ///< family-wise
  double period = 0.0;   ///< m: it repeats; 0: not found to

  /// "x", "x and z", or "dir_x and one of T_air, T_column".
  std::string dependence() const;
  /// "X", "X, as EBX", or "X, every 10.02 mm".
  std::string action() const;
};

/// One step of the ladder, all against the noise model at the last step. SI.
struct LadderStep {
  std::string model;  ///< "0", "1" ...
  std::string added;  ///< empty for the given model
  double rms_fit = 0.0;
  double rms_heldout = 0.0;     ///< NaN without held-out readings
  double reduced_chi2 = 0.0;    ///< against the noise model
  double noise_floor = 0.0;     ///< root mean square noise of the held-out readings
  double systematic = 0.0;      ///< sqrt(max(0, MS - floor^2)) of the held-out readings
  double systematic_low = 0.0;  ///< 95 % interval
  double systematic_high = 0.0;
  double heldout_loglik_gain = 0.0;  ///< against the step before
};

struct DiagnoseOptions {
  int threads = 1;     ///< 0 = as many as the machine has; results do not depend on it
  bool climb = false;  ///< tell all effects that were found, not the first alone
  int most_effects = 8;
  double heldout_share = 0.1;
  bool figures = true;                 ///< what the report draws; a study leaves it out
  std::vector<std::string> leave_out;  ///< kinds of effects that are not looked for
  bool compare = true;                 ///< MIB, confounding matrix, next measurement
  PlanningOptions planning;
  std::function<void(const std::string& stage, double done)> progress;
};

/// A reading that is in none of the tests.
struct RemovedReading {
  std::string setup;
  std::int64_t line = 0;  ///< 1-based, of the file of readings
  std::string reading;    ///< its column
};

struct Diagnosis {
  Verdict verdict = Verdict::NothingAbove;
  std::vector<std::string> words;      ///< the verdict in plain sentences
  std::vector<EffectFinding> effects;  ///< named, in the order in which they were added
  std::vector<EffectFinding> one_of;   ///< alternatives that the readings do not tell apart
  std::vector<std::vector<EffectFinding>> further_one_of;  ///< sets beside the first
  std::vector<UnknownFinding> unknown;                     ///< leading first
  std::vector<EffectFinding> ranking;        ///< families by gain, at the model reached; at most 40
  std::vector<EffectFinding> not_visible;    ///< families of which less than 2 % shows
  std::vector<DetectableEffect> detectable;  ///< all effects, at the given model, in the catalogue's order
  std::vector<EffectFinding> model_changes;
  std::vector<LadderStep> ladder;
  std::vector<NoiseRow> noise;
  std::vector<std::string> noise_instruments;
  Confounding confounding;
  std::vector<std::string> next_measurement;  ///< in words
  std::vector<MeasurementProposal> proposals;
  std::vector<std::string> not_looked_for;       ///< sentences: what no file records, and which kinds need it
  std::vector<std::string> notes;                ///< of the campaign
  std::vector<RemovedReading> removed_readings;  ///< outliers of the model reached, by setup and line
  std::size_t families = 0;
  std::size_t generic_tests = 0;
  DiagnosisFigures figures;  ///< not kept in files
};

/// The sets of alternatives: one_of and those beside it; none when it is empty.
std::vector<const std::vector<EffectFinding>*> sets_of_alternatives(const Diagnosis& diagnosis);

/// `result` must come from fit() of this campaign.
Diagnosis diagnose(const Campaign& campaign, const FitResult& result, const DiagnoseOptions& options);

}  // namespace volcal
