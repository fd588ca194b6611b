#include <cmath>

#include "volcal/sim/hidden/hidden_settings.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {
namespace {

void cross_axis(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(
      settings.symbol(),
      [a = settings.amplitude(), u = settings.share(settings.other_axis("by")),
       power = settings.power()](const MachineState& state) { return a * std::pow(u(state), power); });
}

void cross_product(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName first = settings.axis("by");
  const AxisName second = settings.axis("and");
  if (first == second) settings.fail("\"by\" and \"and\" name one axis", "use kind cross-axis with a power");
  scene.machine.add_state_error(
      settings.symbol(), [a = settings.amplitude(), u = settings.share(first), v = settings.share(second)](
                             const MachineState& state) { return a * u(state) * v(state); });
}

void foundation_tilt(const HiddenSettings& settings, HiddenScene& scene) {
  const std::string about = settings.text("about", "y");
  const int direction = about == "x" ? 0 : about == "y" ? 1 : 2;
  const Eigen::Vector3d pivot = settings.vector("pivot", settings.middle_of_travel());
  scene.interference.instrument.emplace_back(
      [=, a = settings.amplitude(), u = settings.share(settings.axis("by")), power = settings.power()](
          const Occasion& occasion, InstrumentTruth& truth) {
        const double tilt = a * std::pow(u(occasion.state), power);
        truth.floor =
            truth.floor * translation(pivot) * rotation_about(direction, tilt) * translation(-pivot);
      });
}

void tool_load(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(
      settings.symbol(), [a = settings.amplitude(), tool = settings.tool(), u = settings.share_or_one("by")](
                             const MachineState& state) { return state.tool == tool ? a * u(state) : 0.0; });
}

}  // namespace

std::vector<HiddenKind> hidden_structure_kinds() {
  const KeySchema by = axis_key("by", "axis on whose position it depends");
  const KeySchema power = number_key("power", "1, 2 or 3; absent = 1", false);
  return {
      {"cross-axis",
       "structure",
       "E += a u^power, u of another axis than the symbol's",
       {symbol_key(), by, power},
       "",
       "full travel",
       cross_axis},
      {"cross-product",
       "structure",
       "E += a u v, u of the axis `by`, v of the axis `and`",
       {symbol_key(), by, axis_key("and", "the other axis")},
       "",
       "full travel of both",
       cross_product},
      {"foundation-tilt",
       "structure",
       "the machine turns by a u^power against the floor, on which trackers stand and to which levels refer",
       {by,
        power,
        {"about", KeyType::Text, true, "direction about which it tilts", {"x", "y", "z"}},
        vector_key("pivot_mm", "point that stays; absent = middle of the travel")},
       "urad",
       "full travel",
       foundation_tilt},
      {"tool-load",
       "structure",
       "E += a with one tool, times u of `by` if given",
       {symbol_key(), text_key("tool", "the heavy tool"), axis_key("by", "grows along this axis", false)},
       "",
       "",
       tool_load},
  };
}

}  // namespace volcal::sim
