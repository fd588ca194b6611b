#pragma once
/// Axis names and ISO 230-1 error symbols (as quoted in ISO/TR 16907, clause 3 and 7).
/// `EXY`: direction first, moving axis second. `EC0Y`: location error, component first, axis last.

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace volcal {

/// X, Y, Z move along the three directions, A, B, C turn about them, U, V, W are linear axes parallel to X,
/// Y, Z (ISO 841), as a quill W in a head on Z.
enum class AxisName { X, Y, Z, A, B, C, U, V, W };
inline constexpr std::size_t kAxisCount = 9;
inline constexpr std::array<AxisName, kAxisCount> kAllAxes = {AxisName::X, AxisName::Y, AxisName::Z,
                                                              AxisName::A, AxisName::B, AxisName::C,
                                                              AxisName::U, AxisName::V, AxisName::W};

/// The linear axes that give the three directions, in the order of these: index and direction are one number.
inline constexpr std::array<AxisName, 3> kLinearAxes = {AxisName::X, AxisName::Y, AxisName::Z};
/// The linear axes beside them.
inline constexpr std::array<AxisName, 3> kParallelAxes = {AxisName::U, AxisName::V, AxisName::W};

constexpr std::size_t index_of(AxisName axis) { return static_cast<std::size_t>(axis); }
constexpr bool is_rotary(AxisName axis) { return index_of(axis) / 3 == 1; }
/// U, V, W.
constexpr bool is_parallel(AxisName axis) { return index_of(axis) / 3 == 2; }
/// Coordinate direction 0..2 along which (linear) or about which (rotary) the axis moves.
constexpr int direction_of(AxisName axis) { return static_cast<int>(index_of(axis) % 3); }
/// X, Y or Z, along which or about which the axis moves.
constexpr AxisName main_axis_of(AxisName axis) { return kLinearAxes[index_of(axis) % 3]; }
char letter_of(AxisName axis);
/// "XYZ"
std::string letters_of(const std::vector<AxisName>& axes);
char lower_letter_of(AxisName axis);  ///< as in column names: 'x'
std::optional<AxisName> axis_from_letter(char letter);

/// Component of an error: EX EY EZ are displacements (m), EA EB EC rotations (rad) about x, y, z.
enum class Component { X, Y, Z, A, B, C };
inline constexpr std::array<Component, 6> kAllComponents = {Component::X, Component::Y, Component::Z,
                                                            Component::A, Component::B, Component::C};
constexpr std::size_t index_of(Component component) { return static_cast<std::size_t>(component); }
constexpr bool is_rotation(Component component) { return index_of(component) >= 3; }
constexpr int direction_of(Component component) { return static_cast<int>(index_of(component) % 3); }
/// The component that an axis moves along or about: Z of Z and W, C of C.
constexpr Component positioning_component(AxisName axis) {
  return kAllComponents[index_of(axis) % 3 + (is_rotary(axis) ? 3 : 0)];
}

/// One of the six error motions of an axis, e.g. {A, X} = EAX.
struct ErrorSymbol {
  Component component = Component::X;
  AxisName axis = AxisName::X;

  std::string name() const;
  /// Positioning error: EXX, EYY, EZZ, EAA, EBB, ECC, EXU, EYV, EZW.
  constexpr bool is_positioning() const { return component == positioning_component(axis); }
  /// Displacement or tilt of a rotary axis across its line: EXC, EYC, EAC, EBC.
  constexpr bool is_transverse() const {
    return is_rotary(axis) && direction_of(component) != direction_of(axis);
  }
  /// Straightness of a linear axis: displacement component other than its own.
  constexpr bool is_straightness() const {
    return !is_rotary(axis) && !is_rotation(component) && !is_positioning();
  }
  static std::optional<ErrorSymbol> parse(std::string_view name);
  friend bool operator==(const ErrorSymbol&, const ErrorSymbol&) = default;
  friend auto operator<=>(const ErrorSymbol&, const ErrorSymbol&) = default;
};

/// A location (position-independent) error, e.g. {C, Y} = EC0Y: squareness for linear axes, location and
/// orientation of the axis average line for rotary ones.
struct LocationSymbol {
  Component component = Component::A;
  AxisName axis = AxisName::X;

  std::string name() const;
  static std::optional<LocationSymbol> parse(std::string_view name);
  friend bool operator==(const LocationSymbol&, const LocationSymbol&) = default;
  friend auto operator<=>(const LocationSymbol&, const LocationSymbol&) = default;
};

/// What the datum makes zero of an error function. Of the straightness of a linear axis: the value at home
/// and the slope, which the squareness holds. Of a transverse motion of a rotary axis: the mean over the
/// travel, which the location of the axis average line holds. Of others: the value at home.
enum class FunctionDatum { Home, HomeAndSlope, Mean };
constexpr FunctionDatum datum_of(const ErrorSymbol& symbol) {
  if (symbol.is_straightness()) return FunctionDatum::HomeAndSlope;
  return symbol.is_transverse() ? FunctionDatum::Mean : FunctionDatum::Home;
}
constexpr bool has_free_slope(const ErrorSymbol& symbol) {
  return datum_of(symbol) != FunctionDatum::HomeAndSlope;
}

/// Unit in which a component is printed: "um" or "urad".
std::string_view edge_unit(Component component);

}  // namespace volcal
