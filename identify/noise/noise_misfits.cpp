#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {
namespace {

constexpr std::size_t kLanes = 8;         // noise models that go through the readings side by side
constexpr std::size_t kTileOfSteps = 64;  // whose exponentials are taken at once
constexpr std::size_t kVariancesPerLog = 8;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));  // one number of each

enum ModelRow : std::size_t {
  kWhiteRow,
  kDriftRow,
  kLineRow,
  kPerMetreRow,
  kTauRow,
  kModelRows
};  // all but tau squared
using Models = std::array<double, kModelRows * kLanes>;

/// Of eight noise models from `first` on; where there are fewer, the last fills up.
Models models(std::span<const NoiseParameters> noises, std::size_t first) {
  Models all{};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const NoiseParameters& noise = noises[std::min(first + lane, noises.size() - 1)];
    all[kWhiteRow * kLanes + lane] = noise.white * noise.white;
    all[kDriftRow * kLanes + lane] = noise.drift * noise.drift;
    all[kLineRow * kLanes + lane] = noise.line * noise.line;
    all[kPerMetreRow * kLanes + lane] = noise.per_metre * noise.per_metre;
    all[kTauRow * kLanes + lane] = noise.tau;
  }
  return all;
}

void load(const double* numbers, Lanes& lanes) { std::memcpy(&lanes, numbers, sizeof lanes); }

}  // namespace

bool Whitener::has_open_lines() const {
  return std::ranges::any_of(tracks_, [](const Track& track) { return track.states > 2; });
}

/// The filter of compute_gains() and filter(), its gains and its column together; nothing is kept.
VOLCAL_VECTOR_LOOPS void Whitener::find_misfits(const Track& track, const double* models,
                                                const double* column, double* misfits) {
  const Lanes none{};
  Lanes white, line, per_metre, drift = none;
  load(models + kWhiteRow * kLanes, white);
  load(models + kLineRow * kLanes, line);
  load(models + kPerMetreRow * kLanes, per_metre);
  if (track.timed) load(models + kDriftRow * kLanes, drift);
  const double* const tau = models + kTauRow * kLanes;
  Lanes of_drift{}, across{}, of_line{};  // covariance of the states
  Lanes at_drift{}, at_line{}, squares{}, logarithms{}, product = none + 1.0;
  std::array<Lanes, kTileOfSteps> decays;
  Lanes decay{};
  double gap = -1.0;
  for (std::size_t begin = 0; begin < track.steps.size(); begin += kTileOfSteps) {
    const std::size_t count = std::min(kTileOfSteps, track.steps.size() - begin);
    for (std::size_t k = 0; k < count; ++k) {
      const double now = track.steps[begin + k].gap;
      for (std::size_t lane = 0; lane < kLanes && now != gap; ++lane)
        decay[lane] = lane > 0 && tau[lane] == tau[lane - 1] ? decay[lane - 1] : std::exp(-now / tau[lane]);
      gap = now;
      decays[k] = decay;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const Step& step = track.steps[begin + k];
      const Lanes kept = decays[k];
      of_drift = of_drift * kept * kept + (1.0 - kept * kept) * drift;
      across *= kept;
      if (step.opens) {
        across = none;
        of_line = line;
        at_line = none;
      }
      const Lanes to_drift = of_drift + across, to_line = across + of_line;
      const Lanes variance =
          white * (step.sigma * step.sigma) + per_metre * (step.length * step.length) + to_drift + to_line;
      const Lanes precision = 1.0 / variance, drift_gain = to_drift * precision,
                  line_gain = to_line * precision;
      of_drift -= drift_gain * to_drift;
      across -= drift_gain * to_line;
      of_line -= line_gain * to_line;
      const Lanes predicted = kept * at_drift;
      const Lanes innovation = column[step.observation] - predicted - at_line;
      at_drift = predicted + drift_gain * innovation;
      at_line += line_gain * innovation;
      squares += innovation * innovation * precision;
      product *= variance;
      if ((begin + k + 1) % kVariancesPerLog == 0 || begin + k + 1 == track.steps.size()) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) logarithms[lane] += std::log(product[lane]);
        product = none + 1.0;
      }
    }
  }
  const Lanes sum = logarithms + squares;
  std::memcpy(misfits, &sum, sizeof sum);
}

std::vector<double> Whitener::misfits(std::span<const NoiseParameters> noises, const Eigen::VectorXd& column,
                                      int threads) const {
  if (groups_ > 1 || has_open_lines())
    throw std::invalid_argument("noise model: one group, one line at a time");
  if (noises.empty()) return {};
  const std::size_t batches = (noises.size() + kLanes - 1) / kLanes, tracks = tracks_.size();
  std::vector<std::array<double, kLanes>> found(batches * tracks);
  run_parallel(found.size(), threads, [&](std::size_t item) {
    const Models own = models(noises, item / tracks * kLanes);
    find_misfits(tracks_[item % tracks], own.data(), column.data(), found[item].data());
  });
  std::vector<double> sums(noises.size(), 0.0);
  for (std::size_t k = 0; k < sums.size(); ++k) {
    for (std::size_t track = 0; track < tracks; ++track)
      sums[k] += found[k / kLanes * tracks + track][k % kLanes];
  }
  return sums;
}

}  // namespace volcal
