#include "volcal/identify/io/results/result_json.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "volcal/identify/io/results/result_json_parts.h"
#include "volcal/identify/text/json_input.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

using Json = nlohmann::ordered_json;
using json_parts::number;

double ratio(double chi2, double dof) { return dof > 0.0 ? chi2 / dof : std::nan(""); }

Json setups_json(const FitResult& result) {
  Json all = Json::array();
  for (const SetupSummary& setup : result.setups) {
    all.push_back({{"name", setup.name},
                   {"instrument", setup.instrument},
                   {"tool", setup.tool},
                   {"reading_unit", setup.reading_unit},
                   {"observations", setup.observations},
                   {"chi2", number(setup.chi2)},
                   {"dof", number(setup.redundancy)},
                   {"chi2_per_dof", number(ratio(setup.chi2, setup.redundancy))},
                   {"rms_residual", number(setup.rms_residual)},
                   {"max_residual", number(setup.max_residual)},
                   {"readings_fingerprint", setup.fingerprint}});
  }
  return all;
}

Json variance_components_json(const FitResult& result) {
  Json all = Json::array();
  for (const VarianceComponent& component : result.variance_components) {
    all.push_back({{"instrument", component.instrument},
                   {"scale", number(component.scale)},
                   {"scale_u", number(component.scale_u)},
                   {"redundancy", number(component.redundancy)},
                   {"observations", component.observations}});
  }
  return all;
}

Json noise_json(const NoiseSummary& noise) {
  Json rows = Json::array();
  for (const NoiseRow& row : noise.rows) {
    rows.push_back({{"instrument", noise.groups.at(row.instrument)},
                    {"term", row.term},
                    {"unit", row.unit},
                    {"value", number(row.value)},
                    {"low", number(row.low)},
                    {"high", number(row.high)},
                    {"likelihood_ratio", number(row.likelihood_ratio)},
                    {"remark", row.remark}});
  }
  return {{"estimated", noise.estimated},
          {"more_than_white", noise.more_than_white},
          {"whitened_chi2", number(noise.chi2)},
          {"whitened_dof", number(noise.dof)},
          {"whitened_chi2_per_dof", number(ratio(noise.chi2, noise.dof))},
          {"terms", rows}};
}

Json functions_json(const FitResult& result) {
  Json all = Json::array();
  for (const FunctionSummary& function : result.functions) {
    all.push_back({{"symbol", function.symbol.name()},
                   {"intervals", function.intervals},
                   {"smoothed", function.smoothed},
                   {"prior", function.prior},
                   {"correlation_length", number(function.correlation_length)},
                   {"effective_parameters", number(function.effective_parameters)},
                   {"measured_min", number(function.measured_min)},
                   {"measured_max", number(function.measured_max)}});
  }
  return all;
}

Json rank_json(const RankReport& rank) {
  Json errors = Json::array();
  for (const Observability& error : rank.errors) {
    const Explanation words = explanation(error.cause);
    errors.push_back({{"symbol", error.symbol.name()},
                      {"visible", error.visible},
                      {"visible_fraction", number(error.visible_fraction)},
                      {"u_rms", number(error.u_rms)},
                      {"effective_parameters", number(error.effective_parameters)},
                      {"reason", words.reason},
                      {"remedy", words.remedy}});
    if (error.cause) errors.back()["finding"] = finding_json(*error.cause);
  }
  return {{"parameters", rank.parameters},
          {"rank", rank.rank},
          {"invisible", sentences(rank.invisible)},
          {"invisible_findings", findings_json(rank.invisible)},
          {"held_by_prior", sentences(rank.held_by_prior)},
          {"held_by_prior_findings", findings_json(rank.held_by_prior)},
          {"errors", errors}};
}

Json locations_json(const FitResult& result) {
  Json all = Json::array();
  for (const ParameterBlock& block : result.layout.blocks) {
    if (!block.location || block.size() != 1 || block.offset >= result.parameters.size()) continue;
    const double variance = block.offset < result.covariance.rows()
                                ? result.covariance(block.offset, block.offset)
                                : std::nan("");
    all.push_back({{"symbol", block.location->name()},
                   {"value", number(result.parameters[block.offset])},
                   {"u", number(std::sqrt(variance))}});
  }
  return all;
}

constexpr std::string_view kOfTables = "tables", kAssumed = "assumed";

/// "origin" where it is not a campaign.
Json range_json(const RecordedRange& range) {
  Json json = {{"min", number(range.min)}, {"mean", number(range.mean)}, {"max", number(range.max)}};
  if (range.origin != ConditionOrigin::Campaign)
    json["origin"] = range.origin == ConditionOrigin::Tables ? kOfTables : kAssumed;
  return json;
}

RecordedRange range_from(const Json& json) {
  const std::string origin = json.value("origin", std::string());
  return {number(json.at("min")), number(json.at("mean")), number(json.at("max")),
          origin == kOfTables  ? ConditionOrigin::Tables
          : origin == kAssumed ? ConditionOrigin::Assumed
                               : ConditionOrigin::Campaign};
}

Json conditions_json(const RecordedConditions& conditions) {
  Json temperatures = Json::object();
  for (const auto& [channel, range] : conditions.temperature_degC) temperatures[channel] = range_json(range);
  Json json = {{"temperature_degC", temperatures}};
  if (conditions.time) json["time_s"] = range_json(*conditions.time);
  if (conditions.feed) json["feed_m_per_s"] = range_json(*conditions.feed);
  return json;
}

RecordedConditions conditions_from(const Json& json) {
  RecordedConditions conditions;
  for (const auto& [channel, range] : json.at("temperature_degC").items())
    conditions.temperature_degC[channel] = range_from(range);
  if (json.contains("time_s")) conditions.time = range_from(json.at("time_s"));
  if (json.contains("feed_m_per_s")) conditions.feed = range_from(json.at("feed_m_per_s"));
  return conditions;
}

Json provenance_json(const Provenance& provenance) {
  return {{"version", provenance.version}, {"date", provenance.date}, {"command", provenance.command}};
}

Json head_json(const FitResult& result) {
  return {{"format", kResultFormat},
          {"units", "m, rad, s, K; an error is actual minus nominal, tool relative to workpiece"},
          {"status", std::string(to_string(result.status))},
          {"messages", sentences(result.findings)},
          {"findings", findings_json(result.findings)},
          {"provenance", provenance_json(result.provenance)},
          {"sigma0", number(result.sigma0)},
          {"chi2", number(result.chi2)},
          {"dof", number(result.dof)},
          {"chi2_per_dof", number(ratio(result.chi2, result.dof))},
          {"coverage_factor", number(result.coverage_factor)},
          {"iterations", result.iterations},
          {"initial_cost", number(result.initial_cost)},
          {"final_cost", number(result.final_cost)},
          {"outlier_critical_value", number(result.outlier_critical_value)},
          {"reference_temperature_degC", number(result.reference_temperature_degC)},
          {"temperature_is_campaign_mean", result.temperature_is_campaign_mean},
          {"conditions", conditions_json(result.conditions)},
          {"active_compensations", result.active_compensations},
          {"alignment", result.alignment},
          {"straightness_reference_line", "least squares, continuous over the travel"},
          {"setups", setups_json(result)},
          {"variance_components", variance_components_json(result)},
          {"noise", noise_json(result.noise)},
          {"functions", functions_json(result)},
          {"locations", locations_json(result)},
          {"rank", rank_json(result.rank)}};
}

Json timings_json(const FitResult& result) {
  Json all = Json::array();
  for (const Timing& timing : result.timings) {
    all.push_back({{"stage", timing.stage}, {"seconds", number(timing.seconds)}});
  }
  return all;
}

FitStatus status_from(const std::string& text) {
  for (const FitStatus status :
       {FitStatus::Ok, FitStatus::LackOfFit, FitStatus::RankDeficient, FitStatus::NotConverged}) {
    if (to_string(status) == text) return status;
  }
  throw std::invalid_argument("status \"" + printable(text) + "\" is not known");
}

NoiseSummary noise_from(const Json& json) {
  NoiseSummary noise;
  noise.estimated = json.at("estimated").get<bool>();
  noise.more_than_white = json.at("more_than_white").get<bool>();
  noise.chi2 = number(json.at("whitened_chi2"));
  noise.dof = number(json.at("whitened_dof"));
  for (const Json& row : json.at("terms")) {
    const auto instrument = row.at("instrument").get<std::string>();
    const auto known = std::ranges::find(noise.groups, instrument);
    const auto place = static_cast<std::size_t>(known - noise.groups.begin());
    if (known == noise.groups.end()) noise.groups.push_back(instrument);
    noise.rows.push_back({.instrument = place,
                          .term = row.at("term").get<std::string>(),
                          .unit = row.at("unit").get<std::string>(),
                          .value = number(row.at("value")),
                          .low = number(row.at("low")),
                          .high = number(row.at("high")),
                          .likelihood_ratio = number(row.at("likelihood_ratio")),
                          .remark = row.at("remark").get<std::string>()});
  }
  return noise;
}

Provenance provenance_from(const Json& json) {
  return {.version = json.at("version").get<std::string>(),
          .date = json.at("date").get<std::string>(),
          .command = json.at("command").get<std::string>()};
}

/// The sentences of json[key] with their codes, where the file has them.
std::vector<Finding> findings_beside(const Json& json, const std::string& key, const std::string& codes) {
  return findings_from(value_or_null(json, codes), json.at(key).get<std::vector<std::string>>());
}

/// Absent where every rotary axis moved, and in results of older programs.
void read_standing(const Json& json, FitResult& result) {
  if (!json.contains("standing")) return;
  for (const auto& [letter, position] : json.at("standing").items()) {
    const auto axis = letter.size() == 1 ? axis_from_letter(letter[0]) : std::nullopt;
    if (!axis || !is_rotary(*axis))
      throw std::invalid_argument("\"" + printable(letter) + "\" is not a rotary axis");
    result.standing[*axis] = number(position);
  }
}

void read_head(const Json& json, FitResult& result) {
  result.status = status_from(json.at("status").get<std::string>());
  result.findings = findings_beside(json, "messages", "findings");
  if (json.contains("provenance")) result.provenance = provenance_from(json.at("provenance"));
  result.sigma0 = number(json.at("sigma0"));
  result.chi2 = number(json.at("chi2"));
  result.dof = number(json.at("dof"));
  result.coverage_factor = number(json.at("coverage_factor"));
  result.iterations = json.at("iterations").get<int>();
  result.initial_cost = number(json.at("initial_cost"));
  result.final_cost = number(json.at("final_cost"));
  result.outlier_critical_value = number(json.at("outlier_critical_value"));
  result.reference_temperature_degC = number(json.at("reference_temperature_degC"));
  result.temperature_is_campaign_mean = json.at("temperature_is_campaign_mean").get<bool>();
  if (json.contains("conditions")) result.conditions = conditions_from(json.at("conditions"));
  result.active_compensations = json.value("active_compensations", std::string());
  result.alignment = json.value("alignment", std::string());
  read_standing(json, result);
  for (const Json& setup : json.at("setups")) {
    result.setups.push_back({.name = setup.at("name").get<std::string>(),
                             .instrument = setup.at("instrument").get<std::string>(),
                             .tool = setup.at("tool").get<std::string>(),
                             .reading_unit = setup.at("reading_unit").get<std::string>(),
                             .observations = setup.at("observations").get<std::size_t>(),
                             .chi2 = number(setup.at("chi2")),
                             .redundancy = number(setup.at("dof")),
                             .rms_residual = number(setup.at("rms_residual")),
                             .max_residual = number(setup.at("max_residual")),
                             .fingerprint = setup.value("readings_fingerprint", std::string())});
  }
  for (const Json& component : json.at("variance_components")) {
    result.variance_components.push_back({.instrument = component.at("instrument").get<std::string>(),
                                          .scale = number(component.at("scale")),
                                          .scale_u = number(component.at("scale_u")),
                                          .redundancy = number(component.at("redundancy")),
                                          .observations = component.at("observations").get<std::size_t>()});
  }
  if (json.contains("noise")) result.noise = noise_from(json.at("noise"));
  for (const Json& function : json.at("functions")) {
    result.functions.push_back({.symbol = json_parts::error_symbol(function.at("symbol")),
                                .intervals = function.at("intervals").get<int>(),
                                .smoothed = function.at("smoothed").get<bool>(),
                                .prior = function.at("prior").get<std::string>(),
                                .correlation_length = number(function.at("correlation_length")),
                                .effective_parameters = number(function.at("effective_parameters")),
                                .measured_min = number(function.at("measured_min")),
                                .measured_max = number(function.at("measured_max"))});
  }
  for (const Json& timing : json.at("timings")) {
    result.timings.push_back({timing.at("stage").get<std::string>(), number(timing.at("seconds"))});
  }
}

/// Files without codes tell why in words.
std::optional<Finding> cause_from(const Json& error) {
  const auto symbol = error.at("symbol").get<std::string>();
  const auto reason = error.at("reason").get<std::string>();
  const auto remedy = error.at("remedy").get<std::string>();
  if (error.at("visible").get<bool>()) return std::nullopt;
  const Finding in_words{FindingCode::NotVisibleVerbatim,
                         {{"error", symbol}, {"reason", reason}, {"remedy", remedy}}};
  if (!error.contains("finding")) return in_words;
  const Finding cause = finding_from(error.at("finding"), in_words);
  static_cast<void>(explanation(cause));
  return cause;
}

RankReport rank_from(const Json& json) {
  RankReport rank;
  rank.parameters = json.at("parameters").get<int>();
  rank.rank = json.at("rank").get<int>();
  rank.invisible = findings_beside(json, "invisible", "invisible_findings");
  rank.held_by_prior = findings_beside(json, "held_by_prior", "held_by_prior_findings");
  for (const Json& error : json.at("errors")) {
    rank.errors.push_back({.symbol = MachineError::parse(error.at("symbol").get<std::string>()),
                           .visible = error.at("visible").get<bool>(),
                           .visible_fraction = number(error.at("visible_fraction")),
                           .u_rms = number(error.at("u_rms")),
                           .effective_parameters = number(error.at("effective_parameters")),
                           .cause = cause_from(error)});
  }
  return rank;
}

FitResult result_from(const Json& json) {
  const auto format = json.at("format").get<std::string>();
  if (format != kResultFormat) throw std::invalid_argument("format is \"" + printable(format) + "\"");
  FitResult result;
  read_head(json, result);
  result.rank = rank_from(json.at("rank"));
  result.machine = json_parts::machine_from(json.at("machine"));
  result.identified = json_parts::model_from(json.at("model"));
  result.parameters = json_parts::vector_from(json.at("parameters"));
  result.layout = json_parts::layout_from(json.at("layout"), result.machine, result.identified);
  result.covariance = json_parts::covariance_from(json.at("covariance"));
  if (result.parameters.size() != result.layout.size)
    throw std::invalid_argument("parameters do not fit the layout");
  const bool is_stated = result.setups.empty() && result.covariance.size() == 0;
  if (!is_stated && result.covariance.rows() != result.parameters.size())
    throw std::invalid_argument("covariance does not fit the parameters");
  return result;
}

}  // namespace

std::string result_json(const FitResult& result) {
  Json json = head_json(result);
  for (const auto& [axis, position] : result.standing)
    json["standing"][std::string(1, letter_of(axis))] = number(position);
  json["timings"] = timings_json(result);
  json["machine"] = json_parts::machine(result.machine);
  json["model"] = json_parts::model(result.identified);
  json["layout"] = json_parts::layout(result.layout);
  json["parameters"] = json_parts::vector(result.parameters);
  std::string text = json_text(json, 1);
  text.replace(text.size() - 2, 2,
               ",\n \"covariance\": " + json_parts::covariance_text(result.covariance) + "\n}\n");
  return text;
}

std::string result_summary_json(const FitResult& result) {
  Json json = head_json(result);
  json["timings"] = timings_json(result);
  return json_text(json, 1) + "\n";
}

FitResult result_from_json(const std::string& text, const std::string& file) {
  return read_json(text, file, "result", "give a folder that volcal fit wrote, or run the fit again",
                   [](const Json& json) {
                     json_parts::require_no_control(json);
                     return result_from(json);
                   });
}

}  // namespace volcal
