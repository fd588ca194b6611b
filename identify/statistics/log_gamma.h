#pragma once
/// The logarithm of the gamma function for threads: std::lgamma writes a sign that all of them share.

#include <cmath>

namespace volcal {

/// ln |Gamma(x)|, to the last bit of std::lgamma.
inline double log_gamma(double x) {
#if defined(__GLIBC__)
  int sign = 0;
  return ::lgamma_r(x, &sign);
#else
  return std::lgamma(x);
#endif
}

}  // namespace volcal
