#include "volcal/sim/hidden/hidden_answer.h"

#include <algorithm>
#include <cmath>

#include "volcal/model/description/units.h"
#include "volcal/sim/measurement/instruments.h"
#include "volcal/sim/measurement/noise.h"

namespace volcal::sim {
namespace {

struct Size {
  double rms = 0.0;
  double within_setups = 0.0;
};

/// Root mean square of b - a over all readings.
Size difference(const Campaign& a, const Campaign& b) {
  double square = 0.0;
  double square_within = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < a.setups.size(); ++i) {
    const auto& all_before = a.setups[i].readings.value;
    const auto& all_after = b.setups[i].readings.value;
    for (std::size_t channel = 0; channel < all_before.size(); ++channel) {
      const auto& before = all_before[channel];
      const auto& after = all_after[channel];
      const auto rows = static_cast<double>(before.size());
      double sum = 0.0;
      double sum_of_squares = 0.0;
      for (std::size_t row = 0; row < before.size(); ++row) {
        const double change = after[row] - before[row];
        sum += change;
        sum_of_squares += change * change;
      }
      square += sum_of_squares;
      square_within += std::max(0.0, sum_of_squares - sum * sum / rows);
      count += rows;
    }
  }
  return {std::sqrt(square / count), std::sqrt(square_within / count)};
}

class Resolver {
 public:
  Resolver(const HiddenContext& context, const TruthMachine& truth, const Readout& readout)
      : context_(context), truth_(truth), readout_(readout), without_(readout.noise_free(truth, {})) {}

  HiddenAnswer resolve(const HiddenEffect& effect) const {
    if (effect.amplitude.has_value() == effect.rms.has_value()) {
      fail(effect, "amplitude and rms are both stated or both missing", "state one of them");
    }
    const double amplitude = effect.amplitude ? *effect.amplitude : amplitude_of_rms(effect);
    const Size size = size_of(effect, amplitude);
    return {effect, amplitude, size.rms, size.within_setups};
  }

 private:
  Size size_of(const HiddenEffect& effect, double amplitude) const {
    TruthMachine machine = truth_;
    Interference interference;
    HiddenScene scene{machine, interference};
    add_hidden(effect, amplitude, context_, scene);
    return difference(without_, readout_.noise_free(machine, interference));
  }

  /// Secant steps on a logarithmic scale: one step for an effect that is linear in its amplitude or a power.
  double amplitude_of_rms(const HiddenEffect& effect) const {
    constexpr int kMostSteps = 30;
    constexpr double kClose = 1e-6;
    constexpr double kNothing = 1e-14;  // m
    const double target = *effect.rms;
    if (!(target > 0.0)) fail(effect, "rms is not positive", "give a number above 0");
    double amplitude = unit_of_key("amplitude_" + amplitude_unit(effect)).si_per_unit;
    double rms = size_of(effect, amplitude).rms;
    if (rms < kNothing) {
      fail(effect, "it has no effect on these readings", "state an amplitude, or measure where it acts");
    }
    double power = 1.0;
    for (int step = 0; step < kMostSteps; ++step) {
      if (std::abs(rms / target - 1.0) < kClose) return amplitude;
      const double next = amplitude * std::pow(target / rms, 1.0 / power);
      const double next_rms = size_of(effect, next).rms;
      if (next_rms < kNothing || !std::isfinite(next_rms)) break;
      const double slope = std::log(next_rms / rms) / std::log(next / amplitude);
      if (std::isfinite(slope) && slope > 0.1) power = slope;
      amplitude = next;
      rms = next_rms;
    }
    fail(effect, "no amplitude gives this rms in the readings", "state another rms_um, or an amplitude");
  }

  [[noreturn]] static void fail(const HiddenEffect& effect, const std::string& problem,
                                const std::string& remedy) {
    throw InputError(effect.place, "hidden effect " + effect.kind + ": " + problem, remedy);
  }

  const HiddenContext& context_;
  const TruthMachine& truth_;
  const Readout& readout_;
  Campaign without_;
};

}  // namespace

std::vector<HiddenAnswer> resolve_hidden(const std::vector<HiddenEffect>& effects,
                                         const HiddenContext& context, const TruthMachine& truth,
                                         const Readout& readout) {
  std::vector<HiddenAnswer> answers;
  if (effects.empty()) return answers;
  const Resolver resolver(context, truth, readout);
  for (const HiddenEffect& effect : effects) answers.push_back(resolver.resolve(effect));
  return answers;
}

void append_gross_errors(const SetupPlan& plan, std::uint64_t seed, std::vector<GrossError>& errors) {
  if (plan.noise.outlier_share <= 0.0) return;
  const CorrelatedNoise noise(plan, seed);
  for (std::size_t row = 0; row < plan.points.size(); ++row) {
    for (std::size_t channel = 0; channel < channels_of(plan); ++channel) {
      const int sign = noise.outlier(row, channel);
      if (sign != 0) errors.push_back({plan.name, row, channel, sign});
    }
  }
}

}  // namespace volcal::sim
