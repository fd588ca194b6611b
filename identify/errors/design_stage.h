#pragma once
/// A machine at the design stage: errors that tolerances bound, as a result whose expectation is no error, so
/// that an error budget can be had of it before anything is built (ISO/TR 16907:2015, 9.2.4 g; Slocum 1992).
///
/// A tolerance is the width T of a band (ISO 230-1). A value is anywhere in it with the same probability:
/// standard uncertainty u = T / (2 sqrt 3) (GUM, 4.3.7). A straight line that fills the band has this root
/// mean square about the middle of the band. Over the travel L of a linear axis, t = (q - middle) / L, an
/// error motion is
///     E = u [ a_0 s_0 sqrt(12) t + sum_k s_k sqrt(2) (a_k sin 2 pi k t + b_k cos 2 pi k t) ],  k = 1, 2,
/// less its value at home, with uncorrelated a, b of variance 1: a slope and waves of one and two periods, of
/// variance shares s_0^2 = 1/2, s_1^2 = 1/6, s_2^2 = 1/12 (1/2, 1/3, 1/6 of the whole). Straightness has no
/// slope, which is squareness: its sines are taken less their least-squares slope, and the waves have 2/3 and
/// 1/3 of the variance.

#include "volcal/identify/result/result.h"
#include "volcal/model/description/tolerances.h"

namespace volcal {

/// Functions and squareness of the tolerances with expectation 0 and their covariance; expansions of scales
/// with the stated uncertainty of their coefficients. What has no tolerance is free of error.
FitResult result_of_tolerances(const Machine& machine, const Tolerances& tolerances);

/// Standard uncertainty of a value that lies anywhere in a band of this width.
double band_uncertainty(double width);

}  // namespace volcal
