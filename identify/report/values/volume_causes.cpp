#include "volcal/identify/report/values/volume_causes.h"

#include <algorithm>
#include <functional>
#include <utility>
#include <variant>

#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/errors/volume/volume_points.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kDoesNotMove = 1e-12;  // m

/// Parameters of functions and blocks that both layouts have, theirs and ours.
std::vector<std::pair<int, int>> shared(const ParameterLayout& theirs, const ParameterLayout& ours) {
  std::vector<std::pair<int, int>> pairs;
  for (const FunctionGroup& group : ours.groups) {
    for (int slot = 0; slot < group.count(); ++slot) {
      const auto place = theirs.find(group.symbols[static_cast<std::size_t>(slot)]);
      if (!place) continue;
      const FunctionGroup& source = theirs.groups[static_cast<std::size_t>(place->group)];
      for (int j = 0; j < std::min(group.basis->size(), source.basis->size()); ++j)
        pairs.emplace_back(source.index(j, place->slot), group.index(j, slot));
    }
  }
  for (const ParameterBlock& block : ours.blocks) {
    const ParameterBlock* source = theirs.find_block(block.name);
    if (source == nullptr) continue;
    for (int k = 0; k < std::min(block.size(), source->size()); ++k)
      pairs.emplace_back(source->offset + k, block.offset + k);
  }
  return pairs;
}

/// The given result with the effects in it.
FitResult extended_result(const FitResult& given, std::span<const EffectFinding> added) {
  ModelSpec model = given.identified;
  for (const EffectFinding& effect : added) {
    if (find_effect(effect.spec.kind) != nullptr) model.effects.push_back(effect.spec);
  }
  FitResult result = stated_result(given.machine, model);
  result.functions = given.functions;
  result.conditions = given.conditions;
  result.reference_temperature_degC = given.reference_temperature_degC;
  result.temperature_is_campaign_mean = given.temperature_is_campaign_mean;
  result.covariance = Eigen::MatrixXd::Zero(result.layout.size, result.layout.size);
  const auto pairs = shared(given.layout, result.layout);
  for (const auto& [from, to] : pairs) {
    if (given.covariance.size() == 0) break;
    for (const auto& [from2, to2] : pairs) result.covariance(to, to2) = given.covariance(from, from2);
  }
  for (const EffectFinding& effect : added) {
    for (const AmplitudeFigure& amplitude : effect.amplitudes) {
      const ParameterBlock* block = result.layout.find_block(amplitude.label);
      if (block != nullptr) result.covariance(block->offset, block->offset) = amplitude.u * amplitude.u;
    }
  }
  return result;
}

/// Names and labels of the effects that are added; what is given back to the model is none.
std::vector<std::pair<EffectName, std::string>> named_effects(std::span<const EffectFinding> added) {
  std::vector<std::pair<EffectName, std::string>> named;
  for (const EffectFinding& effect : added) {
    if (const EffectKind* kind = find_effect(effect.spec.kind))
      named.emplace_back(kind->make(effect.spec, {})->name(), effect.label);
  }
  return named;
}

std::optional<EffectName> effect_of(const BudgetLine& line) {
  const auto* name = line.source ? std::get_if<EffectName>(&*line.source) : nullptr;
  return name != nullptr ? std::optional(*name) : std::nullopt;
}

VolumeCause cause_of_line(const BudgetLine& line, bool found) {
  return {line.name,  found,          line.rms, line.u_rms > 0.0 ? std::optional(line.u_rms) : std::nullopt,
          line.share, effect_of(line)};
}

}  // namespace

VolumeCauses volume_causes(const FitResult& given, std::span<const EffectFinding> added) {
  VolumeCauses result;
  const FitResult extended = extended_result(given, added);
  const Tool& tool = extended.machine.tools.front();
  const ErrorBudget budget =
      error_budget(extended, tool, default_conditions(extended), kVolumeCells, RotaryPoses::AtRest);
  result.tool = tool.name;
  result.total_rms = budget.total.rms;
  const auto found = named_effects(added);
  for (const BudgetLine& line : budget.contributions) {
    const std::optional<EffectName> effect = effect_of(line);
    if (line.rms < kDoesNotMove || !effect) continue;
    const bool is_found =
        std::ranges::find(found, *effect, &decltype(found)::value_type::first) != found.end();
    result.causes.push_back(cause_of_line(line, is_found));
  }
  for (const auto& effect : found) {
    if (std::ranges::find(result.causes, std::optional(effect.first), &VolumeCause::effect) ==
        result.causes.end())
      result.not_in_volume.push_back(effect.second);
  }
  for (const BudgetLine& line : budget.causes) {
    if (line.name != kCauseOfEffects && line.rms >= kDoesNotMove)
      result.causes.push_back(cause_of_line(line, false));
  }
  std::ranges::stable_sort(result.causes, std::greater<>(), &VolumeCause::rms);
  return result;
}

}  // namespace volcal
