#include "volcal/identify/errors/stated_errors.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include "volcal/model/description/measured_ends.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/conditions_of_effect.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/observation/campaign_binding.h"

namespace volcal {
namespace {

ParameterBlock block_of_one(ParameterKind kind, const std::string& name, double value,
                            const std::string& unit, double si_per_unit) {
  ParameterBlock block;
  block.kind = kind;
  block.name = name;
  block.labels = {""};
  block.units = {unit};
  block.si_per_unit = {si_per_unit};
  block.prior_mean = block.prior_sigma = Eigen::VectorXd::Zero(1);
  block.guess = Eigen::VectorXd::Constant(1, value);
  return block;
}

ParameterBlock stated_block(const EffectAmplitude& amplitude) {
  return block_of_one(ParameterKind::Effect, amplitude.label, amplitude.guess, amplitude.unit(),
                      amplitude.si_per_unit());
}

/// Parameters one after the other, with their values.
class StatedLayout {
 public:
  StatedLayout(const Machine& machine, const ModelSpec& model) {
    for (const Axis& axis : machine.axes) {
      for (const Component component : kAllComponents) add_function(axis, {component, axis.name}, model);
    }
    layout_.function_size = size();
    for (const auto& [symbol, value] : model.locations) {
      ParameterBlock& block = add(block_of_one(ParameterKind::Location, symbol.name(), value,
                                               std::string(edge_unit(symbol.component)), kMicro));
      block.location = symbol;
    }
    for (const Axis& axis : machine.axes) add_expansion(axis, model);
    for (const EffectSpec& spec : model.effects) add_effect(spec, model.file);
    for (const auto& [tool, error] : model.tool_errors) add_tool(tool, error);
    layout_.size = size();
  }

  void take(FitResult& result) {
    result.layout = std::move(layout_);
    result.parameters =
        Eigen::Map<Eigen::VectorXd>(values_.data(), static_cast<Eigen::Index>(values_.size()));
  }

 private:
  int size() const { return static_cast<int>(values_.size()); }

  void add_function(const Axis& axis, ErrorSymbol symbol, const ModelSpec& model) {
    const auto found = model.functions.find(symbol);
    if (found == model.functions.end() || found->second.coefficients.empty()) return;
    FunctionGroup group;
    group.axis = axis.name;
    group.basis = find_basis(found->second.basis)->make(found->second, axis);
    group.symbols = {symbol};
    group.offset = size();
    layout_.groups.push_back(group);
    values_.insert(values_.end(), found->second.coefficients.begin(), found->second.coefficients.end());
  }

  ParameterBlock& add(ParameterBlock block) {
    block.offset = size();
    values_.push_back(block.guess[0]);
    return layout_.blocks.emplace_back(std::move(block));
  }

  void add_expansion(const Axis& axis, const ModelSpec& model) {
    const auto known = model.expansions.find(axis.name);
    if (!axis.expansion || known == model.expansions.end()) return;
    add(block_of_one(ParameterKind::Expansion, expansion_parameter(axis.name),
                     known->second - axis.expansion->per_kelvin, "um/m/K", kMicro))
        .is_held = true;
  }

  void add_effect(const EffectSpec& spec, const std::string& file) {
    const std::unique_ptr<Effect> effect = find_effect(spec.kind)->make(spec, file);
    for (const EffectAmplitude& amplitude : effect->amplitudes()) add(stated_block(amplitude));
  }

  void add_tool(const std::string& tool, const Eigen::Vector3d& error) {
    ParameterBlock block;
    block.kind = ParameterKind::ToolOffset;
    block.name = tool_parameter(tool);
    block.labels = {"x", "y", "z"};
    block.units = {"um", "um", "um"};
    block.si_per_unit = {kMicro, kMicro, kMicro};
    block.prior_mean = block.guess = error;
    block.prior_sigma = Eigen::VectorXd::Zero(3);
    block.is_held = true;
    block.offset = size();
    layout_.blocks.push_back(std::move(block));
    values_.insert(values_.end(), error.begin(), error.end());
  }

  ParameterLayout layout_;
  std::vector<double> values_;
};

}  // namespace

EffectSpec& only_effect(const std::string& kind, ModelSpec& model) {
  if (std::ranges::find(model.effects, kind, &EffectSpec::kind) == model.effects.end())
    model.effects.push_back(effect_spec(kind, {}));
  return *std::ranges::find(model.effects, kind, &EffectSpec::kind);
}

int place_of_amplitude(const EffectAmplitude& amplitude, ParameterLayout& layout) {
  if (const auto place = layout.find_parameter(amplitude.label)) return *place;
  ParameterBlock block = stated_block(amplitude);
  block.offset = layout.size++;
  layout.blocks.push_back(std::move(block));
  return layout.blocks.back().offset;
}

FitResult stated_result(const Machine& machine, const ModelSpec& model) {
  FitResult result;
  result.machine = machine;
  result.identified = model;
  result.reference_temperature_degC = kReferenceTemperature_degC;
  StatedLayout(machine, model).take(result);
  for (const auto& [axis, ends] : model.measured) {
    if (stood_still(axis, model)) {
      result.standing[axis] = ends.first;
      continue;
    }
    FunctionSummary& summary = result.functions.emplace_back();
    summary.symbol = {Component::X, axis};
    summary.measured_min = ends.first;
    summary.measured_max = ends.second;
  }
  constexpr RecordedRange kReference = {kReferenceTemperature_degC, kReferenceTemperature_degC,
                                        kReferenceTemperature_degC, ConditionOrigin::Assumed};
  constexpr RecordedRange kAtRest = {0.0, 0.0, 0.0, ConditionOrigin::Assumed};
  for (const Axis& axis : machine.axes) {
    if (axis.expansion) result.conditions.temperature_degC[axis.expansion->channel] = kReference;
  }
  for (const EffectSpec& effect : model.effects) {
    for (const Variable& each :
         conditions_of_effect(effect, *find_effect(effect.kind)->make(effect, model.file))) {
      if (each.kind == Variable::Kind::Temperature)
        result.conditions.temperature_degC[each.subject] = kReference;
    }
  }
  result.conditions.time = model.conditions.time.value_or(kAtRest);
  result.conditions.feed = model.conditions.feed.value_or(kAtRest);
  for (const auto& [channel, range] : model.conditions.temperature_degC)
    result.conditions.temperature_degC[channel] = range;
  return result;
}

bool states_errors(const ModelSpec& model) {
  return !model.locations.empty() || !model.effects.empty() || !model.tool_errors.empty() ||
         !model.expansions.empty() || std::ranges::any_of(model.functions, [](const auto& entry) {
           return !entry.second.coefficients.empty();
         });
}

std::vector<EffectSpec> effects_without_amplitude(const ModelSpec& model) {
  std::vector<EffectSpec> without;
  std::ranges::copy_if(model.effects, std::back_inserter(without), [&](const EffectSpec& spec) {
    const std::unique_ptr<Effect> effect = find_effect(spec.kind)->make(spec, model.file);
    return std::ranges::none_of(effect->amplitudes(), [&](const EffectAmplitude& amplitude) {
      return spec.options.has(std::string(stem_of_key(amplitude.key)));
    });
  });
  return without;
}

void require_stated_errors(const ModelSpec& model) {
  if (!states_errors(model))
    throw InputError(
        {model.file, 0},
        "the model states no error: no coefficients, no locations, no effects, no offset errors of tools",
        "give a model with values, such as the identified.toml of a result; of a machine that is "
        "not built yet, volcal budget MACHINE.toml --tolerances FILE");
  for (const EffectSpec& spec : effects_without_amplitude(model)) {
    const std::unique_ptr<Effect> effect = find_effect(spec.kind)->make(spec, model.file);
    throw InputError({model.file, spec.source_line},
                     "effect \"" + spec.kind + "\": it states no amplitude and would be taken as zero",
                     "add " + effect->amplitudes().front().key +
                         " = ..., or give the identified.toml of a result, which has what was fitted");
  }
}

}  // namespace volcal
