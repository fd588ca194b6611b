#pragma once
/// Options of `volcal align` and `volcal tables` that turn a result to another machine coordinate system.

#include <CLI/App.hpp>
#include <optional>
#include <string>

#include "volcal/identify/errors/alignment.h"

namespace volcal::cli {

struct AlignmentArguments {
  std::string primary;
  std::string secondary;
  std::string origin;
  std::string align;
  std::string spindle_tilt;

  bool any() const { return !(primary + secondary + origin + align + spindle_tilt).empty(); }
};

void add_alignment_options(CLI::App& app, AlignmentArguments& arguments);

/// What the options ask for; axes that they leave out are those of the result. Throws InputError.
Alignment alignment_of(const FitResult& result, const AlignmentArguments& arguments);

}  // namespace volcal::cli
