#include "volcal/identify/workbench/session_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/verdict.h"
#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/identify/workbench/columns.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/kinds/open/empirical.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/observation/channels.h"

namespace volcal::workbench {
namespace {

/// Of an effect that the readings do not show all figures are zero.
bool is_determined(const AmplitudeFigure& figure) { return figure.u > 0.0; }

Json amplitude_json(const AmplitudeFigure& figure) {
  const double edge = 1.0 / figure.si_per_unit;
  return {{"label", figure.label},
          {"value", is_determined(figure) ? number(figure.value * edge) : Json()},
          {"u95", is_determined(figure) ? number(kCoverageFactor * figure.u * edge) : Json()},
          {"detectable", number(figure.mdb * edge)},
          {"unit", figure.unit}};
}

/// "1.3e-12" also where a double ends.
std::string probability_text(double log10_p) {
  if (log10_p > -3.0) return fmt::format("{:.2g}", std::pow(10.0, log10_p));
  const double rounded = std::log10(0.95);  // 9.5 and more of a power round to the next
  const double exponent = std::floor(log10_p - rounded);
  return fmt::format("{:.0f}e{:.0f}", std::pow(10.0, log10_p - exponent), exponent);
}

Json written_formula(const EffectSpec& spec) {
  const auto target = spec.options.text("target"), expression = spec.options.text("expression");
  if (!target || !expression) return nullptr;
  return *target + " += " + *expression;
}

std::string standing_text(ModelStanding standing) {
  switch (standing) {
    case ModelStanding::Fitted:
      return "fitted";
    case ModelStanding::Preview:
      return "preview";
    case ModelStanding::Refitted:
      return "refitted";
    case ModelStanding::Contradicted:
      break;
  }
  return "contradicted";
}

Json contradiction_json(const std::optional<Contradiction>& contradiction) {
  if (!contradiction) return nullptr;
  const double edge = 1.0 / contradiction->si_per_unit;
  const bool refit = contradiction->of == ModelStanding::Refitted;
  return fmt::format(
      "The full fit finds {} = {:.4g} ± {:.2g} {}, the {} had {:.4g} {}: {} found anew with the effect in "
      "the model.",
      contradiction->label, contradiction->fitted * edge, kCoverageFactor * contradiction->u * edge,
      contradiction->unit, refit ? "refit" : "linear preview", contradiction->previewed * edge,
      contradiction->unit, refit ? "resolution was" : "noise and smoothing were");
}

Json model_json(const SessionModel& model) {
  Json effects = Json::array();
  for (const EffectFinding& effect : model.effects) effects.push_back(effect_json(effect));
  return {{"number", model.number},
          {"parent", model.parent ? Json(*model.parent) : Json()},
          {"change", model.change},
          {"standing", standing_text(model.standing)},
          {"contradiction", contradiction_json(model.contradiction)},
          {"figures", figures_json(model.figures)},
          {"effects", std::move(effects)}};
}

Json setup_json(const Setup& setup) {
  Json channels = Json::array();
  for (std::size_t channel = 0; channel < setup.readings.channels(); ++channel)
    channels.push_back({{"name", channel_column(setup, channel)}, {"unit", residual_unit(setup, channel)}});
  return {{"name", setup.name},
          {"instrument", setup.instrument},
          {"readings", setup.readings.size()},
          {"channels", std::move(channels)},
          {"bar", traits_of(setup).has_bar}};
}

Json doubles_json(const std::vector<double>& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(number(value));
  return json;
}

Json vector_json(const Eigen::VectorXd& values, double factor) {
  Json json = Json::array();
  for (const double value : values) json.push_back(number(value * factor));
  return json;
}

/// "p=120.3+-4": as a formula of the user's takes it.
Json parameters_json(const Options& options) {
  Json parameters = Json::array();
  for (const std::string name : {"p", "q"}) {
    const auto value = options.number(name), sigma = options.number(name + "_sigma");
    if (value)
      parameters.push_back(fmt::format("{}={}", name, *value) + (sigma ? fmt::format("+-{}", *sigma) : ""));
  }
  return parameters;
}

Json formula_json(const FormulaFinding& formula) {
  const double edge = 1.0 / formula.si_per_unit;
  return {{"label", formula.label},
          {"text", written_formula(formula.spec)},
          {"parameters", parameters_json(formula.spec.options)},
          {"amplitude", number(formula.amplitude * edge)},
          {"u95", number(kCoverageFactor * formula.u * edge)},
          {"unit", formula.unit},
          {"shape", formula.shape_text},
          {"log_evidence", number(formula.log_evidence)}};
}

}  // namespace

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

namespace {

bool is_hidden(const EffectFinding& effect) {
  return !effect.amplitudes.empty() && std::ranges::none_of(effect.amplitudes, is_determined);
}

}  // namespace

Json effect_json(const EffectFinding& effect) {
  Json amplitudes = Json::array();
  for (const AmplitudeFigure& figure : effect.amplitudes) amplitudes.push_back(amplitude_json(figure));
  const Json meaning = report::meaning_json(effect.name);
  return {{"name", full_name(effect.name)},
          {"label", effect.label},
          {"kind", effect.name.kind},
          {"driver", effect.name.driver.name()},
          {"words", meaning["plain"]},
          {"causes", meaning["usual_causes"]},
          {"amplitudes", std::move(amplitudes)},
          {"shape", effect.shape_text},
          {"p", std::isfinite(effect.log10_p) ? Json(probability_text(effect.log10_p)) : Json()},
          {"log10_p", number(effect.log10_p)},
          {"gain", number(effect.gain)},
          {"visible", number(effect.visible_fraction)},
          {"formula", written_formula(effect.spec)},
          {"surface", is_surface(effect.name)},
          {"can_be_added", !effect.resolution && !is_hidden(effect)}};
}

Json figures_json(const LadderStep& figures) {
  return {{"systematic_um", number(figures.systematic * kPerMicro)},
          {"systematic_low_um", number(figures.systematic_low * kPerMicro)},
          {"systematic_high_um", number(figures.systematic_high * kPerMicro)},
          {"rms_heldout_um", number(figures.rms_heldout * kPerMicro)},
          {"rms_fit_um", number(figures.rms_fit * kPerMicro)},
          {"reduced_chi2", number(figures.reduced_chi2)},
          {"noise_floor_um", number(figures.noise_floor * kPerMicro)}};
}

Json models_json(const Session& session) {
  Json models = Json::array();
  for (const SessionModel& model : session.models()) models.push_back(model_json(model));
  return {{"current", session.current().number}, {"models", std::move(models)}};
}

Json unknown_json(const UnknownFinding& finding, std::size_t number_of_it) {
  return {{"number", number_of_it},
          {"label", finding.in_words() + " along " + finding.action()},
          {"words", sentence(unnamed(finding))},
          {"variables", names_of(finding.variables)},
          {"with_one_of", names_of(finding.with_one_of)},
          {"direction", name_of(finding.direction)},
          {"rms_um", number(finding.rms * kPerMicro)},
          {"p", probability_text(finding.log10_p)},
          {"log10_p", number(finding.log10_p)},
          {"period_mm", finding.period > 0.0 ? number(finding.period * kPerMilli) : Json()}};
}

Json surface_json(const SurfaceFinding& surface) {
  const double edge = 1.0 / surface.si_per_unit;
  Json formulas = Json::array(), places = Json::array(), dots = Json::array();
  for (const FormulaFinding& formula : surface.formulas) formulas.push_back(formula_json(formula));
  for (const auto& side : surface.figure.places) places.push_back(doubles_json(side));
  for (const auto& side : surface.figure.dots) dots.push_back(doubles_json(side));
  return {{"name", full_name(surface.name)},
          {"label", surface.label},
          {"drivers", written_names(surface.drivers)},
          {"unit", surface.unit},
          {"log_evidence", number(surface.log_evidence)},
          {"largest", number(surface.largest * edge)},
          {"largest_u95", number(kCoverageFactor * surface.largest_u * edge)},
          {"at", doubles_json(surface.at)},
          {"rms", number(surface.rms * edge)},
          {"free", surface.free},
          {"places", std::move(places)},
          {"value", vector_json(surface.figure.value, edge)},
          {"u95", vector_json(surface.figure.u, kCoverageFactor * edge)},
          {"dots", std::move(dots)},
          {"third", number(surface.figure.third)},
          {"formulas", std::move(formulas)}};
}

Json campaign_json(const Session& session) {
  const Campaign& campaign = session.campaign();
  Json setups = Json::array(), columns = Json::array();
  for (const Setup& setup : campaign.setups) setups.push_back(setup_json(setup));
  for (const ColumnInfo& column : recorded_columns(session))
    columns.push_back(
        {{"name", column.name}, {"label", column.label}, {"unit", column.unit}, {"kind", column.kind}});
  return {{"file", campaign.file},
          {"machine", campaign.machine.name},
          {"observations", session.linear().size()},
          {"setups", std::move(setups)},
          {"columns", std::move(columns)}};
}

Json left_out_json(const Campaign& campaign) {
  std::map<std::string, std::size_t> readings;
  for (const Setup& setup : campaign.setups) {
    for (const LeftOutReading& reading : setup.left_out) ++readings[reading.reason];
  }
  Json json = Json::array();
  for (const auto& [reason, count] : readings) json.push_back({{"readings", count}, {"reason", reason}});
  return json;
}

}  // namespace volcal::workbench
