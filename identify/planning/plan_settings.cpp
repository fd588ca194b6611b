#include "volcal/identify/planning/plan_settings.h"

#include <numeric>

#include "volcal/identify/planning/registry.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/parallel_axes.h"
#include "volcal/model/description/unknowns.h"

namespace volcal {

std::vector<std::size_t> tools_of(const PlanSettings& settings) {
  if (!settings.budget.tools.empty()) return settings.budget.tools;
  std::vector<std::size_t> all(settings.machine.tools.size() - settings.imagined_tools);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

std::vector<Tool> own_tools(const PlanSettings& settings) {
  std::vector<Tool> tools = settings.machine.tools;
  tools.resize(tools.size() - settings.imagined_tools);
  return tools;
}

ModelSpec with_known_linear_axes(ModelSpec model, const Machine& machine) {
  for (const ErrorSymbol symbol : linear_axis_motions(machine)) {
    model.functions[symbol] = FunctionSpec{};
    model.functions[symbol].basis = "zero";
  }
  model.locations_off = squareness_errors(machine);
  return model;
}

void check_plan_settings(const PlanSettings& settings) {
  require_no_parallel_axes(settings.machine, "a plan",
                           "plan for a machine file without it, and add positions of it by hand");
  const auto fail = [&](const std::string& problem, const std::string& remedy) {
    throw InputError({settings.machine.file, 0}, problem, remedy);
  };
  if (settings.machine.tools.empty()) {
    fail("the machine has no tool", "add a [tools.NAME] table to its file: where the reflector is held");
  }
  for (const AxisName axis : kLinearAxes) {
    if (!settings.machine.has_axis(axis)) {
      fail(std::string("the machine has no axis ") + letter_of(axis),
           "stations are planned for machines with X, Y and Z");
    }
  }
  if (!settings.budget.readings && !settings.budget.time) {
    fail("neither readings nor time are limited", "give --readings N, --time HOURS or both");
  }
  if (settings.budget.tool_count &&
      static_cast<std::size_t>(*settings.budget.tool_count) > tools_of(settings).size()) {
    fail("--tool-count asks for more tools than there are",
         "the machine file and --tools leave " + std::to_string(tools_of(settings).size()));
  }
  plan_instrument_of(settings).check(settings);
}

}  // namespace volcal
