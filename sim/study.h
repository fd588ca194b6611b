#pragma once
/// A study: a machine, its hidden truth, surroundings and measurements; and the campaign that comes of it.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/finding.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/sim/hidden/hidden_answer.h"
#include "volcal/sim/hidden/hidden_effects.h"
#include "volcal/sim/machine/control.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/environment.h"
#include "volcal/sim/measurement/measurements.h"

namespace volcal::sim {

struct TruthSettings {
  bool perfect = false;             ///< no errors but those listed below
  std::optional<ModelSpec> errors;  ///< known ones in place of random ones (known_errors.h)
  std::string errors_file;          ///< where they were read from
  std::vector<Finding> notes;       ///< on what was read
  RandomTruthOptions random;
  std::map<ErrorSymbol, FunctionSpec> functions;   ///< with coefficients, in place of the random ones
  std::map<LocationSymbol, double> locations;      ///< in place of the random ones, rad or m
  std::map<ErrorSymbol, double> reversals;         ///< in place of the random ones, rad or m
  std::map<AxisName, ScaleExpansion> expansions;   ///< exact, in place of the machine file's
  std::map<std::string, Eigen::Vector3d> tools;    ///< true less stated offset, in place of random ones, m
  std::function<void(TruthMachine& truth)> alter;  ///< anything else, applied last
};

/// Noise-free error vectors at random points, temperatures 20 degC, direction unknown. Rotary axes stand at
/// random positions too where the campaign moves any of them, and otherwise at home.
struct ValidationSettings {
  int points = 400;
  std::vector<std::string> tools;  ///< empty = the first tool only; one setup per tool
  double stated_noise = 0.1e-6;    ///< m, what the campaign file says
};

struct Study {
  std::string file;  ///< where it was read from; empty when made in memory
  Machine machine;
  std::uint64_t seed = 1;
  /// Of the noise of the readings alone, to measure the same machine in the same way again; absent = seed.
  std::optional<std::uint64_t> noise_seed = {};
  TruthSettings truth;
  Environment environment;
  std::vector<Measurement> measurements;
  ValidationSettings validation;
  double pause_between_setups = 600.0;  ///< s
  std::vector<HiddenEffect> hidden;
  ActiveCompensation compensation;  ///< of the control while everything is measured
  /// The tools are longer than the control knows, m; what the campaign file says of them is what the control
  /// knows (ISO/TR 16907, 11.2 d).
  double wrong_tool_length = 0.0;
  bool unseen = false;  ///< make the campaigns at unseen positions, and what is sealed about the noise
};

struct SimulatedCampaign {
  Campaign campaign;
  Campaign validation;  ///< what is hidden in the machine is in these errors too, at time 0
  TruthMachine truth;
  std::vector<Eigen::Vector3d> tool_offsets;  ///< true ones, by index into Machine::tools, m
  std::vector<SetupPlan> plans;               ///< of the campaign's setups, true nuisance values included
  std::vector<HiddenAnswer> hidden = {};      ///< with the amplitudes used
  /// Noise-free readings of the same setups (stations, tools, dead paths, clock) at other positions, with the
  /// hidden effects and without. Empty unless the study asks for them or hides something.
  Campaign unseen = {};
  Campaign unseen_without_hidden = {};
  std::vector<GrossError> outliers = {};
};

/// The truth of a study alone: the random machine, or known errors, with expansions (true coefficients drawn
/// from the stated uncertainty), what the study sets, and its compensation, without its hidden effects and
/// without what known effects do to tools.
TruthMachine true_machine(const Study& study);

/// Repeatable to the bit for a given study and seed. Throws InputError for a study that makes no sense.
SimulatedCampaign simulate(const Study& study);

}  // namespace volcal::sim
