#pragma once
/// State of the last adjustment of a fit, for what criticises it; not written to files.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/solve/priors/smoothing.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

struct Adjustment {
  ModelSpec model;          ///< with breakpoints, as it was before the fit
  Eigen::VectorXd reduced;  ///< parameters in the coordinates of the datum (datum.h)
  GaussianPrior prior;      ///< of `reduced`: stated priors, wide ones; without smoothing
  std::vector<SmoothingTerm> smoothing;
  std::vector<double> stated_sigma;  ///< per observation, SI
};

}  // namespace volcal
