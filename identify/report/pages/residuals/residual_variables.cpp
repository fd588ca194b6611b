/// Residuals of the given model and of the model reached against anything recorded, with the noise they have.

#include <array>

#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/model/description/units.h"

namespace volcal::report {
namespace {

constexpr std::array<const char*, 5> kKinds = {"length", "angle", "X", "Y", "Z"};

struct Shown {
  std::string title;
  std::string unit;
  double factor = 1.0;
};

/// Title and edge unit of a variable of the scan.
Shown shown(const std::string& name) {
  if (name.size() == 1 && std::string("xyz").find(name) != std::string::npos) {
    return {"Position " + name, "mm", kPerMilli};
  }
  if (name.size() == 1) return {"Position " + name, "deg", 1.0 / kRadianPerDegree};
  if (name.starts_with("dir_")) return {"Direction of " + name.substr(4), "", 1.0};
  if (name.starts_with("T_")) return {"Temperature " + name.substr(2), "°C", 1.0};
  if (name == "time") return {"Time", "min", 1.0 / kSecondsPerMinute};
  if (name == "length") return {"Measured length", "mm", kPerMilli};
  if (name == "feed") return {"Feed", "mm/min", kPerMilli * kSecondsPerMinute};
  if (name == "elevation") return {"Elevation of the beam", "deg", 1.0 / kRadianPerDegree};
  if (name == "run") return {"Run", "", 1.0};
  if (name.starts_with("tool ")) return {"Tool " + name.substr(5), "", 1.0};
  if (name.starts_with("station ")) return {"Station " + name.substr(8), "", 1.0};
  if (name == "setup") return {"Setup", "", 1.0};
  if (name == "station") return {"Station", "", 1.0};
  if (name == "tool") return {"Tool", "", 1.0};
  return {name, "", 1.0};
}

Json variable_json(const VariableFigure& variable) {
  const Shown as = shown(variable.name);
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
