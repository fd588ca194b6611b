#pragma once
/// Draws surfaces and curves where names do not explain the readings.
///
/// In: how far a search has come, names explained. Out: the same with another base and the effects that are
/// kept beside it, or nothing where no surface explains more. A curve may take the place of two names, a
/// surface of more variables that of a surface and a name (one_cause.h); in the end, where other surfaces or
/// names came in, names are tried in the place of each surface. Margins: thresholds.h.

#include <optional>
#include <vector>

#include "volcal/identify/criticism/search/one_cause.h"
#include "volcal/identify/criticism/search/reached.h"
#include "volcal/identify/criticism/search/surface_search.h"

namespace volcal {

class Drawing {
 public:
  /// `options` outlive the object.
  explicit Drawing(const SearchOptions& options) : options_(options) {}

  /// Where two names stand for one cause whose shape no name has. Not explained yet.
  std::optional<Reached> one_cause(const Reached& from) const;
  /// For what exceeds and has no name. Not explained yet.
  std::optional<Reached> surface(const Reached& from) const;
  /// Where a surface lacks a variable that a name took up. Explained.
  std::optional<Reached> wider_surface(const Reached& from) const;
  /// With other surfaces and names in the model, names may explain what a surface was drawn for. Explained.
  Reached names_for_surfaces(Reached from) const;

 private:
  const SearchOptions& options_;
};

/// The given model with these surfaces and effects instead; what was learned of names is forgotten.
Reached rebuilt(Reached from, const std::vector<SurfaceTest>& surfaces,
                const std::vector<FamilyTest>& effects);

}  // namespace volcal
