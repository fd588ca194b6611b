#include "volcal/sim/measurement/environment.h"

#include <cmath>
#include <numbers>

#include "volcal/sim/machine/truth_machine.h"

namespace volcal::sim {

double TemperatureChannel::at(double time) const {
  const double wave = amplitude * std::sin(2.0 * std::numbers::pi * time / period + phase);
  return start + drift * time + wave + (time >= step_time ? step : 0.0);
}

double TemperatureChannel::lagged(double time, double time_constant) const {
  const double left = std::exp(-time / time_constant);
  const double ramp = drift * (time - time_constant * (1.0 - left));
  const double turn = 2.0 * std::numbers::pi * time_constant / period;
  const auto steady_wave = [&](double angle) {
    return amplitude * (std::sin(angle) - turn * std::cos(angle)) / (1.0 + turn * turn);
  };
  const double wave = steady_wave(2.0 * std::numbers::pi * time / period + phase) +
                      left * (amplitude * std::sin(phase) - steady_wave(phase));
  double jump = time >= step_time ? step : 0.0;
  if (step_time > 0.0) jump *= 1.0 - std::exp(-(time - step_time) / time_constant);
  return start + ramp + wave + jump;
}

std::map<std::string, double> Environment::temperatures(double time) const {
  std::map<std::string, double> values;
  for (const TemperatureChannel& channel : channels) values[channel.name] = channel.at(time);
  return values;
}

std::map<std::string, double> Environment::reference_temperatures() const {
  std::map<std::string, double> values;
  for (const TemperatureChannel& channel : channels) values[channel.name] = kReferenceTemperature;
  return values;
}

}  // namespace volcal::sim
