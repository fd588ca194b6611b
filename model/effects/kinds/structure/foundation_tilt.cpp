// The machine's weight moves over a soft foundation: machine and workpiece tilt together against the floor.
// Instruments that stand on the floor, and levels, see a rotation; a ball-bar or an interferometer between
// spindle and table does not. Without instruments of the second kind it is the same as an error motion: the
// rotations of the axis next to the workpiece, functions of its own position or axis-coupling by another.
#include <algorithm>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

const std::string kDirections = "xyz";

/// Whether the instrument refers to the floor: trackers beside the machine, levels.
bool stands_on_floor(const Setup& setup) { return traits_of(setup).stands_on_floor(setup.options); }

bool some_stand_on_floor(const Campaign& campaign, bool wanted) {
  return std::ranges::any_of(campaign.setups,
                             [&](const Setup& setup) { return stands_on_floor(setup) == wanted; });
}

std::unique_ptr<FormulaEffect> make_foundation_tilt(const EffectTable& table) {
  const AxisName axis = table.axis("axis");
  const std::string about = table.text("about", "add about = \"y\"");
  const std::size_t direction = kDirections.find(about);
  if (about.size() != 1 || direction == std::string::npos)
    table.fail("\"" + about + "\" is not a direction", "write about = \"x\", \"y\" or \"z\"");
  const std::string shape = table.spec.options.text("shape").value_or("linear");
  if (shape != "linear" && shape != "quadratic")
    table.fail("\"" + shape + "\" is not a shape", "write linear or quadratic");
  const bool quadratic = shape == "quadratic";
  const std::string driver(1, lower_letter_of(axis));
  const std::string label = "foundation about " + about + " by " + driver + (quadratic ? "^2" : "");
  const EffectTarget target{
      .kind = TargetKind::Floor, .symbol = {}, .component = static_cast<int>(direction)};
  return std::make_unique<FormulaEffect>(
      EffectName{"foundation-tilt", TargetName::called("machine about " + about), position_of(axis), shape},
      std::vector<EffectAmplitude>{{.label = label,
                                    .target = target,
                                    .key = quadratic ? "amplitude_urad_per_m2" : "amplitude_urad_per_m",
                                    .guess = table.number("amplitude", 0.0)}},
      [axis, quadratic](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const Eigen::VectorXd position = positions_from_home(view, axis);
        if (!stands_on_floor(view.setup)) return Eigen::VectorXd::Zero(position.size());
        return quadratic ? Eigen::VectorXd(position.cwiseAbs2()) : position;
      },
      [axis, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, axis, label, place);
        if (some_stand_on_floor(campaign, true)) return;
        throw InputError(place, label + ": no setup refers to the floor",
                         "laser tracers, trackers and levels do; remove the effect");
      });
}

/// Only where some instruments see it and others do not: otherwise it is an error motion.
std::vector<EffectSpec> foundation_tilts(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (!some_stand_on_floor(campaign, true) || !some_stand_on_floor(campaign, false)) return specs;
  for (const AxisName axis : campaign.machine.linear_axes()) {
    for (const char about : kDirections) {
      for (const char* shape : {"linear", "quadratic"}) {
        specs.push_back(effect_spec("foundation-tilt", {{"axis", std::string(1, letter_of(axis))},
                                                        {"about", std::string(1, about)},
                                                        {"shape", std::string(shape)}}));
      }
    }
  }
  return specs;
}

}  // namespace

const EffectKind& foundation_tilt_effect() {
  static const FormulaKind kind(
      {.kind = "foundation-tilt",
       .summary =
           "machine and workpiece tilt against the floor as an axis moves its weight, about the middle "
           "of the travel: trackers on the floor and levels see it, a ball-bar does not; with "
           "instruments of one sort only it is an error motion of the axis next to the workpiece",
       .plain = "The whole machine tilts against the floor while axes move or time passes, which instruments "
                "on the floor see as an error.",
       .usual_causes = "machine feet that are loose or badly levelled; a thin or cracked floor; a vehicle, "
                       "crane or heavy workpiece beside the machine; an instrument whose stand settles",
       .source = "ISO/TR 16907:2015, 7.4.2 (non-rigid behaviour); ISO 230-1 (levels refer to gravity)",
       .keys = {axis_key("axis", "axis whose position it depends on, counted from home"),
                {.key = "about",
                 .type = KeyType::Text,
                 .required = true,
                 .help = "direction about which the machine turns",
                 .choices = {"x", "y", "z"}},
                {.key = "shape",
                 .type = KeyType::Text,
                 .help = "power of the position (default linear)",
                 .choices = {"linear", "quadratic"}},
                {.key = "amplitude_urad_per_m",
                 .help = "tilt per metre",
                 .plausible_min = 1e-6,
                 .plausible_max = 1e5},
                {.key = "amplitude_urad_per_m2",
                 .help = "tilt per metre^2",
                 .plausible_min = 1e-6,
                 .plausible_max = 1e5}}},
      make_foundation_tilt, foundation_tilts);
  return kind;
}

}  // namespace volcal
