#include "volcal/identify/noise/filter_rows.h"

#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {

VOLCAL_VECTOR_LOOPS void filter_row(const FilterStep& step, Eigen::Index width, double* __restrict values,
                                    double* __restrict drift) {
  const double decay = step.decay, scale = step.scale, gain = step.drift_gain;
  for (Eigen::Index c = 0; c < width; ++c) {
    const double predicted = decay * drift[c];
    const double innovation = values[c] - predicted;
    drift[c] = predicted + gain * innovation;
    values[c] = scale * innovation;
  }
}

VOLCAL_VECTOR_LOOPS void filter_row(const FilterStep& step, Eigen::Index width, double* __restrict values,
                                    double* __restrict drift, double* __restrict offset) {
  const double decay = step.decay, scale = step.scale, gain = step.drift_gain, own_gain = step.offset_gain;
  for (Eigen::Index c = 0; c < width; ++c) {
    const double predicted = decay * drift[c];
    const double innovation = values[c] - predicted - offset[c];
    drift[c] = predicted + gain * innovation;
    offset[c] += own_gain * innovation;
    values[c] = scale * innovation;
  }
}

VOLCAL_VECTOR_LOOPS void filter_row_adjoint(const FilterStep& step, Eigen::Index width,
                                            double* __restrict values, double* __restrict drift) {
  const double decay = step.decay, scale = step.scale, gain = step.drift_gain;
  for (Eigen::Index c = 0; c < width; ++c) {
    const double value = scale * values[c] + gain * drift[c];
    drift[c] = decay * (drift[c] - value);
    values[c] = value;
  }
}

VOLCAL_VECTOR_LOOPS void filter_row_adjoint(const FilterStep& step, Eigen::Index width,
                                            double* __restrict values, double* __restrict drift,
                                            double* __restrict offset) {
  const double decay = step.decay, scale = step.scale, gain = step.drift_gain, own_gain = step.offset_gain;
  for (Eigen::Index c = 0; c < width; ++c) {
    const double value = scale * values[c] + gain * drift[c] + own_gain * offset[c];
    drift[c] = decay * (drift[c] - value);
    offset[c] -= value;
    values[c] = value;
  }
}

VOLCAL_VECTOR_LOOPS void scale_row(double factor, Eigen::Index width, double* values) {
  for (Eigen::Index c = 0; c < width; ++c) values[c] *= factor;
}

VOLCAL_VECTOR_LOOPS void add_row(double factor, Eigen::Index width, const double* __restrict from,
                                 double* __restrict to) {
  for (Eigen::Index c = 0; c < width; ++c) to[c] += factor * from[c];
}

}  // namespace volcal
