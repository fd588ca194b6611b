#pragma once
/// Three ways to the same standard uncertainties: linear propagation, Monte Carlo draws (montecarlo.h), and
/// the scatter of campaigns simulated by exact transforms on one machine in one way, each with noise of its
/// own and fitted for itself. The machine's error functions lie outside the fitted basis; the basis has fixed
/// knots and no smoothing prior, so that the noise of the readings is all that scatters.

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "volcal/model/description/machine_error.h"

namespace volcal::studies {

struct AgreementOptions {
  int campaigns = 10000;
  std::uint64_t draws = 10000;
  std::uint64_t seed = 1;            ///< of the machine and the first campaign's noise, the others follow
  std::array<int, 3> grid{9, 7, 6};  ///< positions of a run per axis; 9 x 7 x 6 gives 6,048 readings
  int structure = 0;                 ///< of sim::reference_machines()
  int threads = 0;                   ///< 0 = all; results do not depend on it
  std::function<void(int done, int all)> progress;
};

/// Of one table value, SI.
struct AgreedValue {
  MachineError symbol;
  double u_linear = 0.0;      ///< as the fits state it, root mean square over the campaigns
  double u_montecarlo = 0.0;  ///< of the first campaign's draws, times u_linear over that campaign's own
  double u_scatter = 0.0;     ///< standard deviation of the fitted values over the campaigns
};

/// Values that are exactly known are left out. Repeatable to the bit.
std::vector<AgreedValue> agreement(const AgreementOptions& options);

}  // namespace volcal::studies
