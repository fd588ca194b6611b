#pragma once
/// A machine whose scale of X expands with a temperature. Points along X, from home to the end of a travel of
/// 1 m, are off by a (T - 20 degC) x.

#include <string>

#include "tests/support/machines.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/campaign.h"

namespace volcal::testing_support {

inline constexpr double kSigmaOfPoints = 0.4e-6;  // m
inline constexpr double kStated = 14e-6, kStatedSigma = 3e-6, kIdentified = 10e-6;
inline constexpr int kPoints = 11;

/// `per_kelvin` is the true coefficient; the machine file says 14 +- 3 um/m/K.
inline Campaign points_at(double temperature_degC, double per_kelvin, double stated_sigma = kStatedSigma) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("w b X Y Z t");
  campaign.machine.axes[0].expansion = ScaleExpansion{kStated, stated_sigma, "scale"};
  campaign.machine.tools = {{"one", {0.0, 0.0, -0.2}, 0.0}};
  Setup& setup = campaign.setups.emplace_back();
  setup.name = "points";
  setup.instrument = "volumetric-points";
  setup.options.set("alignment", std::string("none"));
  setup.noise.set("constant", kSigmaOfPoints);
  setup.has_noise = true;
  setup.readings.value.resize(3);
  for (int row = 0; row < kPoints; ++row) {
    const double x = row / (kPoints - 1.0);
    for (const AxisName axis : kAllAxes)
      setup.readings.position[index_of(axis)].push_back(axis == AxisName::X ? x : 0.0);
    setup.readings.value[0].push_back(per_kelvin * (temperature_degC - 20.0) * x);
    setup.readings.value[1].push_back(0.0);
    setup.readings.value[2].push_back(0.0);
    setup.readings.temperature["scale"].push_back(temperature_degC);
    setup.readings.source_line.push_back(row + 2);
  }
  return campaign;
}

/// Without errors but for a straightness.
inline ModelSpec model_of_points() {
  ModelSpec model = nominal_model();
  for (const char* symbol : {"EC0Y", "EB0Z", "EA0Z"})
    model.locations_off.push_back(*LocationSymbol::parse(symbol));
  FunctionSpec curve;
  curve.basis = "legendre";
  curve.degree = 3;
  model.functions[*ErrorSymbol::parse("EYX")] = curve;
  return model;
}

inline FitResult fitted(const Campaign& campaign, const ModelSpec& model = model_of_points()) {
  FitOptions options;
  options.noise = NoisePolicy::White;
  options.variance_components = false;
  return fit(campaign, model, options);
}

}  // namespace volcal::testing_support
