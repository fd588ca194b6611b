#include "volcal/sim/measurement/noise.h"

#include <cmath>
#include <map>
#include <string>

#include "volcal/sim/machine/random.h"
#include "volcal/sim/measurement/simulated_instruments.h"

namespace volcal::sim {
namespace {

RandomStream stream(const std::string& purpose, const SetupPlan& plan, std::size_t channel,
                    std::uint64_t seed) {
  return {seed, purpose + " " + std::to_string(channel) + " of " + plan.name};
}

std::vector<double> drift(const SetupPlan& plan, std::size_t channel, std::uint64_t seed) {
  RandomStream random = stream("wander", plan, channel, seed);
  const double kept = std::exp(-plan.seconds_per_reading / plan.noise.drift_time);
  const double fresh = std::sqrt(1.0 - kept * kept);
  std::vector<double> values;
  double x = random.normal();
  for (std::size_t row = 0; row < plan.points.size(); ++row) {
    values.push_back(plan.noise.drift * x);
    x = kept * x + fresh * random.normal();
  }
  return values;
}

void add_line_offsets(const SetupPlan& plan, std::size_t channel, std::uint64_t seed,
                      std::vector<double>& values) {
  std::map<std::int32_t, double> offsets;
  for (std::size_t row = 0; row < plan.points.size(); ++row) {
    const std::int32_t line = plan.points[row].line;
    if (!offsets.contains(line)) {
      RandomStream random = stream("line " + std::to_string(line), plan, channel, seed);
      offsets[line] = plan.noise.line * random.normal();
    }
    values[row] += offsets[line];
  }
}

std::vector<std::int8_t> outliers(const SetupPlan& plan, std::size_t channel, std::uint64_t seed) {
  RandomStream random = stream("outliers", plan, channel, seed);
  std::vector<std::int8_t> signs;
  for (std::size_t row = 0; row < plan.points.size(); ++row) {
    const bool wrong = random.uniform() < plan.noise.outlier_share;
    const double sign = random.sign();
    signs.push_back(static_cast<std::int8_t>(wrong ? sign : 0.0));
  }
  return signs;
}

}  // namespace

std::size_t channels_of(const SetupPlan& plan) {
  return simulated_instrument(plan).channels(plan.column_set);
}

CorrelatedNoise::CorrelatedNoise(const SetupPlan& plan, std::uint64_t seed) {
  const std::size_t channels = channels_of(plan);
  const std::size_t lengths = simulated_instrument(plan).channels_before_encoders(plan.column_set);
  if (plan.noise.drift > 0.0 || plan.noise.line > 0.0) {
    for (std::size_t channel = 0; channel < lengths; ++channel) {
      slow_.push_back(drift(plan, channel, seed));
      if (plan.noise.line > 0.0) add_line_offsets(plan, channel, seed, slow_.back());
    }
  }
  if (plan.noise.outlier_share <= 0.0) return;
  for (std::size_t channel = 0; channel < channels; ++channel) {
    outlier_.push_back(outliers(plan, channel, seed));
  }
}

double CorrelatedNoise::slow(std::size_t row, std::size_t channel) const {
  return channel < slow_.size() ? slow_[channel][row] : 0.0;
}

int CorrelatedNoise::outlier(std::size_t row, std::size_t channel) const {
  return channel < outlier_.size() ? outlier_[channel][row] : 0;
}

}  // namespace volcal::sim
