#include "volcal/identify/errors/volume/faded_in_volume.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "volcal/identify/errors/volume/volumetric.h"

namespace volcal {
namespace {

constexpr double kSameSize = 1e-9;

}  // namespace

void FadedInVolume::add(const Eigen::Vector3d& place, std::span<const FadedError> errors) {
  ++points_;
  for (const FadedError& error : errors) {
    Surface& surface = surfaces_[error.parameter];
    const double size = std::abs(error.size);
    surface.least = surface.errors.empty() ? size : std::min(surface.least, size);
    surface.most = std::max(surface.most, size);
    surface.places.push_back(place);
    surface.errors.emplace_back(error.u.head<3>());
  }
}

double FadedInVolume::mean_square() const {
  double sum = 0.0;
  for (const auto& [parameter, surface] : surfaces_) sum += mean_square_of(surface);
  return sum;
}

double FadedInVolume::mean_square(std::span<const int> parameters) const {
  const std::vector<double> squares = mean_squares(parameters);
  return std::accumulate(squares.begin(), squares.end(), 0.0);
}

std::vector<double> FadedInVolume::mean_squares(std::span<const int> parameters) const {
  std::vector<double> squares;
  for (const auto& [parameter, surface] : surfaces_) {
    if (std::ranges::find(parameters, parameter) != parameters.end())
      squares.push_back(mean_square_of(surface));
  }
  return squares;
}

double FadedInVolume::mean_square_of(const Surface& surface) const {
  const bool same =
      surface.errors.size() == points_ && surface.most - surface.least <= kSameSize * surface.most;
  double sum = 0.0;
  for (const Eigen::Vector3d& error :
       same ? without_rigid_motion(surface.places, surface.errors) : surface.errors)
    sum += error.squaredNorm();
  return sum / static_cast<double>(points_);
}

}  // namespace volcal
