#pragma once
/// What is sealed away from who identifies: the hidden effects with their amplitudes, and which readings are
/// wrong altogether. m, rad.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/sim/hidden/hidden_effects.h"

namespace volcal::sim {

struct HiddenAnswer {
  HiddenEffect effect;
  double amplitude = 0.0;  ///< SI unit of amplitude_unit(effect)
  /// Root mean square of its own effect on the noise-free readings, m; an angle counts with an arm of 1 m.
  double rms = 0.0;
  /// The same after each component's mean in each setup is taken away.
  double rms_within_setups = 0.0;
};

struct GrossError {
  std::string setup;
  std::size_t row = 0;  ///< from 0
  std::size_t channel = 0;
  int sign = 1;
};

/// Reads the setups of a campaign without noise.
class Readout {
 public:
  virtual ~Readout() = default;
  virtual Campaign noise_free(const TruthMachine& truth, const Interference& interference) const = 0;
};

/// Fixes the amplitudes: those given, and for a given rms the one that has it, the effect being alone
/// (relative 1e-6). Throws InputError for an effect that cannot be and for an rms that it cannot have.
std::vector<HiddenAnswer> resolve_hidden(const std::vector<HiddenEffect>& effects,
                                         const HiddenContext& context, const TruthMachine& truth,
                                         const Readout& readout);

/// Appends the outliers of a planned setup.
void append_gross_errors(const SetupPlan& plan, std::uint64_t seed, std::vector<GrossError>& errors);

}  // namespace volcal::sim
