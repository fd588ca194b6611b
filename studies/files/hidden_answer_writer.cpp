#include "volcal/studies/files/hidden_answer_writer.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "volcal/identify/text/json_text.h"
#include "volcal/model/description/units.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFirstRow = 2;  ///< below the header

/// Twelve digits: what the study said comes back as it was written.
double rounded(double value) {
  if (value == 0.0) return 0.0;
  const double scale = std::pow(10.0, 11.0 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(scale) ? std::round(value * scale) / scale : value;
}

void write_key(const KeySchema& key, const Options& options, Json& json) {
  const std::string stem(stem_of_key(key.key));
  const double factor = unit_of_key(key.key).si_per_unit;
  if (const auto number = options.number(stem)) json[key.key] = rounded(*number / factor);
  if (const auto text = options.text(stem)) json[key.key] = *text;
  if (const auto vector = options.vector(stem)) {
    json[key.key] = {rounded(vector->x() / factor), rounded(vector->y() / factor),
                     rounded(vector->z() / factor)};
  }
}

Json effect_json(const sim::HiddenAnswer& answer) {
  const sim::HiddenKind& kind = *sim::find_hidden_kind(answer.effect.kind);
  const std::string unit = amplitude_unit(answer.effect);
  Json json = {{"kind", kind.kind}, {"group", kind.group}, {"formula", kind.formula}};
  for (const KeySchema& key : kind.keys) write_key(key, answer.effect.options, json);
  json["amplitude"] = rounded(answer.amplitude / unit_of_key("amplitude_" + unit).si_per_unit);
  json["unit"] = unit;
  json["per"] = kind.per;
  json["rms_um"] = rounded(answer.rms * kPerMicro);
  json["rms_within_setups_um"] = rounded(answer.rms_within_setups * kPerMicro);
  return json;
}

Json noise_json(const sim::SetupPlan& plan) {
  const std::string unit = "_" + noise_group_unit(plan.instrument);
  const sim::NoiseLevel& noise = plan.noise;
  return {{"setup", plan.name},
          {"wander" + unit, rounded(noise.drift * kPerMicro)},
          {"wander_time_s", noise.drift_time},
          {"line" + unit, rounded(noise.line * kPerMicro)},
          {"outlier_share", noise.outlier_share},
          {"outlier_sigma", noise.outlier_size}};
}

}  // namespace

std::string hidden_answer_json(const sim::SimulatedCampaign& simulated) {
  Json json = {{"format", "volcal-hidden-1"},
               {"effects", Json::array()},
               {"noise", Json::array()},
               {"outliers", Json::array()}};
  for (const sim::HiddenAnswer& answer : simulated.hidden) json["effects"].push_back(effect_json(answer));
  for (const sim::SetupPlan& plan : simulated.plans) json["noise"].push_back(noise_json(plan));
  for (const sim::GrossError& error : simulated.outliers) {
    json["outliers"].push_back({{"setup", error.setup},
                                {"row", error.row + kFirstRow},
                                {"channel", error.channel},
                                {"sign", error.sign}});
  }
  return json_text(json, 2) + "\n";
}

}  // namespace volcal
