#pragma once
/// What surrounds the machine while it is measured: temperatures against the campaign's clock. degC and s.

#include <map>
#include <string>
#include <vector>

namespace volcal::sim {

/// T(t) = start + drift t + amplitude sin(2 pi t / period + phase) + step after step_time.
struct TemperatureChannel {
  std::string name;         ///< column T_<name>_degC
  double start = 20.0;      ///< degC
  double drift = 0.0;       ///< K/s
  double amplitude = 0.0;   ///< K
  double period = 86400.0;  ///< s
  double phase = 0.0;       ///< rad
  double step = 0.0;        ///< K
  double step_time = 0.0;   ///< s

  double at(double time) const;
  /// What a body of first order with this time constant (s) has followed to, in balance at time 0.
  double lagged(double time, double time_constant) const;
};

struct Environment {
  std::vector<TemperatureChannel> channels;

  std::map<std::string, double> temperatures(double time) const;
  /// All channels at 20 degC.
  std::map<std::string, double> reference_temperatures() const;
};

}  // namespace volcal::sim
