#include "volcal/identify/errors/errors_of_tables.h"

#include <algorithm>
#include <set>

#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

const Finding* finding_of_tables_in(const FitResult& result) {
  const auto found = std::ranges::find(result.findings, FindingCode::ErrorsOfTables, &Finding::code);
  return found == result.findings.end() ? nullptr : &*found;
}

TablesMadeFor made_for_of(const Finding& finding, const FitResult& result) {
  TablesMadeFor made_for;
  if (finding.has("tool")) made_for.tool = finding.text("tool");
  made_for.shared_effects = finding.texts("shared_effects");
  made_for.left_out = finding.texts("effects_in_no_table");
  const auto add = [&](const Variable& variable, const RecordedRange& range) {
    if (range.origin == ConditionOrigin::Tables) made_for.conditions.push_back(variable);
  };
  for (const auto& [channel, range] : result.conditions.temperature_degC) add(temperature_of(channel), range);
  if (result.conditions.time) add({Variable::Kind::Time}, *result.conditions.time);
  if (result.conditions.feed) add({Variable::Kind::Feed}, *result.conditions.feed);
  return made_for;
}

}  // namespace

TablesMadeFor tables_made_for(const FitResult& result, const Tool& tool, const Conditions& conditions) {
  if (const Finding* known = finding_of_tables_in(result)) return made_for_of(*known, result);
  TablesMadeFor made_for;
  const MachineEffects effects(result, tool, conditions);
  std::set<std::string> labels;
  for (std::size_t e = 0; e < effects.effect_count(); ++e) {
    if (effects.reach(e).acts && !is_of_own_axis(effects, e) && labels.insert(effects.label(e)).second)
      made_for.shared_effects.push_back(effects.label(e));
  }
  if (!made_for.shared_effects.empty()) made_for.tool = tool.name;
  for (const EffectOnNoPose& effect : effects_on_no_pose(result)) made_for.left_out.push_back(effect.label);
  const std::set<Variable> acting = conditions_that_act(result, conditions);
  for (const StatedCondition& condition : list_conditions(result, conditions)) {
    if (acting.contains(condition.variable)) made_for.conditions.push_back(condition.variable);
  }
  return made_for;
}

void add_finding_of_tables(const TablesMadeFor& made_for, FitResult& result) {
  std::vector<std::string> conditions;
  std::vector<FindingNumber> values;
  for (const StatedCondition& condition : list_conditions(result, default_conditions(result))) {
    const Variable& variable = condition.variable;
    if (std::ranges::find(made_for.conditions, variable) == made_for.conditions.end()) continue;
    const Unit unit = variable.unit();
    conditions.push_back(variable.name());
    values.push_back({condition.value * unit.si_per_unit, unit_text(unit.suffix), unit.si_per_unit});
  }
  if (made_for.tool.empty() && conditions.empty() && made_for.shared_effects.empty() &&
      made_for.left_out.empty())
    return;
  Finding finding{FindingCode::ErrorsOfTables, {}};
  if (!made_for.tool.empty()) finding.data["tool"] = made_for.tool;
  if (!conditions.empty()) {
    finding.data["conditions"] = conditions;
    finding.data["values"] = values;
  }
  if (!made_for.shared_effects.empty()) finding.data["shared_effects"] = made_for.shared_effects;
  if (!made_for.left_out.empty()) finding.data["effects_in_no_table"] = made_for.left_out;
  result.findings.push_back(std::move(finding));
}

std::vector<Finding> findings_of_tables(const FitResult& result, const std::vector<std::string>& tools) {
  const Finding* of_tables = finding_of_tables_in(result);
  if (of_tables == nullptr) return {};
  std::vector<Finding> findings = {*of_tables};
  if (!of_tables->has("tool")) return findings;
  const std::string& tables_tool = of_tables->text("tool");
  for (const std::string& tool : std::set<std::string>(tools.begin(), tools.end())) {
    if (!tool.empty() && tool != tables_tool)
      findings.push_back({FindingCode::TablesOfOtherTool, {{"tool", tool}, {"tables_tool", tables_tool}}});
  }
  return findings;
}

std::vector<std::string> tools_of_setups(const Campaign& campaign) {
  std::vector<std::string> names;
  for (const Setup& setup : campaign.setups) {
    if (setup.tool < campaign.machine.tools.size()) names.push_back(campaign.machine.tools[setup.tool].name);
  }
  return names;
}

}  // namespace volcal
