#pragma once
/// The unknowns of a campaign in one vector: error-function coefficients, squareness, effects, tool offsets,
/// length scales and the setups' nuisance parameters. SI units.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/machine_error.h"
#include "volcal/model/description/symbols.h"
#include "volcal/model/functions/basis.h"

namespace volcal {

/// Functions of one axis that share a basis. Coefficient j of the function in `slot` stands at
/// offset + j * count + slot, so that the active coefficients of a position are contiguous.
struct FunctionGroup {
  AxisName axis = AxisName::X;
  std::shared_ptr<const Basis> basis;
  std::vector<ErrorSymbol> symbols;
  int offset = 0;

  int count() const { return static_cast<int>(symbols.size()); }
  int size() const { return basis->size() * count(); }
  int index(int coefficient, int slot) const { return offset + coefficient * count() + slot; }
};

enum class ParameterKind { Location, Effect, EffectShape, Expansion, ToolOffset, Nuisance };

/// A named block of parameters that are not function coefficients.
struct ParameterBlock {
  ParameterKind kind = ParameterKind::Nuisance;
  std::string name;                 ///< "EC0Y", "reversal EXX", "station P1", "tool long"
  std::vector<std::string> labels;  ///< one per parameter; may hold empty strings for a single one
  std::vector<std::string> units;   ///< edge unit: "um", "urad", "mm", "um/m/K", "ppm"
  std::vector<double> si_per_unit;
  std::optional<LocationSymbol> location;  ///< for ParameterKind::Location
  int offset = 0;
  Eigen::VectorXd guess;
  Eigen::VectorXd prior_mean;
  Eigen::VectorXd prior_sigma;  ///< 0 = no prior
  bool weak_default_prior = false;
  bool is_held = false;  ///< known and not estimated: a DatumSpace leaves it at its value

  int size() const { return static_cast<int>(guess.size()); }
  /// By the symbol of a location error, else by its name.
  MachineError machine_error() const { return location ? MachineError(*location) : MachineError(name); }
};

/// Coefficients of one function (Effect::surface).
inline bool is_surface(const ParameterBlock& block) {
  return block.kind == ParameterKind::Effect && block.size() > 1;
}

/// Layout of the parameter vector: functions first, then the blocks.
struct ParameterLayout {
  std::vector<FunctionGroup> groups;
  std::vector<ParameterBlock> blocks;
  int function_size = 0;
  int size = 0;

  /// Group and slot of a symbol; nullopt when it is switched off.
  struct FunctionPlace {
    int group = 0;
    int slot = 0;
  };
  std::optional<FunctionPlace> find(ErrorSymbol symbol) const;
  const ParameterBlock* find_block(const std::string& name) const;
  /// nullptr for an error motion, which is a function.
  const ParameterBlock* find_block(const MachineError& error) const { return find_block(error.name()); }
  /// Place of a parameter by its full name: that of its block, and its label behind it where it has one.
  std::optional<int> find_parameter(const std::string& name) const;
  const ParameterBlock* find_location(LocationSymbol symbol) const;
  /// Coefficients of one function out of a parameter vector.
  Eigen::VectorXd coefficients(ErrorSymbol symbol, const Eigen::VectorXd& parameters) const;
  /// All symbols with a function, in the order of groups and slots.
  std::vector<ErrorSymbol> symbols() const;
};

/// A parameter as lists and files state it: "EXX 3" is the fourth coefficient of EXX.
struct NamedParameter {
  std::string name;
  std::string unit;  ///< edge
  double si_per_unit = 1.0;
};
/// All of a layout, in its order.
std::vector<NamedParameter> named_parameters(const ParameterLayout& layout);

}  // namespace volcal
