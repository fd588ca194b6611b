#pragma once
/// Steps of the noise filter (noise_model.h) and of its adjoint for many columns side by side, in loops that
/// the compiler turns into vector instructions. `width`: columns; arrays do not overlap.

#include <Eigen/Core>

namespace volcal {

/// Factors of one step, the same for every column.
struct FilterStep {
  double decay;        ///< of the correlated drift since the step before
  double scale;        ///< 1 / sqrt(F)
  double drift_gain;   ///< of the correlated drift's state
  double offset_gain;  ///< of the state that holds the offset of the step's line
};

/// values := innovation / sqrt(F); states move on.
void filter_row(const FilterStep& step, Eigen::Index width, double* values, double* drift);
void filter_row(const FilterStep& step, Eigen::Index width, double* values, double* drift, double* offset);
/// The same backwards: values := L^-T values; `drift` and `offset` hold the adjoint states.
void filter_row_adjoint(const FilterStep& step, Eigen::Index width, double* values, double* drift);
void filter_row_adjoint(const FilterStep& step, Eigen::Index width, double* values, double* drift,
                        double* offset);
/// values *= factor
void scale_row(double factor, Eigen::Index width, double* values);
/// to += factor * from
void add_row(double factor, Eigen::Index width, const double* from, double* to);

}  // namespace volcal
