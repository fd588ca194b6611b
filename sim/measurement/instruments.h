#pragma once
/// Measures a planned setup on a truth machine: every reading from the exact pose and the instrument's true
/// nuisance values, with noise. P: functional point, true tool and repeatability included.
///
///     laser-tracer       |P - S| (1 + length_scale) - dead_path
///     laser-tracker      |v| (1 + length_scale), azimuth (+x to +y) and elevation (from the xy plane) of
///                        v = R^T (P - S), R the station's rotation
///                        (both: P as seen from the floor on which the station stands)
///     ball-bar           |P - centre| + length_error
///     displacement       u.(P - P_first) (1 + length_scale) + offset; column set 1: less the commanded part;
///                        u turned by beam_angle from its direction towards the nearest axis across it
///     straightness       v.(P - P_first) - v.(artefact_rotation x a) s + offset; s the commanded distance
///                        along the line a
///     angle              O.axis + offset; O of the tool relative to the workpiece, or of one body in the
///                        room
///     volumetric-points  P - P_nominal + translation + rotation x P_nominal
///     r-test             R^T (P - P_nominal) + sphere; R the nominal axes of `frame`
///     probed-sphere      centres (column set 0): sphere - (P - P_nominal)
///                        contacts (1): tip and normal n; the axes go along n until
///                        n.(tip + P - P_nominal) = n.sphere + contact_radius, errors of the axes where they
///                        then stand, which the readings give as commanded; noise along n
/// P_first: nominal first point. a, and u without `direction`: commanded first to last point, or to the
/// farthest when the last is the first.

#include <cstdint>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/environment.h"
#include "volcal/sim/measurement/interference.h"
#include "volcal/sim/measurement/setup_plan.h"

namespace volcal::sim {

/// What all setups of a campaign share.
struct MeasuringConditions {
  const TruthMachine& machine;
  const Environment& environment;
  std::vector<Eigen::Vector3d> tool_offsets;  ///< true ones, by index into Machine::tools, m
  std::uint64_t seed = 0;
  bool at_reference_temperature = false;  ///< all channels at 20 degC
  bool noise_free = false;
  const Interference* interference = nullptr;  ///< nothing interferes
};

/// Name in files of what a channel of a setup reads, as "azimuth_deg"; empty where it has no such channel.
std::string column_read(const SetupPlan& plan, std::size_t channel);

/// `start_time`: of the first reading, s. Throws std::invalid_argument for an instrument that is not
/// simulated and for a setup without points.
Setup measure(const SetupPlan& plan, const MeasuringConditions& conditions, double start_time);

}  // namespace volcal::sim
