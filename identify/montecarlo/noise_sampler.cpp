#include "volcal/identify/montecarlo/noise_sampler.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "volcal/identify/montecarlo/counter_random.h"

namespace volcal {

NoiseSampler::NoiseSampler(const NoiseData& data, std::span<const NoiseParameters> parameters)
    : independent_(data.sigma.size(), 0.0) {
  for (const NoiseSequence& sequence : data.sequences) {
    const NoiseParameters& own = parameters[sequence.group];
    for (const std::size_t i : sequence.observation) {
      if (!std::isfinite(data.sigma[i])) continue;
      const double length = data.length.empty() ? 0.0 : data.length[i];
      independent_[i] = std::hypot(own.white * data.sigma[i], own.per_metre * length);
    }
    if (own.drift > 0.0 && !sequence.time.empty()) add_drift(data, sequence, own);
    if (own.line > 0.0 && !sequence.line.empty()) add_lines(data, sequence, own);
  }
}

void NoiseSampler::add_drift(const NoiseData& data, const NoiseSequence& sequence,
                             const NoiseParameters& own) {
  std::vector<std::size_t> order(sequence.observation.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return sequence.time[k]; });
  Walk walk;
  double before = 0.0;
  for (const std::size_t k : order) {
    if (!std::isfinite(data.sigma[sequence.observation[k]])) continue;
    const double decay = walk.observation.empty() ? 0.0 : std::exp(-(sequence.time[k] - before) / own.tau);
    before = sequence.time[k];
    walk.observation.push_back(sequence.observation[k]);
    walk.decay.push_back(decay);
    walk.fresh.push_back(own.drift * std::sqrt(1.0 - decay * decay));
  }
  walks_.push_back(std::move(walk));
}

void NoiseSampler::add_lines(const NoiseData& data, const NoiseSequence& sequence,
                             const NoiseParameters& own) {
  std::map<std::int32_t, std::size_t> number_of;
  for (std::size_t k = 0; k < sequence.observation.size(); ++k) {
    if (!std::isfinite(data.sigma[sequence.observation[k]])) continue;
    const auto [found, is_new] = number_of.try_emplace(sequence.line[k], line_sigma_.size());
    if (is_new) line_sigma_.push_back(own.line);
    members_.push_back({sequence.observation[k], found->second});
  }
}

void NoiseSampler::draw(std::uint64_t seed, std::uint64_t number, std::span<double> errors) const {
  CounterRandom(seed, number, RandomSource::Readings).normals(errors);
  for (std::size_t i = 0; i < errors.size(); ++i) errors[i] *= independent_[i];
  if (!walks_.empty()) {
    std::size_t steps = 0;
    for (const Walk& walk : walks_) steps += walk.observation.size();
    std::vector<double> normal(steps);
    CounterRandom(seed, number, RandomSource::Drift).normals(normal);
    const double* next = normal.data();
    for (const Walk& walk : walks_) {
      double state = 0.0;
      for (std::size_t k = 0; k < walk.observation.size(); ++k) {
        state = walk.decay[k] * state + walk.fresh[k] * *next++;
        errors[walk.observation[k]] += state;
      }
    }
  }
  if (members_.empty()) return;
  std::vector<double> offset(line_sigma_.size());
  CounterRandom(seed, number, RandomSource::Lines).normals(offset);
  for (const LineMember& member : members_)
    errors[member.observation] += line_sigma_[member.line] * offset[member.line];
}

}  // namespace volcal
