#include "volcal/identify/planning/plan_settings.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <set>

#include "volcal/identify/planning/registry.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/parallel_axes.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/conditions_of_effect.h"
#include "volcal/model/effects/effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

/// Rather than to the machine.
bool belongs_to_campaign(const EffectSpec& spec, const Effect& effect) {
  const auto is_named = [&spec](const char* key) { return spec.options.text(key).has_value(); };
  if (is_named("setup") || is_named("station") || is_named("only")) return true;
  return std::ranges::none_of(effect.amplitudes(), [](const EffectAmplitude& amplitude) {
    return amplitude.target.kind == TargetKind::Motion || amplitude.target.kind == TargetKind::ToolOffset;
  });
}

bool can_act(const Campaign& campaign, const Effect& effect) {
  try {
    effect.check(campaign, {});
  } catch (const InputError&) {
    return false;
  }
  return true;
}

/// Of the noise that the instrument knows.
void refuse_exact_readings(const PlanSettings& settings) {
  Setup setup;
  plan_instrument_of(settings).describe(settings, {"P1"}, setup);
  const auto of_setup = [&](const char* key) { return setup.noise.number(key).value_or(0.0); };
  if (setup.repeatability > 0.0 || of_setup("constant") > 0.0 || of_setup("per_metre") > 0.0) return;
  const std::string per_metre = setup.noise.number("per_metre") ? ", PER_METRE" : "";
  throw InputError({}, "--noise: the standard deviation of the readings is zero",
                   "give --noise CONSTANT_um,PER_METRE_um,REPEATABILITY_um with a CONSTANT" + per_metre +
                       " or REPEATABILITY above zero");
}

void refuse_tools_named_twice(const PlanSettings& settings) {
  std::set<std::size_t> named;
  for (const std::size_t tool : settings.budget.tools) {
    if (named.insert(tool).second) continue;
    throw InputError({}, "--tools names " + settings.machine.tools[tool].name + " twice",
                     "give every tool once");
  }
}

}  // namespace

std::optional<Finding> hold_effects_unseen(const Campaign& planned, ModelSpec& model) {
  std::vector<std::string> labels;
  std::set<std::string> columns;
  std::erase_if(model.effects, [&](const EffectSpec& spec) {
    const std::unique_ptr<Effect> effect = find_effect(spec.kind)->make(spec, model.file);
    if (can_act(planned, *effect)) return false;
    const std::set<Variable> own = conditions_of_effect(spec, *effect);
    if (own.empty() && !belongs_to_campaign(spec, *effect)) return false;
    labels.push_back(effect_label(*effect));
    for (const Variable& each : own) columns.insert(each.column());
    return true;
  });
  if (labels.empty()) return std::nullopt;
  Finding finding{FindingCode::PlanEffectsKnown, {{"effects", labels}}};
  if (!columns.empty()) finding.data["columns"] = std::vector<std::string>(columns.begin(), columns.end());
  return finding;
}

std::vector<std::size_t> tools_of(const PlanSettings& settings) {
  if (!settings.budget.tools.empty()) return settings.budget.tools;
  std::vector<std::size_t> all(settings.machine.tools.size() - settings.hypothetical_tools);
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

std::vector<Tool> own_tools(const PlanSettings& settings) {
  std::vector<Tool> tools = settings.machine.tools;
  tools.resize(tools.size() - settings.hypothetical_tools);
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
  const std::vector<AxisName> linear = settings.machine.linear_axes();
  if (linear.size() < 2)
    fail("the machine has fewer than two linear axes", "plan for machines with two of X, Y and Z or more");
  if (linear.size() == 2 && plan_instrument_of(settings).turns_rotary_axes())
    fail(std::string("a ") + settings.instrument + " is planned where X, Y and Z follow the rotary axes: " +
             letter_of(linear[0]) + " and " + letter_of(linear[1]) + " alone lead to points of one plane",
         "plan the linear axes with another --instrument, and test each rotary axis alone: kind = "
         "\"angle-lines\" and \"axis-of-rotation\" of volcal simulate have the positions");
  if (!settings.budget.readings && !settings.budget.time) {
    fail("neither readings nor time are limited", "give --readings N, --time HOURS or both");
  }
  if (settings.budget.tool_count &&
      static_cast<std::size_t>(*settings.budget.tool_count) > tools_of(settings).size()) {
    fail("--tool-count asks for more tools than there are",
         "the machine file and --tools leave " + std::to_string(tools_of(settings).size()));
  }
  refuse_tools_named_twice(settings);
  plan_instrument_of(settings).check(settings);
  refuse_exact_readings(settings);
}

}  // namespace volcal
