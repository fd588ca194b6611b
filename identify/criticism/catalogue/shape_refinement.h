#pragma once
/// A shape that was looked for on a grid (period, time constant, time), between the grid's values.

#include <optional>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"

namespace volcal {

/// Moves the shape of a test to the largest LM between its neighbours of the scan (golden section), and the
/// test with it. Shapes that are known, several parameters, and scans whose neighbours have nothing to do
/// with each other (a list of usual values) stay as they are.
void refine_shape(const LinearModel& model, const Family& family, const Projector& projector,
                  FamilyTest& test);

/// The same of several tests, in the families of their numbers: step by step together, since a projection
/// takes as long for one column as for kColumnBlock. The same for any number of threads.
void refine_shapes(const LinearModel& model, const std::vector<Family>& families, const Projector& projector,
                   int threads, const std::vector<FamilyTest*>& tests);

enum class ScanEnd { Lowest, Highest };
/// The end of what was looked for at which a shape stands; none within the scan, or without one.
std::optional<ScanEnd> end_of_scan(const Family& family, double shape);

/// Change of the readings per change of the shape's parameter (SI), at the estimated amplitudes: with it as a
/// further column, the shape's uncertainty counts. None where the readings do not depend on it smoothly.
std::optional<Eigen::VectorXd> shape_derivative(const LinearModel& model, const Family& family,
                                                const Eigen::VectorXd& shape,
                                                const Eigen::VectorXd& amplitude);

}  // namespace volcal
