#pragma once
/// Where a function of one to three variables is drawn.

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "volcal/model/functions/tensor_basis.h"

namespace volcal {

struct DrawnPlaces {
  std::vector<std::vector<double>> axes;  ///< equally spaced places of the first one or two variables
  double third = std::numeric_limits<double>::quiet_NaN();  ///< value of a third one
  Eigen::MatrixXd rows;  ///< basis functions there, places of the last axis next to each other
};

/// Over the whole range; a third variable at `third`, or in the middle of its range.
DrawnPlaces drawn_places(const TensorBasis& basis, std::optional<double> third = {});

}  // namespace volcal
