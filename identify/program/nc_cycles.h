#pragma once
/// Drilling cycles G73, G81, G82, G83, G85 and G89 as rapids, feeds and dwells (NISTIR 6556, clause 3.5.16).
/// G85 feeds back to R and goes on as a rapid, as LinuxCNC 2.9. The clearance of G73 and G83 is 0.254 mm, as
/// in NISTIR 6556 and LinuxCNC; other controls set another one.

#include <vector>

#include "volcal/identify/program/nc_state.h"

namespace volcal {

inline constexpr double kPeckClearance = 0.254e-3;  ///< m
/// Pecks and repetitions of one block; more are refused as a slip.
inline constexpr int kMostCycleMotions = 10000;

/// G73 to G89.
bool is_cycle(int motion);

/// Appends the motions of a cycle block and moves the state. Throws InputError.
void append_cycle(int motion, const NcCommands& commands, const NcPlace& place, NcState& state,
                  std::vector<NcMotion>& motions);

}  // namespace volcal
