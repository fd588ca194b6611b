#pragma once
/// A model bound to a campaign: the layout of the parameter vector, and where every setup, effect and error
/// finds its parameters. Built once; afterwards plain data.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect.h"
#include "volcal/model/instruments/instrument.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {

/// A parameter that acts as an error motion: parameter x driver is added to one component of a joint.
struct MotionTerm {
  int joint = 0;      ///< workpiece to tool
  int component = 0;  ///< 0..5: EX EY EZ EA EB EC
  int parameter = -1;
};

/// A function group's joint, and the component of each of its slots.
struct GroupBinding {
  AxisName axis = AxisName::X;
  int joint = 0;
  std::vector<int> component;
};

/// A location error as error motion; its driver is the sign, times the axis position for squareness.
struct LocationBinding {
  MotionTerm term;
  AxisName axis = AxisName::X;
  double sign = 1.0;
  bool times_position = false;
};

/// Everything that a reading can be disturbed by, one number each: six motions of every joint, the tool's
/// offset (tool coordinates), the station's position (workpiece coordinates), the rotation of the machine
/// against the floor (workpiece axes), the channels of the reading.
inline constexpr int kToolDisturbance = 6 * static_cast<int>(kAxisCount);
inline constexpr int kStationDisturbance = kToolDisturbance + 3;
inline constexpr int kFloorDisturbance = kStationDisturbance + 3;
inline constexpr int kReadingDisturbance = kFloorDisturbance + 3;
inline constexpr int kDisturbances = kReadingDisturbance + kMaxChannels;

/// An effect's parameters: its amplitudes, then those of its shape that are estimated. Drivers are tabulated
/// at `shape` and expanded to first order about it.
struct EffectBinding {
  using Table = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  std::unique_ptr<Effect> effect;
  std::vector<int> target;      ///< per term: index of the disturbance
  std::vector<int> amplitude;   ///< per term: number of its amplitude
  std::vector<int> free_shape;  ///< indices of the shape parameters that are estimated
  int first_parameter = 0;
  Eigen::VectorXd shape;                  ///< all shape parameters, SI
  std::vector<Table> driver;              ///< per setup: rows x terms
  std::vector<std::vector<Table>> slope;  ///< per free shape parameter and setup: derivative of the drivers

  int term_count() const { return static_cast<int>(target.size()); }
  int amplitude_count() const { return static_cast<int>(effect->amplitudes().size()); }
  int parameter_count() const { return amplitude_count() + static_cast<int>(free_shape.size()); }
  int shape_parameter(std::size_t free) const {
    return first_parameter + amplitude_count() + static_cast<int>(free);
  }
};

/// Thermal expansion of a scale, from home, where the datum makes every error motion zero; `term.parameter`
/// corrects the coefficient, -1 = exact.
struct ExpansionBinding {
  MotionTerm term;
  AxisName axis = AxisName::X;
  double per_kelvin = 0.0;  ///< 1/K
  double home = 0.0;        ///< m or rad
  const std::vector<double>* temperature_degC = nullptr;

  double coefficient(const Eigen::VectorXd& parameters) const {
    return term.parameter < 0 ? per_kelvin : per_kelvin + parameters[term.parameter];
  }
  /// Position from home times the excess over the reference temperature, m K.
  double warmed(std::size_t row, const AxisPosition& position) const {
    return ((*temperature_degC)[row] - kReferenceTemperature_degC) * (position[index_of(axis)] - home);
  }
};

struct SetupBinding {
  std::unique_ptr<BoundSetup> bound;
  std::vector<int> nuisance;  ///< global index of every parameter of the setup's concatenated blocks
  int tool_error = -1;        ///< global index of the tool's offset error, -1 = none
  Eigen::Vector3d tool_offset = Eigen::Vector3d::Zero();
  std::vector<ExpansionBinding> expansions;
  double noise_constant[kMaxChannels] = {};  ///< of the noise table, m or rad
  double noise_per_metre = 0.0;
};

struct CampaignBinding {
  ParameterLayout layout;
  std::vector<GroupBinding> groups;
  std::vector<LocationBinding> locations;
  std::vector<EffectBinding> effects;
  std::vector<SetupBinding> setups;
  /// Terms of every reading, whatever its setup: locations, uncertain expansions.
  std::vector<MotionTerm> shared_terms;
  int effect_parameters = 0;       ///< of all effects; every reading has them
  int effect_drivers = 0;          ///< numbers per reading that they need
  bool effect_moves_tool = false;  ///< some effect acts on the tool's offset
  bool effect_tilts_floor = false;
  Eigen::Vector3d floor_pivot_w = Eigen::Vector3d::Zero();  ///< middle of the linear axes' travel
};

/// Index of the disturbance that a target is.
int disturbance_of(const EffectTarget& target, const Machine& machine);
/// Tabulates the drivers of an effect at its `shape`.
void tabulate_drivers(const std::vector<SetupView>& views, EffectBinding& binding);
/// Setups as effects see them.
std::vector<SetupView> setup_views(const Campaign& campaign, const CampaignBinding& binding,
                                   const KinematicChain& chain);

/// `spec` must be resolved: every function that uses knots has breakpoints. Throws InputError. The campaign
/// must outlive the binding.
CampaignBinding bind_campaign(const Campaign& campaign, const ModelSpec& spec, const KinematicChain& chain);

}  // namespace volcal
