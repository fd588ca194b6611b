// Effects of bodies that are not rigid.
#include <cmath>
#include <optional>
#include <sstream>

#include "volcal/sim/known/known_kinds.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {
namespace {

void known_axis_coupling(const HiddenSettings& settings, HiddenScene& scene) {
  const std::string shape = settings.text("shape", "linear");
  const double power = shape == "cubic" ? 3.0 : shape == "quadratic" ? 2.0 : 1.0;
  add_motion(
      settings,
      [q = from_home(settings, settings.other_axis("axis")), power](const MachineState& state) {
        return std::pow(q(state), power);
      },
      scene);
}

/// Machine and workpiece turn about the middle of the travel, against the floor.
void known_foundation_tilt(const HiddenSettings& settings, HiddenScene& scene) {
  const std::string about = settings.text("about", "");
  const int direction = about == "x" ? 0 : about == "y" ? 1 : 2;
  const double power = settings.text("shape", "linear") == "quadratic" ? 2.0 : 1.0;
  scene.interference.instrument.emplace_back(
      [a = amplitude_of(settings), q = from_home(settings, settings.axis("axis")), power, direction,
       pivot = settings.middle_of_travel()](const Occasion& occasion, InstrumentTruth& truth) {
        truth.floor = truth.floor * translation(pivot) *
                      rotation_about(direction, a * std::pow(q(occasion.state), power)) * translation(-pivot);
      });
}

void known_product_coupling(const HiddenSettings& settings, HiddenScene& scene) {
  add_motion(settings,
             product_of(from_home(settings, settings.axis("axis")),
                        from_home(settings, settings.axis("second_axis"))),
             scene);
}

/// With one tool; without that key, in proportion to the length of every tool.
void known_tool_load(const HiddenSettings& settings, HiddenScene& scene) {
  if (!settings.has("tool"))
    return add_motion(
        settings,
        [tools = settings.machine().tools](const MachineState& state) {
          return tools[state.tool].offset.norm();
        },
        scene);
  add_motion(
      settings,
      [tool = settings.tool()](const MachineState& state) { return state.tool == tool ? 1.0 : 0.0; }, scene);
}

void known_triple_coupling(const HiddenSettings& settings, HiddenScene& scene) {
  StateNumber product = [](const MachineState& /*state*/) { return 1.0; };
  std::istringstream words(settings.text("axes", ""));
  for (std::string word; words >> word;) {
    const auto axis = word.size() == 1 ? axis_from_letter(word[0]) : std::nullopt;
    if (!axis) settings.fail("\"" + word + "\" is not an axis", "write axes = \"Y Z Z\" for y z^2");
    product = product_of(product, from_home(settings, *axis));
  }
  add_motion(settings, product, scene);
}

/// What gravity does to a body that tilts.
StateNumber load_of_tilt(const HiddenSettings& settings) {
  return [q = from_home(settings, settings.other_axis("axis")),
          is_sine = settings.text("shape", "sine") == "sine"](const MachineState& state) {
    return is_sine ? std::sin(q(state)) : 1.0 - std::cos(q(state));
  };
}

void known_tilt_load(const HiddenSettings& settings, HiddenScene& scene) {
  add_motion(settings, load_of_tilt(settings), scene);
}

void known_cradle_coupling(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  const StateNumber once_a_turn = [of_cosine = settings.number("cos", 0.0),
                                   of_sine = settings.number("sin", 0.0),
                                   q = from_home(settings, symbol.axis)](const MachineState& state) {
    return of_cosine * std::cos(q(state)) + of_sine * std::sin(q(state));
  };
  scene.machine.add_state_error(symbol, product_of(load_of_tilt(settings), once_a_turn));
}

}  // namespace

std::vector<KnownKind> known_structure_kinds() {
  return {
      {"axis-coupling", known_axis_coupling},
      {"cradle-coupling", known_cradle_coupling},
      {"foundation-tilt", known_foundation_tilt},
      {"product-coupling", known_product_coupling},
      {"tilt-load", known_tilt_load},
      {"tool-load", known_tool_load},
      {"triple-coupling", known_triple_coupling},
  };
}

}  // namespace volcal::sim
