#include "volcal/model/functions/drawn_places.h"

namespace volcal {
namespace {

constexpr int kPlacesOfCurve = 121, kPlacesOfSurface = 41;

std::vector<double> spread(const TensorBasis::Side& side, int count) {
  std::vector<double> places;
  for (int i = 0; i < count; ++i) places.push_back(side.from + (side.to - side.from) * i / (count - 1.0));
  return places;
}

}  // namespace

DrawnPlaces drawn_places(const TensorBasis& basis, std::optional<double> third) {
  const auto& sides = basis.sides();
  DrawnPlaces drawn;
  drawn.axes.push_back(spread(sides[0], sides.size() == 1 ? kPlacesOfCurve : kPlacesOfSurface));
  if (sides.size() > 1) drawn.axes.push_back(spread(sides[1], kPlacesOfSurface));
  if (sides.size() > 2) drawn.third = third.value_or(0.5 * (sides[2].from + sides[2].to));

  std::vector<std::vector<double>> places;
  for (const double first : drawn.axes[0]) {
    if (sides.size() == 1) {
      places.push_back({first});
      continue;
    }
    for (const double second : drawn.axes[1]) {
      places.push_back({first, second});
      if (sides.size() > 2) places.back().push_back(drawn.third);
    }
  }
  drawn.rows.resize(static_cast<Eigen::Index>(places.size()), basis.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    drawn.rows.row(static_cast<Eigen::Index>(i)) = basis.row(places[i]).transpose();
  return drawn;
}

}  // namespace volcal
