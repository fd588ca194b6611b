#pragma once
/// Compensation in a closed loop: a simulated machine with reversal, its error functions outside every fitted
/// basis, is measured, identified, and compensated with the files of every format and type; the exact machine
/// that applies them (sim/machine/control.h) is judged at fresh points from both sides and measured again
/// with other setups. Machine i has structure i mod 4 of sim::reference_machines() and seed `seed` + i.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace volcal::studies {

struct CompensationStudyOptions {
  int machines = 3;
  std::uint64_t seed = 1;
  bool small = false;                ///< 1,920 readings a campaign instead of 6,048, fewer fresh points
  std::vector<std::string> formats;  ///< empty = all
  int threads = 0;                   ///< 0 = all; results do not depend on it
  std::function<void(int done, int all)> progress;
};

/// Volumetric errors are sqrt(mean |e|^2) of the functional point at the fresh points, each approached from +
/// and - in all combinations, after the best rigid motion; m.
struct CompensationStudyRow {
  std::string structure;
  std::string format;
  std::string type;
  std::string variant;  ///< what is otherwise than by the book; empty = nothing
  double before = 0.0;
  double ideal = 0.0;         ///< ideal compensation of that type of the true errors
  double ideal_format = 0.0;  ///< the same in a format that tells no directions apart
  double applied = 0.0;       ///< the files, applied by the machine
  double read_before =
      0.0;  ///< RMS of readings of other setups against the nominal machine; NaN = not measured
  double read_after = 0.0;
};

/// Tool that everything is compensated for and judged with.
inline constexpr const char* kCompensatedTool = "side_x";

/// In the order of the machines, formats and types. Repeatable to the bit.
std::vector<CompensationStudyRow> compensation_study(const CompensationStudyOptions& options);

}  // namespace volcal::studies
