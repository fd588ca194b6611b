#pragma once
/// What an identification tells of a machine, one by one: error motions and location errors by their symbols
/// (ISO 230-1), and by its name what has no symbol.

#include <compare>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "volcal/model/description/symbols.h"

namespace volcal {

/// An error motion, a location error, squareness among them, or the name of what has no symbol: an amplitude
/// of an effect, "reversal EXX", a station.
class MachineError {
 public:
  MachineError() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): an error motion is an error
  MachineError(ErrorSymbol motion) : identity_(motion) {}
  // NOLINTNEXTLINE(google-explicit-constructor): and so is a location error
  MachineError(LocationSymbol location) : identity_(location) {}
  /// Of what has no symbol.
  explicit MachineError(std::string name) : identity_(std::move(name)) {}
  /// Of any of these by its name.
  static MachineError parse(const std::string& name);

  /// As results, lists and files call it: "EXX", "EC0Y", "reversal EXX".
  std::string name() const;
  std::optional<ErrorSymbol> motion() const;       ///< absent for others
  std::optional<LocationSymbol> location() const;  ///< absent for others
  /// Motion or location, not a mere name.
  bool has_symbol() const { return !std::holds_alternative<std::string>(identity_); }
  std::optional<AxisName> axis() const;        ///< that a symbol ends with
  std::optional<Component> component() const;  ///< of a symbol
  /// By its symbol; false for a mere name.
  bool is_angle() const;

  friend bool operator==(const MachineError&, const MachineError&) = default;
  friend auto operator<=>(const MachineError&, const MachineError&) = default;

 private:
  std::variant<ErrorSymbol, LocationSymbol, std::string> identity_;
};

std::vector<std::string> names_of(const std::vector<MachineError>& errors);

}  // namespace volcal
