#pragma once
/// Tails of the chi-squared distribution, far out in logarithms, and what a test of given level detects.

namespace volcal {

/// Probability that a chi-squared variable with `dof` degrees of freedom exceeds `chi2`.
double chi_squared_exceedance(double chi2, double dof);
/// Its decimal logarithm, also where the probability itself is below the smallest number.
double log10_chi_squared_exceedance(double chi2, double dof);
/// chi2 that is exceeded with probability 10^log10_probability.
double chi_squared_quantile(double log10_probability, double dof);
/// Noncentrality at which a chi-squared test with `dof` degrees of freedom and the level 10^log10_level
/// detects with probability `power`.
double detectable_noncentrality(double log10_level, double dof, double power);

}  // namespace volcal
