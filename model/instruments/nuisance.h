#pragma once
/// Nuisance blocks and directions that several instruments share.

#include <optional>
#include <string>

#include "volcal/model/instruments/instrument.h"

namespace volcal {

/// One free or prior-held scalar.
NuisanceBlock scalar_nuisance(std::string name, double guess, double prior_sigma = 0.0,
                              bool is_angle = false);
/// A point in workpiece coordinates, m. `prior_sigma` 0 = none.
NuisanceBlock point_nuisance(std::string name, const Eigen::Vector3d& guess_w, double prior_sigma);
/// Shared relative length error of an instrument, present when `scale_sigma_um_per_m` is given.
std::optional<NuisanceBlock> length_scale_nuisance(const Setup& setup);

/// Keys `scale_sigma_um_per_m` and `scale_group` of every instrument that measures lengths.
std::vector<KeySchema> length_scale_keys();
/// Noise keys `constant_um` and `per_metre_um`.
std::vector<KeySchema> length_noise_keys();

/// Unit vector from the first commanded point to the last, or to the farthest when the pass returns to its
/// start; nullopt when the commanded points coincide.
std::optional<Eigen::Vector3d> line_direction(const std::vector<Eigen::Vector3d>& points);

/// Normalised `direction`-like option; fails when it has no length.
Eigen::Vector3d unit_direction(const SetupContext& context, const std::string& stem);

}  // namespace volcal
