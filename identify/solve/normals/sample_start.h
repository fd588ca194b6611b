#pragma once
/// A start near the minimum for campaigns of very many readings. From stations that are guessed millimetres
/// off, the first steps are as good on a sample of the readings as on all of them, and cost a fraction.

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "volcal/identify/solve/normals/datum.h"
#include "volcal/identify/solve/normals/minimise.h"
#include "volcal/identify/solve/normals/normal_equations.h"

namespace volcal {

struct SampleStart {
  Eigen::VectorXd z;         ///< where the sample's cost is least, nearly
  double cost_before = 0.0;  ///< of all readings where the sample's steps began, as the sample tells
};

/// Gauss-Newton steps of least squares from `z`: long ones on a small sample of blocks of readings, the last
/// one on a larger sample. None where the start is near already, a sample does not determine every parameter,
/// or its cost does not fall.
std::optional<SampleStart> find_start_on_sample(const ReadingIndex& index, const std::vector<double>& weight,
                                                const DatumSpace& datum, const GaussianPrior& prior,
                                                int threads, const Eigen::VectorXd& z);

}  // namespace volcal
