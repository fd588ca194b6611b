#include "volcal/identify/statistics/normal.h"

#include <Eigen/Core>
#include <unsupported/Eigen/SpecialFunctions>

namespace volcal {

double normal_quantile(double probability) { return Eigen::numext::ndtri(probability); }

}  // namespace volcal
