/// Standard uncertainties of the table values by linear propagation and by Monte Carlo.

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/montecarlo_text.h"
#include "volcal/identify/report/values/quantity_groups.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {
namespace {

Json verdict_counts(const MonteCarloResult& study) {
  std::size_t validated = 0, undecided = 0;
  for (const QuantityResult& value : study.quantities) {
    if (value.verdict == LinearVerdict::Validated) ++validated;
    if (value.verdict == LinearVerdict::Undecided) ++undecided;
  }
  return {{"validated", validated},
          {"undecided", undecided},
          {"not_validated", study.quantities.size() - validated - undecided}};
}

/// One direction of one error function.
Json curve_of_study(const MonteCarloResult& study, const std::vector<std::size_t>& values) {
  Json result = {
      {"q", Json::array()}, {"linear", Json::array()}, {"u", Json::array()}, {"bias", Json::array()}};
  for (const std::size_t i : values) {
    const QuantityResult& value = study.quantities[i];
    const Quantity& quantity = value.quantity;
    result["q"].push_back(rounded(quantity.position * position_factor(*quantity.axis), 7));
    result["linear"].push_back(rounded(value.u_linear / quantity.si_per_unit, 4));
    result["u"].push_back(rounded(value.u / quantity.si_per_unit, 4));
    result["bias"].push_back(rounded(value.bias / quantity.si_per_unit, 3));
  }
  return result;
}

Json functions(const MonteCarloResult& study) {
  Json list = Json::array();
  for (const QuantityGroup& group : quantity_groups(study)) {
    const Quantity& first = study.quantities[group.values.front()].quantity;
    if (first.kind != QuantityKind::TableValue || !first.axis) continue;
    Json function = {{"symbol", group.name},
                     {"axis", axis_letter(*first.axis)},
                     {"unit", shown_unit(group.unit)},
                     {"position_unit", position_unit(*first.axis).suffix},
                     {"curves", Json::array()}};
    for (const int direction : {0, 1, -1}) {
      std::vector<std::size_t> own;
      for (const std::size_t i : group.values) {
        if (study.quantities[i].quantity.direction == direction) own.push_back(i);
      }
      if (own.empty()) continue;
      Json values = curve_of_study(study, own);
      values["direction"] = direction;
      function["curves"].push_back(std::move(values));
    }
    list.push_back(std::move(function));
  }
  return list;
}

Json others(const MonteCarloResult& study) {
  Json rows = Json::array();
  for (const QuantityResult& value : study.quantities) {
    const Quantity& quantity = value.quantity;
    const bool listed = !quantity.axis && quantity.kind != QuantityKind::VolumetricError;
    if (!listed) continue;
    const double unit = quantity.si_per_unit;
    rows.push_back({{"name", quantity.words()},
                    {"unit", shown_unit(quantity.unit)},
                    {"linear", rounded(value.u_linear / unit, 4)},
                    {"u", rounded(value.u / unit, 4)},
                    {"bias", rounded(value.bias / unit, 3)},
                    {"bias_error", rounded(value.bias_error / unit, 2)},
                    {"verdict", std::string(to_string(value.verdict))}});
  }
  return rows;
}

/// The conditions, and what the fit said first.
Json messages(const MonteCarloResult& study) {
  std::vector<Finding> all = study.condition_findings;
  all.insert(all.end(), study.contradicted.begin(), study.contradicted.end());
  all.insert(all.end(), study.notes.begin(), study.notes.end());
  std::vector<std::string> texts = sentences(all);
  std::string stated = stated_for_text(study.conditions);
  if (!stated.empty()) {
    stated.back() = '.';
    texts.insert(texts.begin(), stated);
  }
  return texts;
}

}  // namespace

Json uncertainties_page(const MonteCarloPageInput& input) {
  const MonteCarloResult& study = input.study;
  return {{"draws", study.draws},
          {"seed", study.seed},
          {"path", std::string(to_string(study.path))},
          {"digits", study.digits},
          {"not_converged", study.not_converged},
          {"disturbances", study.disturbances},
          {"verdicts", verdict_counts(study)},
          {"refits", study.check.linear.draws},
          {"linear_share", rounded(study.check.linear.largest_share, 2)},
          {"chord_share", rounded(study.check.chord.largest_share, 2)},
          {"held", held_by_steps_text(study)},
          {"messages", messages(study)},
          {"functions", functions(study)},
          {"others", others(study)}};
}

}  // namespace volcal::report
