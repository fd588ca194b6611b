#pragma once
/// Correlation between whole error functions.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/result/result.h"

namespace volcal::report {

struct ErrorCorrelation {
  std::vector<MachineError> errors;
  /// Symmetric, 0..1. For functions f, g sampled along their axes, with covariance blocks S:
  /// sqrt(tr(S_fg S_gf) / sqrt(tr(S_ff^2) tr(S_gg^2))), the square root of the RV coefficient (Robert and
  /// Escoufier 1976); for two scalars it is |correlation|.
  Eigen::MatrixXd value;
};

/// Functions and location errors of a result; those without variance correlate with nothing.
ErrorCorrelation error_correlation(const FitResult& result);

}  // namespace volcal::report
