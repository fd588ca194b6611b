// What temperature and time do to the machine: expansion of scales, drift and tilt of error motions, growth
// of the spindle and of screws, squareness that drifts.
#include <cmath>
#include <numbers>

#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kUsualTimeConstant = 1800.0;  // s
constexpr double kShortestTimeConstant = 120.0;
constexpr double kLongestTimeConstant = 10.0 * kSecondsPerHour;

std::string linear_axis_text(AxisName axis) { return std::string(1, letter_of(axis)); }

/// 1 - exp(-(t - start)/tau) from the campaign's first reading on.
Eigen::ArrayXd growth(const SetupView& view, double time_constant) {
  const double start = clock_start(view);
  return 1.0 - (-(times(view, start).array() - start) / time_constant).exp();
}

EffectShape time_constant(const EffectTable& table, const std::string& label) {
  EffectShape shape = shape_parameter(table, label + ": time constant", "time_constant", "s",
                                      kUsualTimeConstant, kShortestTimeConstant, kLongestTimeConstant);
  if (!(shape.value > 0.0)) table.fail("its time constant is not positive", "give time_constant_s = 1800.0");
  return shape;
}

std::unique_ptr<FormulaEffect> make_scale_expansion(const EffectTable& table) {
  const AxisName axis = table.axis("axis");
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = "expansion " + linear_axis_text(axis) + " by " + channel;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"scale-expansion", ErrorSymbol{positioning_component(axis), axis}, temperature_of(channel),
                 "linear"},
      std::vector<EffectAmplitude>{
          {.label = label,
           .target = {.kind = TargetKind::Motion, .symbol = {positioning_component(axis), axis}},
           .key = "amplitude_um_per_m_K",
           .guess = table.number("amplitude", 0.0)}},
      [axis, channel](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return positions_from_home(view, axis).cwiseProduct(temperature_excess(view, channel));
      },
      [axis, channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, axis, label, place);
        check_channel(campaign, channel, place);
      });
  effect->count_unrecorded(without_channel(channel));
  return effect;
}

std::vector<EffectSpec> scale_expansions(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const AxisName axis : campaign.machine.linear_axes()) {
    for (const std::string& channel : temperature_channels(campaign)) {
      specs.push_back(
          effect_spec("scale-expansion", {{"axis", linear_axis_text(axis)}, {"temperature", channel}}));
    }
  }
  return specs;
}

std::unique_ptr<FormulaEffect> make_thermal_drift(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = symbol.name() + " by " + channel;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"thermal-drift", symbol, temperature_of(channel), "linear"},
      std::vector{motion_amplitude(table, label, symbol, "per_K")},
      [channel](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return temperature_excess(view, channel);
      },
      [symbol, channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
        check_channel(campaign, channel, place);
      });
  effect->count_unrecorded(without_channel(channel));
  return effect;
}

std::vector<EffectSpec> thermal_drifts(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : motions_in_campaign(campaign)) {
    if (symbol.is_positioning() || symbol.is_straightness()) continue;
    for (const std::string& channel : temperature_channels(campaign)) {
      specs.push_back(effect_spec("thermal-drift", {{"symbol", symbol.name()}, {"temperature", channel}}));
    }
  }
  return specs;
}

std::unique_ptr<FormulaEffect> make_spindle_growth(const EffectTable& table) {
  const std::string label = "spindle growth";
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"spindle-growth", TargetName::of_tool(), Variable{Variable::Kind::Time}, "1-exp(-t/tau)"},
      vector_amplitudes(table, label, TargetKind::ToolOffset, "um"),
      [](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return growth(view, shape[0]).matrix().replicate(1, 3);
      },
      [label](const Campaign& campaign, const SourcePlace& place) { check_time(campaign, label, place); });
  effect->add_shape(time_constant(table, label));
  effect->count_unrecorded(without_time());
  return effect;
}

std::vector<EffectSpec> spindle_growths(const Campaign& campaign) {
  if (!has_time(campaign)) return {};
  return {effect_spec("spindle-growth", {})};
}

std::unique_ptr<FormulaEffect> make_tool_expansion(const EffectTable& table) {
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = "tool by " + channel;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"tool-expansion", TargetName::of_tool(), temperature_of(channel), "linear"},
      vector_amplitudes(table, label, TargetKind::ToolOffset, "um_per_K"),
      [channel](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return temperature_excess(view, channel).replicate(1, 3);
      },
      [channel](const Campaign& campaign, const SourcePlace& place) {
        check_channel(campaign, channel, place);
      });
  effect->count_unrecorded(without_channel(channel));
  return effect;
}

std::vector<EffectSpec> tool_expansions(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const std::string& channel : temperature_channels(campaign)) {
    specs.push_back(effect_spec("tool-expansion", {{"temperature", channel}}));
  }
  return specs;
}

std::unique_ptr<FormulaEffect> make_screw_heating(const EffectTable& table) {
  const AxisName axis = table.axis("axis");
  const ErrorSymbol symbol{positioning_component(axis), axis};
  const std::string label = "screw heating " + linear_axis_text(axis);
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"screw-heating", symbol, EffectDriver({{Variable::Kind::Time}, position_of(axis)}),
                 "1-exp(-t/tau)"},
      std::vector{motion_amplitude(table, label, symbol, "per_m")},
      [axis](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return positions_from_home(view, axis).array() * growth(view, shape[0]);
      },
      [axis, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, axis, label, place);
        check_time(campaign, label, place);
      });
  effect->add_shape(time_constant(table, label));
  effect->count_unrecorded(without_time());
  return effect;
}

std::vector<EffectSpec> screw_heatings(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (!has_time(campaign)) return specs;
  for (const AxisName axis : campaign.machine.linear_axes()) {
    specs.push_back(effect_spec("screw-heating", {{"axis", linear_axis_text(axis)}}));
  }
  return specs;
}

std::unique_ptr<FormulaEffect> make_squareness_drift(const EffectTable& table) {
  const std::string name = table.text("symbol", "add symbol = \"EC0Y\"");
  const auto location = LocationSymbol::parse(name);
  if (!location || !is_rotation(location->component) || is_rotary(location->axis) ||
      direction_of(location->component) == direction_of(location->axis)) {
    table.fail("\"" + name + "\" is not a squareness", "write EC0Y, EA0Z, EB0Z, or those of another datum");
  }
  const SquarenessMotion motion = motion_of_squareness(*location);
  const AxisName axis = location->axis;
  const std::string channel = table.spec.options.text("temperature").value_or("");
  const std::string label = "drift of " + name + (channel.empty() ? "" : " by " + channel);
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"squareness-drift", *location, temperature_or_time(channel), "linear"},
      std::vector<EffectAmplitude>{{.label = label,
                                    .target = {.kind = TargetKind::Motion, .symbol = motion.symbol},
                                    .key = channel.empty() ? "amplitude_urad_per_h" : "amplitude_urad_per_K",
                                    .guess = table.number("amplitude", 0.0)}},
      [axis, sign = motion.sign, channel](const SetupView& view,
                                          const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const double start = clock_start(view);
        const Eigen::ArrayXd driver = channel.empty() ? Eigen::ArrayXd(times(view, start).array() - start)
                                                      : temperature_excess(view, channel).array();
        const Eigen::Map<const Eigen::ArrayXd> position(view.setup.readings.position[index_of(axis)].data(),
                                                        static_cast<Eigen::Index>(view.rows()));
        return (sign * position * driver).matrix();
      },
      [axis, label, channel](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, axis, label, place);
        if (!channel.empty()) return check_channel(campaign, channel, place);
        check_time(campaign, label, place);
      });
  effect->count_unrecorded(channel.empty() ? without_time() : without_channel(channel));
  return effect;
}

std::vector<EffectSpec> squareness_drifts(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const LocationSymbol& symbol : squareness_errors(campaign.machine)) {
    if (has_time(campaign)) specs.push_back(effect_spec("squareness-drift", {{"symbol", symbol.name()}}));
    for (const std::string& channel : temperature_channels(campaign)) {
      specs.push_back(effect_spec("squareness-drift", {{"symbol", symbol.name()}, {"temperature", channel}}));
    }
  }
  return specs;
}

}  // namespace

const EffectKind& scale_expansion_effect() {
  static const FormulaKind kind(
      {.kind = "scale-expansion",
       .summary = "the scale of an axis expands with a temperature: alpha (T - 20 degC) per metre from home",
       .plain = "An axis becomes longer as it warms: its positions are wrong in proportion to the distance "
                "from home.",
       .usual_causes =
           "a scale or screw that follows the workshop's temperature; a thermal expansion coefficient that "
           "is missing or wrong in the control; a temperature sensor that sits elsewhere than the scale",
       .source = "ISO/TR 16907:2015, 8.3; ISO 230-3 (thermal effects)",
       .polynomial = true,
       .expands_scales = true,
       .keys = {axis_key("axis", "axis whose scale expands"),
                text_key("temperature", "channel: column T_<channel>_degC"),
                amplitude_key("amplitude_um_per_m_K", "coefficient of expansion")}},
      make_scale_expansion, scale_expansions);
  return kind;
}

const EffectKind& thermal_drift_effect() {
  static const FormulaKind kind(
      {.kind = "thermal-drift",
       .summary = "an error motion shifts with a temperature, column and ram tilt above all: a (T - 20 degC)",
       .plain = "An error motion shifts with a temperature, as the structure bends.",
       .usual_causes = "a column or ram that warms on one side by motor, sun or draught; a hydraulic unit or "
                       "cabinet beside the column; a hall whose temperature is layered",
       .source = "ISO 230-3 (distortion caused by temperature)",
       .polynomial = true,
       .keys = joined({{symbol_key("error motion that shifts: EAZ ..."),
                        text_key("temperature", "channel: column T_<channel>_degC")},
                       motion_amplitude_keys({"per_K"}, "shift per kelvin")})},
      make_thermal_drift, thermal_drifts);
  return kind;
}

const EffectKind& spindle_growth_effect() {
  static const FormulaKind kind(
      {.kind = "spindle-growth",
       .summary = "the spindle moves the tool as it warms up: a (1 - exp(-t/tau)) from the first reading on",
       .plain = "The spindle pushes the tool out as it warms up, fast at first and then ever slower.",
       .usual_causes = "heat of the spindle bearings or motor; measuring before the spindle was warm; a "
                       "spindle cooler that is off or set wrongly",
       .source = "ISO 230-3 (distortion caused by the rotating spindle)",
       .polynomial = true,
       .keys = joined({shape_keys("time_constant", "s", "tau"),
                       vector_amplitude_keys("um", "final displacement in tool coordinates")})},
      make_spindle_growth, spindle_growths);
  return kind;
}

const EffectKind& tool_expansion_effect() {
  static const FormulaKind kind(
      {.kind = "tool-expansion",
       .summary = "spindle or tool move with a temperature: a (T - 20 degC), tool coordinates",
       .plain = "Spindle or tool grow with a temperature.",
       .usual_causes = "heat of the spindle; coolant or air at another temperature than the machine; a long "
                       "tool or holder that follows the workshop's temperature",
       .source = "ISO 230-3 (distortion caused by the rotating spindle)",
       .polynomial = true,
       .keys = joined({{text_key("temperature", "channel: column T_<channel>_degC")},
                       vector_amplitude_keys("um_per_K", "displacement per kelvin")})},
      make_tool_expansion, tool_expansions);
  return kind;
}

const EffectKind& screw_heating_effect() {
  static const FormulaKind kind(
      {.kind = "screw-heating",
       .summary = "a ball screw warms up and stretches: a q (1 - exp(-t/tau)), q from home",
       .plain = "An axis becomes longer the longer it has been moving: its ball screw warms up.",
       .usual_causes = "fast traverses on an axis that is measured by its motor's encoder; too much preload "
                       "of nut or bearings; too little grease; a screw cooler that is off",
       .source = "ISO 230-3 (distortion caused by linear motion)",
       .polynomial = true,
       .keys = joined({{axis_key("axis", "axis that the screw drives")},
                       shape_keys("time_constant", "s", "tau"),
                       motion_amplitude_keys({"per_m"}, "final stretch per metre")})},
      make_screw_heating, screw_heatings);
  return kind;
}

const EffectKind& squareness_drift_effect() {
  static const FormulaKind kind(
      {.kind = "squareness-drift",
       .summary = "two axes turn against each other slowly: squareness changes in proportion to time or to a "
                  "temperature",
       .plain = "Two axes turn against each other slowly while the campaign is measured.",
       .usual_causes = "a column or crossbeam that warms on one side; a machine that settles on its feet; a "
                       "workpiece or fixture that loads one side",
       .source = "ISO 230-3 (environmental temperature variation)",
       .polynomial = true,
       .keys = {symbol_key("squareness that drifts: EC0Y, EA0Z, EB0Z"),
                text_key("temperature", "channel that drives it; absent = time", false),
                amplitude_key("amplitude_urad_per_h", "change per hour"),
                amplitude_key("amplitude_urad_per_K", "change per kelvin")}},
      make_squareness_drift, squareness_drifts);
  return kind;
}

}  // namespace volcal
