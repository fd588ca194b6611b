#pragma once
/// Tails of the chi-squared distribution, far out in logarithms, what a test of given level detects, and the
/// tail where the noise itself is estimated.

namespace volcal {

/// Probability that a chi-squared variable with `dof` degrees of freedom exceeds `chi2`.
double chi_squared_exceedance(double chi2, double dof);
/// Its decimal logarithm, also where the probability itself is below the smallest number.
double log10_chi_squared_exceedance(double chi2, double dof);
/// Probability that `chi2` is exceeded where it was divided by a variance known with `freedom` degrees of
/// freedom: chi2 / dof follows an F distribution (Abramowitz and Stegun 26.6.2). 0 below the smallest number.
double exceedance_of_estimated(double chi2, double dof, double freedom);
/// Its decimal logarithm; below the smallest number by the leading term of the incomplete beta function
/// (Abramowitz and Stegun 26.5.4), within some tenths.
double log10_exceedance_of_estimated(double chi2, double dof, double freedom);
/// chi2 that is exceeded with probability 10^log10_probability.
double chi_squared_quantile(double log10_probability, double dof);
/// Noncentrality at which a chi-squared test with `dof` degrees of freedom and the level 10^log10_level
/// detects with probability `power`.
double detectable_noncentrality(double log10_level, double dof, double power);

}  // namespace volcal
