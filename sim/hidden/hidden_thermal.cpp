#include <algorithm>
#include <cmath>

#include "volcal/sim/hidden/hidden_settings.h"

namespace volcal::sim {
namespace {

const Eigen::Vector3d kDownTheSpindle{0.0, 0.0, -1.0};

void scale_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.set_scale_expansion(settings.linear_axis("axis"), settings.amplitude(),
                                    settings.channel("channel").name);
}

void common_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  for (const AxisName axis : settings.linear_axes("axes"))
    scene.machine.set_scale_expansion(axis, settings.amplitude(), settings.channel("channel").name);
}

void common_growth(const HiddenSettings& settings, HiddenScene& scene) {
  const double time_constant = settings.positive("time_constant");
  for (const AxisName axis : settings.linear_axes("axes")) {
    scene.machine.add_state_error(
        positioning_of(axis), [a = settings.amplitude(), time_constant, home = settings.home(axis),
                               q = settings.position(axis)](const MachineState& state) {
          return a * (q(state) - home) * (1.0 - std::exp(-state.time / time_constant));
        });
  }
}

/// Tools that an optional key leaves.
OccasionTest with_tool(const HiddenSettings& settings) {
  if (!settings.has("tool")) return [](const Occasion&) { return true; };
  return [tool = settings.tool()](const Occasion& occasion) { return occasion.plan.tool == tool; };
}

void add_growth(const HiddenSettings& settings, const StateNumber& growth, HiddenScene& scene) {
  const Eigen::Vector3d full = settings.amplitude() * settings.direction(kDownTheSpindle);
  scene.interference.tool.emplace_back(
      [full, growth, grows = with_tool(settings)](const Occasion& occasion) -> Eigen::Vector3d {
        return grows(occasion) ? Eigen::Vector3d(full * growth(occasion.state)) : Eigen::Vector3d::Zero();
      });
}

void tool_growth(const HiddenSettings& settings, HiddenScene& scene) {
  const double time_constant = settings.positive("time_constant");
  add_growth(
      settings,
      [time_constant](const MachineState& state) { return 1.0 - std::exp(-state.time / time_constant); },
      scene);
}

void tool_growth_channel(const HiddenSettings& settings, HiddenScene& scene) {
  add_growth(settings, settings.excess_temperature("channel"), scene);
}

void tool_growth_on_off(const HiddenSettings& settings, HiddenScene& scene) {
  const double time_constant = settings.positive("time_constant");
  const double off = settings.positive("off");
  add_growth(
      settings,
      [=](const MachineState& state) {
        const double on = std::min(state.time, off);
        return (1.0 - std::exp(-on / time_constant)) * std::exp(-(state.time - on) / time_constant);
      },
      scene);
}

void thermal_tilt(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(
      settings.symbol(),
      [a = settings.amplitude(), excess = settings.excess_temperature("channel"),
       u = settings.share_or_one("by")](const MachineState& state) { return a * excess(state) * u(state); });
}

void lagged_temperature(const HiddenSettings& settings, HiddenScene& scene) {
  const double time_constant = settings.positive("time_constant");
  scene.machine.add_state_error(
      settings.symbol(), [=, a = settings.amplitude(), channel = settings.channel("channel"),
                          u = settings.share_or_one("by")](const MachineState& state) {
        if (state.settled) return 0.0;
        return a * u(state) * (channel.lagged(state.time, time_constant) - kReferenceTemperature);
      });
}

void squareness_drift(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_location_change(
      settings.location_symbol(),
      [a = settings.amplitude()](const MachineState& state) { return a * hours(state); });
}

void squareness_channel(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_location_change(
      settings.location_symbol(), [a = settings.amplitude(), excess = settings.excess_temperature("channel")](
                                      const MachineState& state) { return a * excess(state); });
}

}  // namespace

std::vector<HiddenKind> hidden_thermal_kinds() {
  const KeySchema channel = text_key("channel", "temperature channel");
  const KeySchema tool = text_key("tool", "this tool only", false);
  const KeySchema direction = vector_key("direction", "of the growth; absent = [0, 0, -1]");
  const KeySchema location = {"symbol", KeyType::Text, true, "location error, such as EC0Y"};
  return {
      {"scale-expansion",
       "thermal",
       "positioning += a dT (q - home)",
       {axis_key("axis", "its scale"), channel},
       "um_per_m_K",
       "",
       scale_expansion},
      {"common-expansion",
       "thermal",
       "positioning of each axis += a dT (q - home)",
       {text_key("axes", "\"X Y Z\""), channel},
       "um_per_m_K",
       "",
       common_expansion},
      {"common-growth",
       "thermal",
       "positioning of each axis += a (q - home) (1 - exp(-t / time_constant)) since the campaign's start",
       {text_key("axes", "\"X Y Z\""), number_key("time_constant_s", "of the warming up")},
       "um_per_m",
       "",
       common_growth},
      {"tool-growth",
       "thermal",
       "tool offset += a (1 - exp(-t / time_constant)) direction, since the campaign's start",
       {number_key("time_constant_s", "of the warming up"), tool, direction},
       "um",
       "",
       tool_growth},
      {"tool-growth-channel",
       "thermal",
       "tool offset += a dT direction",
       {channel, tool, direction},
       "um",
       "K",
       tool_growth_channel},
      {"thermal-tilt",
       "thermal",
       "E += a dT, times u of `by` if given",
       {symbol_key(), channel, axis_key("by", "grows along this axis", false)},
       "",
       "K",
       thermal_tilt},
      {"lagged-temperature",
       "thermal",
       "E += a (T1 - 20 degC), times u of `by` if given; T1 follows the channel with `time_constant`",
       {symbol_key(), channel, number_key("time_constant_s", "of the lag"),
        axis_key("by", "grows along this axis", false)},
       "",
       "K",
       lagged_temperature},
      {"squareness-drift", "thermal", "location error += a h", {location}, "", "hour", squareness_drift},
      {"squareness-channel",
       "thermal",
       "location error += a dT",
       {location, channel},
       "",
       "K",
       squareness_channel},
      {"tool-growth-on-off",
       "unlisted",
       "tool offset += a (1 - exp(-min(t, off) / time_constant)) direction, decaying alike after off",
       {number_key("time_constant_s", "of warming and cooling"), number_key("off_s", "spindle stops"), tool,
        direction},
       "um",
       "",
       tool_growth_on_off},
  };
}

}  // namespace volcal::sim
