#include "volcal/sim/environment.h"

#include <cmath>
#include <numbers>

#include "volcal/sim/truth_machine.h"

namespace volcal::sim {

double TemperatureChannel::at(double time) const {
  const double wave = amplitude * std::sin(2.0 * std::numbers::pi * time / period + phase);
  return start + drift * time + wave + (time >= step_time ? step : 0.0);
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
