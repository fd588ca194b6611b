#pragma once
/// What a plan is made from: what the user has, what it costs, what is assumed of the machine, and what shall
/// become small. SI.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/finding.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/machine_error.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

/// Of readings that are still to be taken; independent, k = 1.
struct PlanNoise {
  double constant = 0.25e-6;      ///< m
  double per_metre = 0.3e-6;      ///< m per m of length
  double repeatability = 0.6e-6;  ///< m, of the machine, per component
  double angle = 1e-6;            ///< rad, azimuth and elevation of a tracker
};

/// A telescoping ball-bar.
struct PlannedBar {
  double length = 0.0;                 ///< m, between the ball centres, nominal
  std::optional<double> length_sigma;  ///< m, of its calibration; 0 = exact, absent = unknown
};

/// Where a tracking instrument can look to.
struct InstrumentLimits {
  double range_min = 0.2;  ///< m, station to reflector
  double range_max = 15.0;
  double elevation_min = -0.61086523819801535;  ///< rad, above the horizontal (z up): -35 deg
  double elevation_max = 1.4835298641951802;    ///< 85 deg
};

/// What stands between a station and the reflector, and where a station can be put.
struct MachineSurroundings {
  double spindle_radius = 0.1;  ///< m, of a cylinder about the tool axis behind the spindle's reference point
  double clearance = 0.1;       ///< m, of a station from the box that tools and spindle sweep
  /// Where stations may stand, workpiece coordinates. Without, tracking instruments: beside the swept box up
  /// to 30 % of it (250 mm at least), from the lowest functional point, where the table is, up to its middle;
  /// centre balls: in the swept box.
  std::optional<Eigen::AlignedBox3d> stations_w;
};

struct TimeCosts {
  double station = 1200.0;  ///< s, to put up an instrument
  double run = 300.0;       ///< s, to change the tool and find the beam again; of a ball-bar: or the plane
  double reading = 4.0;     ///< s, the machine standing
  double feed = 0.1;        ///< m/s, from position to position
  double turn = 0.35;       ///< rad/s, of rotary axes
};

/// Nothing is kept that is not given: readings or time must be.
struct PlanBudget {
  int stations = 4;
  std::optional<int> readings;
  std::optional<double> time;      ///< s
  std::vector<std::size_t> tools;  ///< that may be used, indices into Machine::tools; empty = all
  std::optional<int> tool_count;   ///< of them; absent = all
};

/// How error functions may look before any reading is seen (solve/priors/function_prior.h, squared
/// exponential). Only functions with automatic knots know it; smoothing then finds it from the readings.
struct FunctionRoughnessGuess {
  double displacement = 3e-6;  ///< m, standard deviation from a straight line
  double rotation = 6e-6;      ///< rad
  double length = 0.2;         ///< correlation length, share of the travel
};

enum class PlanTarget { Volumetric, Worst, Symbol, Separate };

/// Name of the instrument that is planned with where nothing else is said: the first of registry.h.
std::string usual_plan_instrument();

struct PlanSettings {
  Machine machine;
  std::size_t hypothetical_tools = 0;  ///< the last of the machine's: not there yet, no part of its volume
  ModelSpec model;
  /// Errors of linear axes count as identified by a campaign of their own (with_known_linear_axes()).
  bool linear_axes_known = false;
  std::string instrument = usual_plan_instrument();
  PlanNoise noise;
  PlannedBar bar;
  InstrumentLimits limits;
  MachineSurroundings surroundings;
  TimeCosts costs;
  PlanBudget budget;
  FunctionRoughnessGuess roughness;
  PlanTarget target = PlanTarget::Volumetric;
  MachineError symbol;               ///< of PlanTarget::Symbol
  std::vector<EffectSpec> separate;  ///< two effects of PlanTarget::Separate
  /// Readings that are taken already, or will be: the plan adds to them.
  const Campaign* existing = nullptr;
  /// A campaign that this one verifies (ISO/TR 16907:2015, 11.3): nothing is measured where it was, from
  /// other places at other positions.
  const Campaign* apart_from = nullptr;
  std::uint64_t seed = 1;  ///< of the positions between grid points
  int threads = 0;         ///< 0 = all; results do not depend on it
  std::function<void(const std::string& stage, double done)> progress;
};

/// Thrown by `progress` while it is looked for what one setup more would bring: the plan is left without.
struct OptionsNotWanted : std::exception {};

/// A model without the errors of linear axes and their squareness.
ModelSpec with_known_linear_axes(ModelSpec model, const Machine& machine);

/// Takes effects out of the model that a campaign like `planned` cannot show: they depend on temperatures or
/// a feed that it does not record, or belong to setups or stations of the campaign in which they were found.
/// The plan takes them as known. Says which, "plan.effects-known"; nothing where there are none.
std::optional<Finding> hold_effects_unseen(const Campaign& planned, ModelSpec& model);

/// Throws InputError for settings that make no plan.
void check_plan_settings(const PlanSettings& settings);

/// Tools that may be used.
std::vector<std::size_t> tools_of(const PlanSettings& settings);
/// Tools that the machine has.
std::vector<Tool> own_tools(const PlanSettings& settings);

}  // namespace volcal
