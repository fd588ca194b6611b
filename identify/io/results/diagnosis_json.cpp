#include "volcal/identify/io/results/diagnosis_json.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/result_json_parts.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using Json = nlohmann::ordered_json;

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json micro(double value) { return finite_or_null(value / kMicro); }

/// null: not separable from the rival, or not computed.
void add_mib(const AmplitudeFigure& figure, Json& json) {
  json["mib"] = finite_or_null(figure.mib / figure.si_per_unit);
  json["mib_rival"] = figure.mib_rival;
}

/// An effect of one amplitude has it as a number; of several, the largest in its standard uncertainty leads
/// and all are listed.
Json effect_json(const EffectFinding& effect) {
  Json json = {{"kind", effect.name.kind},
               {"target", effect.name.target.name()},
               {"driver", effect.name.driver.name()},
               {"shape", effect.name.shape},
               {"label", effect.label}};
  if (!effect.amplitudes.empty()) {
    const auto size = [](const AmplitudeFigure& each) {
      return each.u > 0.0 ? std::abs(each.value) / each.u : 0.0;
    };
    const AmplitudeFigure* leading = &effect.amplitudes.front();
    for (const AmplitudeFigure& each : effect.amplitudes) {
      if (size(each) > size(*leading)) leading = &each;
    }
    json["amplitude"] = finite_or_null(leading->value / leading->si_per_unit);
    json["unit"] = leading->unit;
    json["u"] = finite_or_null(leading->u / leading->si_per_unit);
    json["mdb"] = finite_or_null(leading->mdb / leading->si_per_unit);
    add_mib(*leading, json);
    if (effect.amplitudes.size() > 1) {
      json["amplitudes"] = Json::array();
      for (const AmplitudeFigure& each : effect.amplitudes) {
        json["amplitudes"].push_back({{"label", each.label},
                                      {"amplitude", finite_or_null(each.value / each.si_per_unit)},
                                      {"unit", each.unit},
                                      {"u", finite_or_null(each.u / each.si_per_unit)},
                                      {"mdb", finite_or_null(each.mdb / each.si_per_unit)}});
        add_mib(each, json["amplitudes"].back());
      }
    }
  }
  json["log10_p"] = finite_or_null(effect.log10_p);
  json["visible_fraction"] = finite_or_null(effect.visible_fraction);
  json["gain"] = finite_or_null(effect.gain);
  json["lm"] = finite_or_null(effect.lm);
  json["dof"] = effect.dof;
  if (!effect.shape_text.empty()) json["shape_value"] = effect.shape_text;
  if (effect.spec.kind == kLeftOut) {
    json["left_out"] = names_of(errors_given_back(effect.spec));
    json["spec"] = json_parts::effect(effect.spec);
  } else if (!effect.resolution) {
    json["model_toml"] = effect_toml(effect.spec);
    json["spec"] = json_parts::effect(effect.spec);
  }
  return json;
}

Json list_json(const std::vector<EffectFinding>& effects) {
  Json json = Json::array();
  for (const EffectFinding& effect : effects) json.push_back(effect_json(effect));
  return json;
}

Json detectable_json(const std::vector<DetectableEffect>& effects) {
  Json json = Json::array();
  for (const DetectableEffect& effect : effects) {
    json.push_back({{"kind", effect.name.kind},
                    {"target", effect.name.target.name()},
                    {"driver", effect.name.driver.name()},
                    {"shape", effect.name.shape},
                    {"label", effect.label},
                    {"shape_value", effect.shape_text},
                    {"mdb", finite_or_null(effect.mdb / effect.si_per_unit)},
                    {"unit", effect.unit},
                    {"visible", effect.visible},
                    {"visible_fraction", finite_or_null(effect.visible_fraction)},
                    {"volumetric_um", micro(effect.volumetric)}});
  }
  return json;
}

Json unknown_json(const UnknownFinding& unknown) {
  return {{"variables", names_of(unknown.variables)},
          {"with_one_of", names_of(unknown.with_one_of)},
          {"direction", name_of(unknown.direction)},
          {"rotation", unknown.rotation ? unknown.rotation->name() : ""},
          {"period_mm", unknown.period > 0.0 ? Json(unknown.period * kPerMilli) : Json()},
          {"rms_um", micro(unknown.rms)},
          {"log10_p", finite_or_null(unknown.log10_p)}};
}

Json formula_json(const FormulaFinding& formula) {
  return {{"label", formula.label},
          {"amplitude", finite_or_null(formula.amplitude / formula.si_per_unit)},
          {"u", finite_or_null(formula.u / formula.si_per_unit)},
          {"unit", formula.unit},
          {"shape_value", formula.shape_text},
          {"log_evidence", finite_or_null(formula.log_evidence)},
          {"gain", finite_or_null(formula.gain)},
          {"log10_p", finite_or_null(formula.log10_p)},
          {"model_toml", effect_toml(formula.spec)},
          {"spec", json_parts::effect(formula.spec)}};
}

Json asked_json(const AskedLaws& asked) {
  Json laws = Json::array();
  for (const FormulaFinding& law : asked.laws) laws.push_back(formula_json(law));
  return {{"label", asked.label},
          {"surface_evidence", finite_or_null(asked.surface_evidence)},
          {"tried", asked.tried},
          {"laws", std::move(laws)}};
}

/// What held-out readings are left with.
Json heldout_json(const MemberFinding& member) {
  return {{"rms_heldout_um", micro(member.rms_heldout)},
          {"systematic_um", micro(member.systematic)},
          {"systematic_low_um", micro(member.systematic_low)},
          {"systematic_high_um", micro(member.systematic_high)}};
}

Json surface_json(const Diagnosis& diagnosis, const SurfaceFinding& surface) {
  Json formulas = Json::array();
  for (const FormulaFinding& formula : surface.formulas) formulas.push_back(formula_json(formula));
  return {{"kind", surface.name.kind},
          {"target", surface.name.target.name()},
          {"driver", surface.name.driver.name()},
          {"shape", surface.name.shape},
          {"label", surface.label},
          {"drivers", written_names(surface.drivers)},
          {"unit", surface.unit},
          {"largest", finite_or_null(surface.largest / surface.si_per_unit)},
          {"u", finite_or_null(surface.largest_u / surface.si_per_unit)},
          {"at", surface.at},
          {"rms", finite_or_null(surface.rms / surface.si_per_unit)},
          {"removed_um",
           micro(removed_rms(diagnosis, surface).value_or(std::numeric_limits<double>::quiet_NaN()))},
          {"log_evidence", finite_or_null(surface.log_evidence)},
          {"effective_parameters", finite_or_null(surface.effective_parameters)},
          {"free", surface.free},
          {"formulas", std::move(formulas)},
          {"model_toml", effect_toml(surface.spec)},
          {"spec", json_parts::effect(surface.spec)}};
}

Json names_json(const std::vector<EffectName>& names) {
  Json json = Json::array();
  for (const EffectName& name : names) json.push_back(full_name(name));
  return json;
}

/// Gains: null where the readings as they are cannot tell the two apart at all.
Json proposal_json(const MeasurementProposal& proposal) {
  return {{"action", proposal.action},
          {"setup", proposal.setup},
          {"separates", names_json(proposal.separates)},
          {"makes_visible", names_json(proposal.makes_visible)},
          {"readings", proposal.readings},
          {"separation", finite_or_null(proposal.separation)},
          {"separation_reached", finite_or_null(proposal.reached)},
          {"separation_plain", finite_or_null(proposal.plain)},
          {"gain", finite_or_null(proposal.gain)},
          {"plain_gain", finite_or_null(proposal.plain_gain)},
          {"words", sentence(proposal.finding)},
          {"finding", finding_json(proposal.finding)}};
}

Json confounding_json(const Confounding& confounding) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < confounding.cosine.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < confounding.cosine.cols(); ++j)
      row.push_back(finite_or_null(confounding.cosine(i, j)));
    rows.push_back(std::move(row));
  }
  return {{"effects", names_json(confounding.names)}, {"labels", confounding.labels}, {"cosine", rows}};
}

Json step_json(const LadderStep& step) {
  return {{"model", step.model},
          {"added", step.added},
          {"rms_fit_um", micro(step.rms_fit)},
          {"rms_heldout_um", micro(step.rms_heldout)},
          {"reduced_chi2", finite_or_null(step.reduced_chi2)},
          {"noise_floor_um", micro(step.noise_floor)},
          {"systematic_um", micro(step.systematic)},
          {"systematic_low_um", micro(step.systematic_low)},
          {"systematic_high_um", micro(step.systematic_high)},
          {"heldout_loglik_gain", finite_or_null(step.heldout_loglik_gain)}};
}

/// Beside the lists of effects, in their order.
Json set_json(const SetFinding& set, std::size_t place) {
  Json json = {{"matters", set.matters}, {"members", Json::array()}};
  json["chosen"] = set.chosen ? Json(*set.chosen) : Json(nullptr);
  json["farthest"] = set.farthest ? Json(*set.farthest) : Json(nullptr);
  for (std::size_t i = 0; i < set.members.size(); ++i) {
    const MemberFinding& member = set.members[i];
    json["members"].push_back(heldout_json(member));
    json["members"].back()["difference_um"] = micro(member.difference);
    json["members"].back()["difference_u_um"] = micro(member.difference_u);
    json["members"].back()["at_mm"] = Json::array();
    for (const double at : member.at) json["members"].back()["at_mm"].push_back(at * kPerMilli);
    for (const auto& [variable, value] : member.conditions)
      json["members"].back()["conditions"][variable.column()] = finite_or_null(value);
    if (set.chosen && i != *set.chosen && !std::isnan(member.difference))
      json["members"].back()["model"] = alternative_model_file(place, i);
  }
  return json;
}

Json noise_rows_json(const Diagnosis& diagnosis) {
  Json json = Json::array();
  for (const NoiseRow& row : diagnosis.noise) {
    json.push_back({{"instrument", diagnosis.noise_instruments[row.instrument]},
                    {"term", row.term},
                    {"unit", row.unit},
                    {"value", finite_or_null(row.value)},
                    {"low", finite_or_null(row.low)},
                    {"high", finite_or_null(row.high)},
                    {"likelihood_ratio", finite_or_null(row.likelihood_ratio)},
                    {"remark", row.remark}});
  }
  return json;
}

}  // namespace

std::string diagnosis_json(const Diagnosis& diagnosis) {
  Json json = {{"format", kDiagnosisFormat},
               {"verdict", to_string(diagnosis.verdict)},
               {"words", sentences(diagnosis.findings)},
               {"findings", findings_json(diagnosis.findings)},
               {"effects", list_json(diagnosis.effects)},
               {"one_of", list_json(diagnosis.one_of)},
               {"further_one_of", Json::array()}};
  for (const auto& set : diagnosis.further_one_of) json["further_one_of"].push_back(list_json(set));
  json["sets"] = Json::array();
  for (std::size_t i = 0; i < diagnosis.sets.size(); ++i)
    json["sets"].push_back(set_json(diagnosis.sets[i], i));
  json["unknown"] = Json::array();
  for (const UnknownFinding& unknown : diagnosis.unknown) json["unknown"].push_back(unknown_json(unknown));
  json["surfaces"] = Json::array();
  for (const SurfaceFinding& surface : diagnosis.surfaces)
    json["surfaces"].push_back(surface_json(diagnosis, surface));
  if (!diagnosis.tried.empty()) {
    json["tried"] = list_json(diagnosis.tried);
    json["tried_errors"] = Json::array();
    for (const MemberFinding& member : diagnosis.tried_errors)
      json["tried_errors"].push_back(heldout_json(member));
  }
  if (!diagnosis.asked_laws.empty()) {
    json["asked_laws"] = Json::array();
    for (const AskedLaws& asked : diagnosis.asked_laws) json["asked_laws"].push_back(asked_json(asked));
  }
  json["not_visible"] = list_json(diagnosis.not_visible);
  json["next_measurement"] = Json::array();
  for (const MeasurementProposal& proposal : diagnosis.proposals) {
    json["next_measurement"].push_back(proposal_json(proposal));
  }
  json["confounding"] = confounding_json(diagnosis.confounding);
  json["ladder"] = Json::array();
  for (const LadderStep& step : diagnosis.ladder) json["ladder"].push_back(step_json(step));
  json["model_changes"] = list_json(diagnosis.model_changes);
  json["noise"] = noise_rows_json(diagnosis);
  json["removed_readings"] = Json::array();
  for (const RemovedReading& removed : diagnosis.removed_readings) {
    json["removed_readings"].push_back(
        {{"setup", removed.setup}, {"line", removed.line}, {"reading", removed.reading}});
  }
  if (!diagnosis.not_looked_for.empty()) {
    json["not_looked_for"] = sentences(diagnosis.not_looked_for);
    json["not_looked_for_findings"] = findings_json(diagnosis.not_looked_for);
  }
  add_notes(diagnosis.notes, json);
  json["ranking"] = list_json(diagnosis.ranking);
  json["families"] = diagnosis.families;
  json["generic_tests"] = diagnosis.generic_tests;
  json["log10_p_threshold"] = log10_family_risk();
  json["detectable"] = detectable_json(diagnosis.detectable);
  return json_text(json, 2) + "\n";
}

}  // namespace volcal
