#pragma once
/// Along which something without a name may act: a workpiece axis, or the line of sight of an instrument.

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace volcal {

enum class ScanDirection { X, Y, Z, Beam };
inline constexpr std::array<ScanDirection, 4> kScanDirections = {ScanDirection::X, ScanDirection::Y,
                                                                 ScanDirection::Z, ScanDirection::Beam};

constexpr std::size_t index_of(ScanDirection direction) { return static_cast<std::size_t>(direction); }

/// As results and reports call them, in the order of kScanDirections.
inline constexpr std::array<std::string_view, 4> kScanDirectionNames = {"X", "Y", "Z", "beam"};
constexpr std::string_view name_of(ScanDirection direction) {
  return kScanDirectionNames[index_of(direction)];
}

constexpr std::optional<ScanDirection> scan_direction_from(std::string_view name) {
  for (const ScanDirection direction : kScanDirections) {
    if (name_of(direction) == name) return direction;
  }
  return std::nullopt;
}

}  // namespace volcal
