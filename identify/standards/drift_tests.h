#pragma once
/// Setups in which nothing moves while time goes on: drift at rest (iso230_3.h). Displacements of a sphere
/// (columns dx, dy, dz), rotations, displacements along a beam; two setups of displacements, read at the same
/// times with the tool points apart, give tilts.

#include <span>
#include <vector>

#include "volcal/identify/standards/setup_values.h"
#include "volcal/identify/standards/standard_figures.h"

namespace volcal {

/// `values`: one entry per setup.
std::vector<DriftTest> drift_tests(const Campaign& campaign, std::span<const SetupValues> values);

}  // namespace volcal
