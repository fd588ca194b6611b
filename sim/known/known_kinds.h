#pragma once
/// Kinds of effects of a model file as a truth machine has them. Keys are those of model files: "temperature"
/// names a channel, amplitudes are per metre, per kelvin or per second, positions count from home. A new kind
/// is a function and a line of the list of its file.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/sim/hidden/hidden_settings.h"

namespace volcal::sim {

struct KnownKind {
  std::string kind;
  void (*act)(const HiddenSettings& settings, HiddenScene& scene);
};

std::vector<KnownKind> known_drive_kinds();
std::vector<KnownKind> known_thermal_kinds();
std::vector<KnownKind> known_structure_kinds();
std::vector<KnownKind> known_instrument_kinds();
std::vector<KnownKind> known_open_kinds();

StateNumber from_home(const HiddenSettings& settings, AxisName axis);  ///< m or rad
StateNumber approach_of(AxisName axis);                                ///< -1, 0, 1
double amplitude_of(const HiddenSettings& settings);                   ///< of the key `amplitude`
StateNumber product_of(const StateNumber& one, const StateNumber& other);
Eigen::Vector3d vector_of(const HiddenSettings& settings);  ///< of the keys `x`, `y`, `z`
/// An error motion of the effect's amplitude times `driver`, of the key `symbol` or stated.
void add_motion(const HiddenSettings& settings, const StateNumber& driver, HiddenScene& scene);
void add_motion(const HiddenSettings& settings, ErrorSymbol symbol, const StateNumber& driver,
                HiddenScene& scene);
/// The tool's offset grows along a vector, m, as `driver` says.
void move_tool(const Eigen::Vector3d& full, const StateNumber& driver, HiddenScene& scene);

}  // namespace volcal::sim
