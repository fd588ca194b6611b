#pragma once
/// Errors of readings as the noise model (identify/noise/noise_model.h) has them:
/// independent parts, correlated drift that forgets itself with exp(-|dt| / tau) (exact recursion of the
/// Ornstein-Uhlenbeck process from time to time), offsets that the readings of a line share. It is the model
/// read forwards; the Whitener reads it backwards, and shares no code with it.

#include <cstdint>
#include <span>
#include <vector>

#include "volcal/identify/noise/noise_model.h"

namespace volcal {

class NoiseSampler {
 public:
  /// `parameters`: per group of the data.
  NoiseSampler(const NoiseData& data, std::span<const NoiseParameters> parameters);

  std::size_t observations() const { return independent_.size(); }
  /// Errors of one draw, m or rad, per observation; 0 for those that are left out.
  void draw(std::uint64_t seed, std::uint64_t number, std::span<double> errors) const;

 private:
  struct Walk {
    std::vector<std::size_t> observation;  ///< in time
    std::vector<double> decay;             ///< since the step before
    std::vector<double> fresh;             ///< standard deviation of what is new
  };
  struct LineMember {
    std::size_t observation;
    std::size_t line;  ///< number among all lines
  };

  void add_drift(const NoiseData& data, const NoiseSequence& sequence, const NoiseParameters& own);
  void add_lines(const NoiseData& data, const NoiseSequence& sequence, const NoiseParameters& own);

  std::vector<double> independent_;  ///< standard deviation per observation
  std::vector<Walk> walks_;
  std::vector<LineMember> members_;
  std::vector<double> line_sigma_;
};

}  // namespace volcal
