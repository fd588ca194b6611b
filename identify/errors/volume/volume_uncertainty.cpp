#include "volcal/identify/errors/volume/volume_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volcal/identify/errors/volume/faded_in_volume.h"
#include "volcal/identify/errors/volume/volume_moments.h"
#include "volcal/identify/errors/volume/volume_points.h"

namespace volcal {

double volume_uncertainty(const FitResult& result, const Tool& tool, const Conditions& conditions,
                          std::span<const AxisPosition> positions,
                          std::span<const ApproachDirection> directions) {
  if (positions.size() != directions.size())
    throw std::invalid_argument("as many positions as directions are needed");
  const bool is_uncertain = !result.covariance.isZero(0.0);
  const ErrorField field(result, tool, conditions);
  VolumeMoments moments(is_uncertain ? result.layout.size : 0);
  FadedInVolume faded;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Eigen::Vector3d place = place_of(result.machine, positions[i]);
    if (is_uncertain) moments.add(place, field.unheld_rows(positions[i], directions[i]).topRows<3>());
    faded.add(place, field.faded_errors(positions[i], directions[i]));
  }
  const double known = is_uncertain ? moments.mean().cwiseProduct(result.covariance).sum() : 0.0;
  return std::sqrt(std::max(0.0, known + faded.mean_square()));
}

}  // namespace volcal
