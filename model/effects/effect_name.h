#pragma once
/// How an effect is called in lists, reports and files: KIND:TARGET:DRIVER:SHAPE. What an effect acts on and
/// what drives it are kept as what they are; their texts are written here, and read here from files and from
/// users. Names that read alike are equal.

#include <compare>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/machine_error.h"
#include "volcal/model/description/variable.h"

namespace volcal {

/// What an effect acts on.
class TargetName {
 public:
  TargetName() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): an error motion is a target
  TargetName(ErrorSymbol motion);
  // NOLINTNEXTLINE(google-explicit-constructor): and so is a location error
  TargetName(LocationSymbol location);
  /// Of one cause in several places: "EXX EYY".
  explicit TargetName(const std::vector<ErrorSymbol>& motions);
  /// "tool long", and "tool" of all; along one direction (0, 1, 2 = x, y, z): "tool long x".
  static TargetName of_tool(const std::string& tool = {}, std::optional<int> direction = {});
  /// "station P1", and "stations" of all; "station P1 x".
  static TargetName of_station(const std::string& station = {}, std::optional<int> direction = {});
  /// "readings of S1", and "readings" of all.
  static TargetName of_readings(const std::string& setup = {});
  /// What has none of these: "clamping in S1", "machine about y", "azimuth_deg of S1".
  static TargetName called(std::string name);
  /// In a part of the campaign alone: "EAY of P1".
  TargetName within(const std::string& part) const;
  /// Any text; one that has none of the forms above is called so.
  static TargetName parse(std::string_view text);

  const std::string& name() const { return name_; }
  bool empty() const { return name_.empty(); }
  /// Error motions, or a location error; empty for others.
  const std::vector<MachineError>& errors() const { return errors_; }
  /// Tool or station that it belongs to; absent for all of them and for others.
  const std::optional<Variable>& owner() const { return owner_; }

  friend bool operator==(const TargetName& a, const TargetName& b) { return a.name_ == b.name_; }
  friend auto operator<=>(const TargetName& a, const TargetName& b) { return a.name_ <=> b.name_; }

 private:
  std::string name_;
  std::vector<MachineError> errors_;
  std::optional<Variable> owner_;
};

/// What an effect changes with.
class EffectDriver {
 public:
  EffectDriver() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a variable is a driver
  EffectDriver(const Variable& variable);
  /// "dir_x x", as results call them.
  explicit EffectDriver(const std::vector<Variable>& variables);
  /// "t T_front_bearing", as the user has written of them.
  static EffectDriver written(const std::vector<Variable>& variables);
  /// By a name of its own, as "rate of T_air" of a temperature. `where`: of what tells the readings apart on
  /// which it acts, as a run for "run 2"; it changes with none of these.
  static EffectDriver called(std::string name, std::vector<Variable> variables,
                             std::vector<Variable> where = {});
  /// Any text; words of it that are no variables tell nothing.
  static EffectDriver parse(std::string_view text);

  const std::string& name() const { return name_; }
  bool empty() const { return name_.empty(); }
  const std::vector<Variable>& variables() const { return variables_; }
  const std::vector<Variable>& where() const { return where_; }
  bool has(const Variable& variable) const;
  /// It is the driver, alone.
  bool is(const Variable& variable) const;

  friend bool operator==(const EffectDriver& a, const EffectDriver& b) { return a.name_ == b.name_; }
  friend auto operator<=>(const EffectDriver& a, const EffectDriver& b) { return a.name_ <=> b.name_; }

 private:
  std::string name_;
  std::vector<Variable> variables_;
  std::vector<Variable> where_;
};

struct EffectName {
  std::string kind;  ///< "axis-coupling"
  TargetName target;
  EffectDriver driver;
  std::string shape;  ///< in the kind's words: "step", "linear", "periodic", an expression

  /// Of KIND:TARGET:DRIVER:SHAPE; absent where a part is missing or empty.
  static std::optional<EffectName> parse(std::string_view text);
  /// Of the four parts.
  static EffectName of_parts(std::string kind, std::string_view target, std::string_view driver,
                             std::string shape);

  friend bool operator==(const EffectName&, const EffectName&) = default;
  friend auto operator<=>(const EffectName&, const EffectName&) = default;
};

/// KIND:TARGET:DRIVER:SHAPE.
std::string full_name(const EffectName& name);

}  // namespace volcal
