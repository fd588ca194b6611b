#include "volcal/identify/criticism/search/drawing.h"

#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/errors_first.h"
#include "volcal/identify/criticism/search/explained.h"
#include "volcal/identify/criticism/search/unknown_findings.h"

namespace volcal {
namespace {

/// Not beside error functions that came back: the model that is fitted with them holds more of each than the
/// search does, and what it leaves is for the next diagnosis.
bool may_draw(const Reached& from) {
  return static_cast<int>(from.base.surfaces().size()) < kThresholds.most_surfaces &&
         !any_function_came_back(from.state);
}

std::vector<FamilyTest> kept_beside(const OneCause& cause, const Reached& from) {
  std::vector<FamilyTest> kept;
  for (std::size_t i = 0; i < from.state.added().size(); ++i) {
    if (!cause.replaces.contains(i)) kept.push_back(from.state.added()[i].test);
  }
  return kept;
}

std::vector<SurfaceTest> surfaces_but(std::size_t place, const Reached& from) {
  const std::vector<AddedSurface>& all = from.base.surfaces();
  std::vector<SurfaceTest> others;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k != place) others.push_back({all[k].spec, all[k].effect, all[k].finding, all[k].log_evidence});
  }
  return others;
}

/// With a further surface, beside these effects.
Reached drawn(Reached from, const SurfaceTest& surface, const std::vector<FamilyTest>& kept) {
  from.restart_with(kept);
  from.begin_from(from.base.with_surface(surface, from.state.added()));
  from.restart_with(kept);
  from.begin_anew();
  return from;
}

}  // namespace

std::optional<Reached> Drawing::one_cause(const Reached& from) const {
  if (!may_draw(from) || from.state.added().size() < 2 || !from.rules().follows(SearchRule::OneCause))
    return std::nullopt;
  options_.report("one cause in the place of two", 0.9);
  const std::optional<OneCause> cause = one_cause_of_two(from.state);
  if (!cause) return std::nullopt;
  from.rules().tell(SearchRule::OneCause);
  Reached next = drawn(from, cause->surface, kept_beside(*cause, from));
  next.in_place_of_names.insert(cause->surface.effect->name());
  return next;
}

std::optional<Reached> Drawing::surface(const Reached& from) const {
  if (!may_draw(from) || !from.rules().follows(SearchRule::Surfaces)) return std::nullopt;
  const std::vector<UnknownFinding> findings = unknown_findings(from.state, from.rejected);
  if (findings.empty()) return std::nullopt;
  options_.report("a surface for what has no name", 0.9);
  const std::optional<SurfaceTest> surface = best_surface(from.state, findings);
  if (!surface) return std::nullopt;
  from.rules().tell(SearchRule::Surfaces);
  return drawn(from, *surface, added_tests(from.state.added()));
}

std::optional<Reached> Drawing::wider_surface(const Reached& from) const {
  if (from.base.surfaces().empty() || from.state.added().empty() ||
      !from.rules().follows(SearchRule::WiderSurface))
    return std::nullopt;
  options_.report("one surface in the place of one and a name", 0.9);
  const std::optional<OneCause> cause = one_cause_of_surface_and_name(from.state);
  if (!cause) return std::nullopt;
  from.rules().tell(SearchRule::WiderSurface);
  std::vector<SurfaceTest> surfaces = surfaces_but(*cause->replaces_surface, from);
  surfaces.push_back(cause->surface);
  Reached next = rebuilt(from, surfaces, kept_beside(*cause, from));
  next.in_place_of_names.insert(cause->surface.effect->name());
  return explained(std::move(next), options_);
}

Reached Drawing::names_for_surfaces(Reached from) const {
  if (!from.rules().follows(SearchRule::ReplacedSurfaces)) return from;
  for (std::size_t i = 0; i < from.base.surfaces().size();) {
    const std::vector<AddedSurface>& all = from.base.surfaces();
    if (all.size() == 1 && from.state.added().size() == from.names_before_surfaces) return from;
    if (from.in_place_of_names.contains(all[i].effect->name())) {
      ++i;
      continue;
    }
    options_.report("names in the place of " + effect_label(*all[i].effect), 0.9);
    from.rules().tell(SearchRule::ReplacedSurfaces);
    Reached next = rebuilt(from, surfaces_but(i, from), added_tests(from.state.added()));
    next = explained(std::move(next), options_);
    if (!next.something_exceeds() && unknown_findings(next.state, next.rejected).empty()) {
      from = std::move(next);
      continue;
    }
    from.rejected_before = std::move(next.rejected_before);
    ++i;
  }
  return from;
}

Reached rebuilt(Reached from, const std::vector<SurfaceTest>& surfaces,
                const std::vector<FamilyTest>& effects) {
  const std::vector<AddedEffect> beside = from.state.added();
  from.begin_from(from.given);
  for (const SurfaceTest& surface : surfaces) from.begin_from(from.base.with_surface(surface, beside));
  from.restart_with(effects);
  from.begin_anew();
  return from;
}

}  // namespace volcal
