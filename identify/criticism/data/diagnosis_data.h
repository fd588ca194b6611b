#pragma once
/// What a diagnosis says, as plain data: all that is printed, drawn and kept in files. SI but for what is
/// named otherwise.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/data/figure_data.h"
#include "volcal/identify/criticism/data/scan_direction.h"
#include "volcal/identify/noise/noise_estimate.h"
#include "volcal/model/description/finding.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

enum class Verdict { Named, NamedMoreRemains, OneOf, Unknown, NothingAbove, NotVisible };
/// "NAMED", "NAMED_MORE_REMAINS", "ONE_OF", "UNKNOWN", "NOTHING_ABOVE", "NOT_VISIBLE".
std::string to_string(Verdict verdict);
/// Throws std::invalid_argument for another text.
Verdict verdict_from(const std::string& text);

/// One amplitude of a named effect, or of a candidate.
struct AmplitudeFigure {
  std::string label;
  double value = 0.0;  ///< SI
  double u = 0.0;
  double mdb = 0.0;  ///< smallest amplitude found with 80 % power at the family-wise level; NaN: never
  std::string unit;  ///< edge
  double si_per_unit = 1.0;
  /// Smallest amplitude that is also separated from every rival (confounding.h); infinite: never; NaN: not
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
  std::vector<Variable> variables;
  std::vector<Variable> with_one_of;  ///< and one of these, which the readings do not separate; or empty
  ScanDirection direction = ScanDirection::X;
  std::optional<ErrorSymbol> rotation;  ///< with the arms of this error motion; absent: as a displacement
  double rms = 0.0;                     ///< SI
  double log10_p = 0.0;                 ///< family-wise
  double period = 0.0;                  ///< m: it repeats; 0: not found to

  /// "x", "x and z", or "dir_x and one of T_air, T_column".
  std::string dependence() const;
  /// "something that depends on x and z": in the place of a name.
  std::string in_words() const;
  /// "X", "X, as EBX", or "X, every 10.02 mm".
  std::string action() const;
};

/// A surface or curve as it is drawn: places of its first one or two drivers, values with the last of these
/// next to each other. Not kept in files.
struct SurfaceFigure {
  std::vector<std::vector<double>> places;  ///< per driver, in its unit
  Eigen::VectorXd value;                    ///< SI
  Eigen::VectorXd u;
  std::vector<std::vector<double>> dots;  ///< where readings stand, per driver; a part of them
  double third = std::numeric_limits<double>::quiet_NaN();  ///< value of a third driver
  Eigen::VectorXd coefficients;                             ///< of its splines, SI
  Eigen::MatrixXd covariance;
};

/// A law that explains what a surface was drawn for, an effect of the kind `custom`.
struct FormulaFinding {
  std::string label;       ///< "EAY by y * z^2"
  EffectSpec spec;         ///< with its amplitude: can be put into a model file
  double amplitude = 0.0;  ///< m or rad for an expression in the units of its variables
  double u = 0.0;
  std::string unit;          ///< edge, of the amplitude: "urad/mm3"
  double si_per_unit = 1.0;  ///< of the target: 1e-6
  std::string shape_text;    ///< "p = 120.3 mm"; empty without parameters of its shape
  double log_evidence = -std::numeric_limits<double>::infinity();  ///< natural, over the model without it
  double gain = 0.0;                                               ///< LM less its price, as of effects
  double log10_p = 0.0;                                            ///< all laws that were tried counted
};

/// Laws of a target and drivers that the user asked for, beside the model reached.
struct AskedLaws {
  std::string label;                 ///< of the surface of this target and these drivers
  double surface_evidence = 0.0;     ///< natural, over the model without it
  std::size_t tried = 0;             ///< laws
  std::vector<FormulaFinding> laws;  ///< best first; at most ten

  /// That explain as much as the surface does.
  std::size_t sufficient() const;
};

/// A function without a formula that was drawn for what has no name, an effect of the kind `empirical`.
struct SurfaceFinding {
  EffectName name;
  std::string label;
  EffectSpec spec;  ///< with its coefficients: can be put into a model file
  std::vector<Variable> drivers;
  std::string unit;  ///< edge, of its values
  double si_per_unit = 1.0;
  double log_evidence = 0.0;          ///< natural, over the model without it
  double effective_parameters = 0.0;  ///< that the readings determine
  double rms = 0.0;                   ///< SI, over the readings
  double largest = 0.0;               ///< SI, of the largest magnitude (result/largest_value.h)
  double largest_u = 0.0;
  std::vector<double> at;         ///< there, one value per driver, in its unit
  std::vector<std::string> free;  ///< what the readings do not tell from the rest of the model, in words
  std::vector<FormulaFinding> formulas;  ///< laws of as much evidence, best first; none: no law was found
  SurfaceFigure figure;

  /// What enters a model for it: the leading law, or the surface where there is none.
  const EffectSpec& accepted_spec() const { return formulas.empty() ? spec : formulas.front().spec; }
  const std::string& accepted_label() const { return formulas.empty() ? label : formulas.front().label; }
};

/// A member of a set of alternatives. SI.
struct MemberFinding {
  double rms_heldout = std::numeric_limits<double>::quiet_NaN();  ///< with it in the model, as in the ladder
  double systematic = std::numeric_limits<double>::quiet_NaN();
  double systematic_low = std::numeric_limits<double>::quiet_NaN();
  double systematic_high = std::numeric_limits<double>::quiet_NaN();
  /// Of what it makes of the machine from what the chosen member does, the largest over the volume, under the
  /// conditions of tables and the mean ones of the campaign, m; NaN
  /// for what is no effect.
  double difference = std::numeric_limits<double>::quiet_NaN();
  double difference_u = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> at = {};  ///< there, linear axes, m
  /// Under which it is that large, of what drives members of the set: a temperature, time, feed, in its unit.
  std::vector<std::pair<Variable, double>> conditions = {};
};

/// Says of a finding on that difference under which conditions it is so large.
void add_conditions(const MemberFinding& member, Finding& finding);

/// What a set of alternatives means (alternative_sets.h).
struct SetFinding {
  std::optional<std::size_t> chosen;  ///< the simplest: it enters the extended model; none: no effect
  std::vector<MemberFinding> members;
  /// Whose prediction differs most from the chosen one's; of those that differ by more than U, if any do.
  std::optional<std::size_t> farthest;
  bool matters = false;  ///< it differs by more than U
};

/// One step of the ladder, all against the noise model at the last step. SI. Without held-out readings all
/// that is of these is NaN.
struct LadderStep {
  std::string model;  ///< "0", "1" ...
  std::string added;  ///< empty for the given model
  double rms_fit = 0.0;
  double rms_heldout = 0.0;
  double reduced_chi2 = 0.0;    ///< against the noise model
  double noise_floor = 0.0;     ///< root mean square noise of the held-out readings
  double systematic = 0.0;      ///< sqrt(max(0, MS - floor^2)) of the held-out readings
  double systematic_low = 0.0;  ///< 95 % interval
  double systematic_high = 0.0;
  double heldout_loglik_gain = 0.0;  ///< against the step before
};

/// The smallest amplitude of an effect of the catalogue that a campaign would have shown.
struct DetectableEffect {
  EffectName name;
  std::string label;
  std::string shape_text;  ///< where the shape was scanned: that of the best fit
  std::string unit;        ///< edge
  double si_per_unit = 1.0;
  double visible_fraction = 0.0;
  bool visible = false;
  double mdb = 0.0;  ///< SI, the largest of its amplitudes; found with 80 % power at the family-wise level
  /// Root mean square displacement of the functional point over the measured positions, m, by an effect of
  /// this size; NaN for what acts on the instrument and not on the machine.
  double volumetric = 0.0;
};

/// Cosines of the smallest angles between hypotheses after projection off the model.
struct Confounding {
  std::vector<EffectName> names;
  std::vector<std::string> labels;
  Eigen::MatrixXd cosine;  ///< symmetric, 0..1; NaN: nothing of one of the two is visible
};

/// A measurement that would tell hypotheses apart, or make effects visible (next_measurement.h).
struct MeasurementProposal {
  std::string action;                     ///< candidate measurement; empty: none helps
  std::string setup;                      ///< setup that it continues; empty = a new one
  std::vector<EffectName> separates;      ///< two hypotheses, or none
  std::vector<EffectName> makes_visible;  ///< of effects that are not
  std::size_t readings = 0;
  double separation = 0.0;  ///< s^2 as it is
  double gain = 0.0;        ///< s^2 with the measurement over s^2; infinite when it is 0 as it is
  double plain_gain = 0.0;  ///< with as many plain readings
  double reached = 0.0;     ///< s^2 with the measurement; 0 when it makes effects visible
  double plain = 0.0;       ///< s^2 with as many plain readings
  Finding finding = {};     ///< "measurement..."
};

/// What is asked about the next measurement.
struct PlanningOptions {
  std::size_t readings = 48;         ///< that a measurement may take, about
  std::vector<EffectSpec> separate;  ///< hypotheses that the user wants separated, or seen if it is one
};

/// A reading that is in none of the tests.
struct RemovedReading {
  std::string setup;
  std::int64_t line = 0;  ///< 1-based, of the file of readings
  std::string reading;    ///< its column
};

struct Diagnosis {
  Verdict verdict = Verdict::NothingAbove;
  std::vector<Finding> findings;                           ///< what the verdict says, "diagnosis..."
  std::vector<EffectFinding> effects;                      ///< named, in the order in which they were added
  std::vector<EffectFinding> one_of;                       ///< alternatives that the readings do not separate
  std::vector<std::vector<EffectFinding>> further_one_of;  ///< sets beside the first
  std::vector<SetFinding> sets;          ///< of one_of and those beside it, in their order; or empty
  std::vector<UnknownFinding> unknown;   ///< what surfaces were drawn for, in their order; then leading first
  std::vector<SurfaceFinding> surfaces;  ///< drawn for what has no name
  std::vector<EffectFinding> ranking;    ///< families by gain, at the model reached; at most 40
  std::vector<AskedLaws> asked_laws;     ///< in the order in which they were asked for
  std::vector<MemberFinding> tried_errors;   ///< of `tried`, held-out readings with each in the model reached
  std::vector<EffectFinding> tried;          ///< that the user thought of, at the model reached, as given
  std::vector<EffectFinding> not_visible;    ///< families of which less than 2 % shows
  std::vector<DetectableEffect> detectable;  ///< all effects, at the given model, in the catalogue's order
  std::vector<EffectFinding> model_changes;
  std::vector<LadderStep> ladder;
  std::vector<NoiseRow> noise;
  std::vector<std::string> noise_instruments;
  Confounding confounding;
  std::vector<MeasurementProposal> proposals;
  std::vector<Finding> not_looked_for;           ///< what no file records, and which kinds need it
  std::vector<Finding> notes;                    ///< of the campaign
  std::vector<RemovedReading> removed_readings;  ///< outliers of the model reached, by setup and line
  std::size_t families = 0;
  std::size_t generic_tests = 0;
  DiagnosisFigures figures;  ///< not kept in files
};

/// Of `unknown`, what no surface was drawn for.
std::span<const UnknownFinding> remaining_unknown(const Diagnosis& diagnosis);

/// What a surface removes from the readings, m RMS: of the squares of the fitted residuals before and after
/// its step of the ladder. Absent where the ladder has no such step or they did not fall.
std::optional<double> removed_rms(const Diagnosis& diagnosis, const SurfaceFinding& surface);

/// For every surface what enters a model: the leading law, or the surface itself.
std::vector<EffectFinding> drawn_effects(const Diagnosis& diagnosis);

/// The sets of alternatives: one_of and those beside it; none when it is empty.
std::vector<const std::vector<EffectFinding>*> sets_of_alternatives(const Diagnosis& diagnosis);

/// Where the model with this member in the place of the chosen one is kept: "alternative-1-2.toml".
std::string alternative_model_file(std::size_t set, std::size_t member);

/// What the proposals say.
std::vector<Finding> findings_of(const std::vector<MeasurementProposal>& proposals);

/// Whether a diagnosis pays (screening.h).
struct Screening {
  std::size_t tests = 0;
  std::size_t observations = 0;  ///< that the tests saw
  bool of_a_sample = false;      ///< which are not all of the fit's
  bool contradicts = false;      ///< a test is above the noise
  std::string leading;           ///< the most improbable: "EAX by z^2", "something that depends on z along Z"
  double log10_p = 0.0;          ///< its, family-wise
  double rms = 0.0;              ///< SI: root mean square over the readings of what it would explain
  std::optional<Finding> misread;  ///< "readings.misread": sign or unit of setups (reading_factors.h)
};

/// "model.contradicted"; nothing where nothing contradicts.
std::optional<Finding> finding_of(const Screening& screening);

}  // namespace volcal
