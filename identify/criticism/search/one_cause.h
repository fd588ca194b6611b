#pragma once
/// One cause in the place of two: a shape that no name has looks like the nearest name and, where the noise
/// hides most of the difference, like another that takes up the rest; a surface of too few variables leaves
/// to a name what the variables that it lacks move.
///
/// In: a state with two or more added effects. Out: the curve or surface of one name's drivers on its target
/// that explains as much as that name and another together. Both are judged by log evidence over the model
/// without the two, natural, at the state's noise: the names pay ln n / 2 for every parameter, n readings,
/// and ln m each for the choice among m families (Schwarz 1978, Ann. Stat. 6, 461; Chen and Chen 2008,
/// Biometrika 95, 759), the surface has its marginal likelihood and pays for one choice. Two causes that are
/// there explain more together than a function of the drivers of one. A surface and a name are judged alike:
/// the surface by its own marginal likelihood, the one of all their variables on its target in their place.
/// Valid near the fit.

#include <optional>
#include <set>

#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/criticism/search/surface_search.h"

namespace volcal {

struct OneCause {
  SurfaceTest surface;
  std::set<std::size_t> replaces;               ///< of the added effects, by their places
  std::optional<std::size_t> replaces_surface;  ///< of the state's surfaces, by its place
};

/// The one whose evidence exceeds that of its names most, by half of what tells two names apart
/// (thresholds.h) or more; nothing where none does. Names of one function of the same drivers are not asked.
std::optional<OneCause> one_cause_of_two(const ModelState& state);

/// The same for a surface of one variable and a name, whose drivers add one to it.
std::optional<OneCause> one_cause_of_surface_and_name(const ModelState& state);

}  // namespace volcal
