#pragma once
/// Stated standard deviations of a campaign's readings: noise of the instruments and repeatability of the
/// machine (measurement_model.h), m or rad, per observation.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/solve/normals/normal_equations.h"

namespace volcal {

/// Throws InputError for a setup whose readings have none.
std::vector<double> stated_sigma(const ReadingIndex& index, const Eigen::VectorXd& parameters);

/// Anew those that depend on where a station stands, once it is known better than by its guess: the machine's
/// repeatability moves a tracker's angle by its share of the distance. False when there are none.
bool renew_sigma_of_angles(const ReadingIndex& index, const Eigen::VectorXd& parameters,
                           std::vector<double>& sigma);

/// Anew those in proportion to a length from a station that stands elsewhere than it was guessed to. False,
/// and `sigma` stays as it is, where that would change none by more than 1 %.
bool renew_sigma_of_lengths(const ReadingIndex& index, const Eigen::VectorXd& parameters,
                            std::vector<double>& sigma);

}  // namespace volcal
