#pragma once
/// Chi-squared distribution.

namespace volcal {

/// Probability that a chi-squared variable with `dof` > 0 degrees of freedom (not necessarily whole) exceeds
/// `chi2`; relative accuracy 1e-9 down to 1e-300.
double chi_squared_exceedance(double chi2, double dof);

}  // namespace volcal
