#pragma once
/// How well the readings know the noise that a test stands on.
///
/// A test divides |m|^2 = m^T Sigma^-1 m, what a displacement m of the readings would be seen with, by a
/// noise that was estimated from the same readings. White noise is known from thousands of them; correlated
/// drift, from as many as there are correlation times, and an effect as slow as the correlated drift stands
/// on it alone. With the logarithms of the noise parameters uncertain by W, the information |m|^2 (projected
/// off the model) has the relative variance r^T W r, r its logarithmic derivatives, and the test has
///
///   nu = 2 / (r^T W r)
///
/// degrees of freedom (Satterthwaite 1946, Biometrics Bull. 2, 110; for restricted likelihood: Kenward and
/// Roger 1997, Biometrics 53, 983): LM / dof follows F(dof, nu), in place of chi-squared / dof.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/identify/noise/noise_estimate.h"

namespace volcal {

/// nu of displacements of all observations, m or rad, one a column; infinite where noise is white, which has
/// as many as there are readings. `projector` stands at `estimate`, which has covariances of its logarithms;
/// `projector_of` makes the same one at another noise, and is called once for every noise parameter.
std::vector<double> noise_freedom(
    const Eigen::MatrixXd& moved, const Projector& projector, const NoiseEstimate& estimate,
    const std::function<std::unique_ptr<Projector>(const std::vector<NoiseParameters>& noise)>& projector_of);

}  // namespace volcal
