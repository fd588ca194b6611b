#pragma once
/// The standards' figures as text tables: readings and models in rows of their own.

#include <span>
#include <string>

#include "volcal/identify/standards/standard_figures.h"

namespace volcal {

/// Figures of one model under its name; the readings' figures are those of the first.
struct NamedFigures {
  std::string name;
  const StandardFigures* figures = nullptr;
};

/// Empty when the campaign has no test that a standard knows.
std::string standard_figures_text(std::span<const NamedFigures> models);

}  // namespace volcal
