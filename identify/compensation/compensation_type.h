#pragma once
/// Types of geometrical compensation of linear axes (ISO/TR 16907:2015, 8.2.2 to 8.2.7) as sets of what they
/// correct. Rotary axes stand at 0; the types for them (R-...) and for the functional orientation (FOR,
/// L-VOL+) move rotary axes and are refused with the reason.

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace volcal {

/// What a type corrects of the volumetric error e(q) of the functional point. D_i(q_i) is the error along the
/// specific line of axis i: the line through one point of the volume, the other axes standing there.
enum class CompensationPart {
  Positioning,   ///< L-POS: component of D_i along axis i
  Straightness,  ///< L-STR: components of D_i across axis i, less their least-squares slopes over the travel
  Squareness,    ///< L-SQU: of those slopes, the three that are angles between the axes
  Angular        ///< L-ANG: e minus the sum of all D_i, what EA, EB, EC do away from the specific lines
};
inline constexpr std::array<CompensationPart, 4> kCompensationParts = {
    CompensationPart::Positioning, CompensationPart::Straightness, CompensationPart::Squareness,
    CompensationPart::Angular};

/// A type or a combination of types. L-VOL contains the other four, and turns the machine frame as the datum
/// says, which no accuracy of the machine depends on.
class CompensationType {
 public:
  constexpr CompensationType() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): a part alone is a type
  constexpr CompensationType(CompensationPart part) : bits_(bit(part)) {}
  static constexpr CompensationType volumetric() { return CompensationType(kAllParts | kFrame); }

  /// "L-POS", "L-POS+L-STR", "L-VOL"; upper or lower case. Throws InputError naming what is known, or why a
  /// type of ISO/TR 16907 cannot be had.
  static CompensationType parse(std::string_view text);
  std::string name() const;

  constexpr bool has(CompensationPart part) const { return (bits_ & bit(part)) != 0; }
  constexpr bool is_volumetric() const { return (bits_ & kFrame) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  /// True when `other` corrects nothing that this one does not.
  constexpr bool contains(CompensationType other) const { return (other.bits_ & ~bits_) == 0; }
  /// Corrections of each axis depend on the position of one axis at a time.
  constexpr bool is_separable() const { return !has(CompensationPart::Angular); }
  friend constexpr CompensationType operator|(CompensationType a, CompensationType b) {
    return CompensationType(a.bits_ | b.bits_);
  }
  friend constexpr bool operator==(CompensationType, CompensationType) = default;

 private:
  static constexpr unsigned kAllParts = 0xF;
  static constexpr unsigned kFrame = 0x10;
  static constexpr unsigned bit(CompensationPart part) { return 1U << static_cast<unsigned>(part); }
  constexpr explicit CompensationType(unsigned bits) : bits_(bits) {}

  unsigned bits_ = 0;
};

struct CompensationTypeInfo {
  CompensationType type;
  std::string_view name;     ///< "L-POS"
  std::string_view clause;   ///< of ISO/TR 16907:2015
  std::string_view errors;   ///< which of the 21 errors it is computed from
  std::string_view summary;  ///< one sentence for the user
};
/// L-POS, L-STR, L-SQU, L-ANG, L-VOL.
std::span<const CompensationTypeInfo> compensation_types();

}  // namespace volcal
