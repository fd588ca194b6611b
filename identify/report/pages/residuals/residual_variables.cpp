/// Residuals of the given model and of the model reached against anything recorded, with the noise they have.

#include <array>

#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/values/shown_variable.h"
#include "volcal/model/description/units.h"

namespace volcal::report {
namespace {

constexpr std::array<const char*, 5> kKinds = {"length", "angle", "X", "Y", "Z"};

Json variable_json(const VariableFigure& variable) {
  const ShownVariable as = shown_variable(variable.name);
  Json json = {{"name", variable.name},
               {"title", as.title},
               {"unit", as.unit},
               {"categories", variable.categories},
               {"x", rounded_array(variable.drawn, as.factor, 5)}};
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    if (variable.given[kind].count.empty()) continue;
    json[kKinds[kind]] = {{"given", binned_json(variable.given[kind], as.factor, kPerMicro)},
                          {"reached", binned_json(variable.reached[kind], as.factor, kPerMicro)}};
  }
  return json;
}

}  // namespace

Json residual_variables_page(const DiagnosisInput& input) {
  const DiagnosisFigures& figures = input.diagnosis.figures;
  Json setup = Json::array(), line = Json::array(), angle = Json::array(), noise = Json::array();
  Json given = Json::array(), reached = Json::array(), heldout = Json::array();
  for (const DrawnObservation& drawn : figures.observations) {
    setup.push_back(drawn.setup);
    line.push_back(drawn.source_line);
    angle.push_back(drawn.angle ? 1 : 0);
    heldout.push_back(drawn.held_out ? 1 : 0);
    noise.push_back(rounded(drawn.noise * kPerMicro, 3));
    given.push_back(rounded(drawn.given * kPerMicro, 4));
    reached.push_back(rounded(drawn.reached * kPerMicro, 4));
  }
  Json variables = Json::array();
  for (const VariableFigure& variable : figures.variables) variables.push_back(variable_json(variable));
  Json setups = Json::array();
  for (const Setup& each : input.campaign.setups) setups.push_back(each.name);
  return {{"total", figures.observation_count},
          {"drawn", figures.observations.size()},
          {"two_models", input.diagnosis.ladder.size() > 1},
          {"setups", std::move(setups)},
          {"records",
           {{"setup", std::move(setup)},
            {"file_line", std::move(line)},
            {"angle", std::move(angle)},
            {"held_out", std::move(heldout)},
            {"noise", std::move(noise)},
            {"given", std::move(given)},
            {"reached", std::move(reached)}}},
          {"variables", std::move(variables)}};
}

}  // namespace volcal::report
