#pragma once
/// What the order of an instrument's readings says of its noise before any model of it is fitted.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "volcal/identify/noise/noise_model.h"

namespace volcal {

inline constexpr std::size_t kLeastObservations = 30;  ///< fewer: white noise alone

/// s; 0 where no sequence has readings at different times.
struct TimeScale {
  double usual_gap = 0.0;  ///< median between successive readings
  double longest = 0.0;    ///< from the first to the last reading of a sequence
};

TimeScale time_scale(const NoiseData& data);

/// Lines of several readings in sequences of several lines.
bool has_lines(const NoiseData& data);

/// Half the mean squared difference of successive readings, or of successive visits of a point, m^2 or rad^2.
/// `point`: number of the point at which an observation was taken, negative where it has none; may be empty.
double half_squared_difference(const NoiseData& data, const std::vector<std::int64_t>& point,
                               const Eigen::VectorXd& residual);

}  // namespace volcal
