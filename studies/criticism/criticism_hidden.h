#pragma once
/// Hidden effects with all their keys drawn from plausible ranges.

#include <span>
#include <string>

#include "volcal/sim/machine/random.h"
#include "volcal/sim/study.h"

namespace volcal::studies {

/// Kinds of sim/ that the catalogue holds, and kinds that it does not.
std::span<const std::string> listed_kinds();
std::span<const std::string> unlisted_kinds();
/// One cause with one amplitude in several setups or stations: "dead-path-air at a station".
std::span<const std::string> shared_kinds();
/// One cause with one amplitude on several axes.
std::span<const std::string> kinds_over_axes();

/// Kind of the catalogue for a listed kind of sim/.
std::string catalogue_kind(const std::string& hidden_kind);

/// `study` holds machine, environment and measurements already. A kind may come with keys that make it
/// another effect: "thermal-tilt by" is a tilt that grows along an axis, which is in no catalogue.
sim::HiddenEffect random_effect(const std::string& kind, const sim::Study& study, sim::RandomStream& random);
/// Of the first axis, channel and so on, for kinds with neither shape nor direction.
sim::HiddenEffect first_of_kind(const std::string& kind, const sim::Study& study);

}  // namespace volcal::studies
