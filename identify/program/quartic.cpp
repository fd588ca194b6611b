#include "volcal/identify/program/quartic.h"

namespace volcal {

std::array<double, 5> quartic_weights(double share) {
  std::array<double, 5> weights{};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] = 1.0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if (k != i) weights[i] *= (share - kQuarticNodes[k]) / (kQuarticNodes[i] - kQuarticNodes[k]);
    }
  }
  return weights;
}

}  // namespace volcal
