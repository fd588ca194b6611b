#include "volcal/identify/io/results/montecarlo_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "volcal/identify/text/csv_cell.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using MonteCarloJson = nlohmann::ordered_json;

MonteCarloJson finite(double value) {
  return std::isfinite(value) ? MonteCarloJson(value) : MonteCarloJson(nullptr);
}

MonteCarloJson interval_json(const CoverageInterval& interval, double per_unit) {
  return {finite(interval.low / per_unit), finite(interval.high / per_unit)};
}

MonteCarloJson quantity_json(const QuantityResult& value) {
  const Quantity& quantity = value.quantity;
  const double unit = quantity.si_per_unit;
  MonteCarloJson json = {{"kind", std::string(to_string(quantity.kind))}, {"name", quantity.name}};
  if (quantity.axis) {
    json["axis"] = std::string(1, letter_of(*quantity.axis));
    json["position"] = quantity.position / position_unit(*quantity.axis).si_per_unit;
    json["position_unit"] = position_unit(*quantity.axis).suffix;
    json["direction"] = quantity.direction;
  }
  if (quantity.is_of_volume()) json["tool"] = quantity.tool;
  if (quantity.at) {
    for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z})
      json["at_mm"].push_back((*quantity.at)[index_of(axis)] / kMetrePerMillimetre);
  }
  json["unit"] = quantity.unit;
  json["estimate"] = finite(quantity.estimate / unit);
  json["u_linear"] = finite(value.u_linear / unit);
  json["u"] = finite(value.u / unit);
  json["bias"] = finite(value.bias / unit);
  json["bias_error"] = finite(value.bias_error / unit);
  json["bias_linear"] = finite(value.bias_linear / unit);
  json["symmetric"] = interval_json(value.symmetric, unit);
  json["shortest"] = interval_json(value.shortest, unit);
  json["linear"] = interval_json(value.linear, unit);
  json["tolerance"] = finite(value.tolerance / unit);
  json["difference"] = finite(value.difference / unit);
  json["verdict"] = std::string(to_string(value.verdict));
  return json;
}

MonteCarloJson check_json(const PathCheck& check) {
  return {{"draws", check.draws},
          {"largest_difference_nm", finite(check.largest_length * 1e9)},
          {"largest_difference_nrad", finite(check.largest_angle * 1e9)},
          {"largest_share_of_tolerance", finite(check.largest_share)},
          {"where", check.where}};
}

/// Of table values and the volume.
MonteCarloJson stated_conditions_json(const MonteCarloResult& result) {
  MonteCarloJson json = MonteCarloJson::object();
  for (const StatedCondition& condition : result.conditions)
    json[condition.name()] = {{"value", finite(condition.value)}, {"origin", condition.origin}};
  return json;
}

}  // namespace

std::string montecarlo_json(const MonteCarloResult& result) {
  MonteCarloJson json = {{"format", kMonteCarloFormat},
                         {"path", std::string(to_string(result.path))},
                         {"functions", result.functions == FunctionRoughness::Drawn ? "drawn" : "fixed"},
                         {"disturbances", result.disturbances},
                         {"draws", result.draws},
                         {"seed", result.seed},
                         {"digits", result.digits},
                         {"adaptive", result.adaptive},
                         {"settled", result.settled},
                         {"coverage", kCoverageProbability},
                         {"conditions", stated_conditions_json(result)},
                         {"refitted", result.refitted},
                         {"not_converged", result.not_converged},
                         {"against_refits",
                          {{"refits_not_converged", result.check.not_converged},
                           {"linear", check_json(result.check.linear)},
                           {"chord", check_json(result.check.chord)}}}};
  json["quantities"] = MonteCarloJson::array();
  for (const QuantityResult& value : result.quantities) json["quantities"].push_back(quantity_json(value));
  json["sources"] = result.budget.sources;
  for (std::size_t i = 0; i < result.quantities.size(); ++i) {
    MonteCarloJson& of_quantity = json["quantities"][i]["u_of_sources"];
    of_quantity = MonteCarloJson::array();
    for (const double u : result.budget.u.row(static_cast<Eigen::Index>(i)))
      of_quantity.push_back(finite(u / result.quantities[i].quantity.si_per_unit));
  }
  add_findings("on_conditions", result.condition_findings, json);
  add_findings("contradicted", result.contradicted, json);
  add_notes(result.notes, json);
  return json_text(json, 1) + "\n";
}

std::string undetermined_json(const FitResult& fit, const std::vector<Finding>& notes) {
  MonteCarloJson json = {{"format", kMonteCarloFormat},
                         {"status", std::string(to_string(fit.status))},
                         {"draws", 0},
                         {"rank",
                          {{"parameters", fit.rank.parameters},
                           {"rank", fit.rank.rank},
                           {"invisible", sentences(fit.rank.invisible)}}}};
  add_notes(notes, json);
  return json_text(json, 1) + "\n";
}

std::string montecarlo_csv(const MonteCarloResult& result) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(
      out,
      "kind,name,axis,position,position_unit,direction,tool,x_mm,y_mm,z_mm,unit,estimate,u_linear,u,"
      "ratio,bias,bias_error,symmetric_low,symmetric_high,shortest_low,shortest_high,linear_low,"
      "linear_high,tolerance,difference,validated\n");
  for (const QuantityResult& value : result.quantities) {
    const Quantity& quantity = value.quantity;
    const double unit = quantity.si_per_unit;
    fmt::format_to(out, "{},{},", to_string(quantity.kind), csv_cell(quantity.name));
    if (quantity.axis) {
      fmt::format_to(out, "{},{:.10g},{},{},", letter_of(*quantity.axis),
                     quantity.position / position_unit(*quantity.axis).si_per_unit,
                     position_unit(*quantity.axis).suffix, quantity.direction);
    } else {
      fmt::format_to(out, ",,,,");
    }
    fmt::format_to(out, "{},", csv_cell(quantity.tool));
    for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z}) {
      if (quantity.at) fmt::format_to(out, "{:.10g}", (*quantity.at)[index_of(axis)] / kMetrePerMillimetre);
      fmt::format_to(out, ",");
    }
    const bool has_u = std::isfinite(value.u);
    fmt::format_to(out, "{},{:.9g},{:.6g},", quantity.unit, quantity.estimate / unit, value.u_linear / unit);
    if (has_u) fmt::format_to(out, "{:.6g}", value.u / unit);
    fmt::format_to(out, ",");
    if (has_u && value.u_linear > 0.0) fmt::format_to(out, "{:.5f}", value.u / value.u_linear);
    fmt::format_to(out, ",{:.4g},", value.bias / unit);
    if (has_u) fmt::format_to(out, "{:.3g}", value.bias_error / unit);
    fmt::format_to(out, ",{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.3g},{:.4g},",
                   value.symmetric.low / unit, value.symmetric.high / unit, value.shortest.low / unit,
                   value.shortest.high / unit, value.linear.low / unit, value.linear.high / unit,
                   value.tolerance / unit, value.difference / unit);
    if (value.verdict != LinearVerdict::Undecided)
      fmt::format_to(out, "{}", value.verdict == LinearVerdict::Validated ? 1 : 0);
    fmt::format_to(out, "\n");
  }
  return fmt::to_string(text);
}

}  // namespace volcal
