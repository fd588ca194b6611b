#include "volcal/identify/cli/options/alignment_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <vector>

#include "volcal/identify/cli/options/axis_position.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

const std::vector<std::string> kLinearAxisNames = {"X", "Y", "Z"};

AxisName axis_named(const std::string& letter) { return *axis_from_letter(letter[0]); }

/// A=12,B=-5 in urad, as (A, B) in rad.
Eigen::Vector2d tilt_of(const std::string& text) {
  const std::string remedy = "write A=12,B=-5, rotations about x and y in urad";
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();
  for (const std::string& part : CLI::detail::split(text, ',')) {
    double value = 0.0;
    const bool shaped = part.size() > 2 && (part[0] == 'A' || part[0] == 'B') && part[1] == '=' &&
                        CLI::detail::lexical_cast(part.substr(2), value) && std::isfinite(value);
    if (!shaped) throw InputError({}, "--spindle-tilt " + text + ": \"" + part + "\" is not a tilt", remedy);
    double& component = tilt[part[0] == 'A' ? 0 : 1];
    if (component != 0.0)
      throw InputError({}, "--spindle-tilt " + text + ": " + part[0] + " is given twice", remedy);
    component = value * kMicro;
  }
  return tilt;
}

std::optional<AxisName> wished_axis(const std::string& letter) {
  return letter.empty() ? std::nullopt : std::optional(axis_named(letter));
}

}  // namespace

void add_alignment_options(CLI::App& app, AlignmentArguments& arguments) {
  app.add_option("--primary", arguments.primary,
                 "axis whose straight line is the machine frame's direction (ISO/TR 16907, 7.3); default: as "
                 "the result has it")
      ->check(CLI::IsMember(kLinearAxisNames));
  app.add_option("--secondary", arguments.secondary, "axis that lies in a plane of the machine frame")
      ->check(CLI::IsMember(kLinearAxisNames));
  app.add_option("--origin", arguments.origin,
                 "where every error motion is zero, X=500,Y=300,Z=0 in mm, axes not named at home");
  app.add_option(
         "--align", arguments.align,
         "what the frame's direction follows: axis = the straight line of the primary axis, spindle = "
         "the spindle, with Z as primary axis (10.2)")
      ->check(CLI::IsMember({"axis", "spindle"}));
  app.add_option("--spindle-tilt", arguments.spindle_tilt,
                 "with --align spindle: rotation of the spindle against the straight line of Z, A=12,B=-5 in "
                 "urad, as a test mandrel shows it without compensation; default: parallel");
}

Alignment alignment_of(const FitResult& result, const AlignmentArguments& arguments) {
  Alignment alignment;
  const bool spindle = arguments.align == "spindle";
  if (!spindle && !arguments.spindle_tilt.empty())
    throw InputError({}, "--spindle-tilt is given without --align spindle", "add --align spindle");
  alignment.datum = wished_datum(result.machine.datum, wished_axis(arguments.primary),
                                 wished_axis(arguments.secondary), spindle);
  if (!arguments.origin.empty())
    alignment.origin = axis_position("--origin", arguments.origin, result.machine);
  if (spindle)
    alignment.spindle_tilt =
        arguments.spindle_tilt.empty() ? Eigen::Vector2d(0.0, 0.0) : tilt_of(arguments.spindle_tilt);
  return alignment;
}

}  // namespace volcal::cli
