#pragma once
/// Types of geometrical compensation (ISO/TR 16907:2015, 8.2) as sets of what they correct. The linear types
/// (L-...) and the rotary ones (R-...) are named after the axes whose errors they correct; R-POS and FOR
/// alone move rotary axes, all else is done by the linear axes.

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace volcal {

/// What a type corrects of the volumetric error e(q) of the functional point. D_i(q_i) is the error along the
/// specific line of axis i: the line through one point of the volume, the other axes standing there. Of the
/// rotary axes, with e, eps the error motions at a position, x the functional point from the axis' centre and
/// ref the axis' reference point (five_axis_compensation.h).
enum class CompensationPart {
  Positioning,        ///< L-POS: component of D_i along axis i
  Straightness,       ///< L-STR: components of D_i across axis i, less their least-squares slopes
  Squareness,         ///< L-SQU: of those slopes, the three that are angles between the axes
  Angular,            ///< L-ANG: e minus the sum of all D_i, what EA, EB, EC do away from the specific lines
  RotaryPositioning,  ///< R-POS: rotation about the axis itself, positioning and zero position
  RotaryRadialAxial,  ///< R-RAX: e + tilt x ref, the displacement at the reference point
  RotaryLocation,     ///< R-POR: position and orientation of the axis average line
  RotaryAngular,      ///< R-ANG: tilt x (x - ref), what tilt does away from the reference point
  Orientation         ///< FOR: direction of the tool's axis, by two rotary axes
};
inline constexpr std::array<CompensationPart, 4> kLinearCompensationParts = {
    CompensationPart::Positioning, CompensationPart::Straightness, CompensationPart::Squareness,
    CompensationPart::Angular};

/// A type or a combination of types. L-VOL contains the other four linear ones, and turns the machine frame
/// as the datum says, which no accuracy of the machine depends on. R-VOL is R-POS, R-RAX, R-POR and R-ANG
/// with one reference point. L-VOL+ and R-VOL+ are these with FOR.
class CompensationType {
 public:
  constexpr CompensationType() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a part alone is a type
  constexpr CompensationType(CompensationPart part) : bits_(bit(part)) {}
  static constexpr CompensationType volumetric() { return CompensationType(kLinearBits); }         ///< L-VOL
  static constexpr CompensationType rotary_volumetric() { return CompensationType(kRotaryBits); }  ///< R-VOL

  /// "L-POS", "L-POS+L-STR", "L-VOL", "L-VOL+R-VOL+"; upper or lower case. Throws InputError naming what is
  /// known, or why a type of ISO/TR 16907 cannot be had.
  static CompensationType parse(std::string_view text);
  std::string name() const;

  constexpr bool has(CompensationPart part) const { return (bits_ & bit(part)) != 0; }
  constexpr bool is_volumetric() const { return (bits_ & kFrame) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  /// True when `other` corrects nothing that this one does not.
  constexpr bool contains(CompensationType other) const { return (other.bits_ & ~bits_) == 0; }
  /// Corrections of the linear axes' errors depend on the position of one axis at a time.
  constexpr bool is_separable() const { return !has(CompensationPart::Angular); }
  /// Of the errors of linear axes.
  constexpr CompensationType linear() const { return CompensationType(bits_ & kLinearBits); }
  /// The rest: R-types and FOR.
  constexpr CompensationType rotary() const { return CompensationType(bits_ & ~kLinearBits); }
  friend constexpr CompensationType operator|(CompensationType a, CompensationType b) {
    return CompensationType(a.bits_ | b.bits_);
  }
  friend constexpr bool operator==(CompensationType, CompensationType) = default;

 private:
  static constexpr unsigned bit(CompensationPart part) { return 1U << static_cast<unsigned>(part); }
  static constexpr unsigned kFrame = 0x10000;
  static constexpr unsigned kLinearBits = 0xF | kFrame;
  static constexpr unsigned kRotaryBits = 0xF0;
  constexpr explicit CompensationType(unsigned bits) : bits_(bits) {}

  unsigned bits_ = 0;
};

struct CompensationTypeInfo {
  CompensationType type;
  std::string_view name;     ///< "L-POS"
  std::string_view clause;   ///< of ISO/TR 16907:2015
  std::string_view errors;   ///< which errors it is computed from
  std::string_view summary;  ///< one sentence for the user
};
/// Every type of ISO/TR 16907, 8.2, but those special to one machine (L-SPEC, R-SPEC).
std::span<const CompensationTypeInfo> compensation_types();

}  // namespace volcal
