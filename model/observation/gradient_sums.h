#pragma once
/// Sums of J^T e over readings. What acts on an error function is gathered at the positions where its axis
/// stood, and the basis is applied once a position, not once a reading.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "volcal/model/observation/measurement_model.h"

namespace volcal {

class GradientSums {
 public:
  /// `model` must outlive the object.
  explicit GradientSums(const MeasurementModel& model);

  void set_zero();
  void add(const GradientSums& other);
  /// Adds work[function of the group][i] where reading i < size stands: position[i], an entry of the model's
  /// tables.
  void add_at_positions(std::size_t group, const std::uint32_t* position, int size,
                        const double* const* work);
  /// For parameters besides the functions'.
  void add_to_parameter(int parameter, double value) { others_[parameter] += value; }
  /// In raw parameters.
  Eigen::VectorXd gradient() const;

 private:
  const MeasurementModel* model_;
  std::vector<std::size_t> gathered_begin_;  ///< per group
  std::vector<double> gathered_;             ///< group by group: positions x functions
  Eigen::VectorXd others_;                   ///< parameters besides the functions', at their places
};

}  // namespace volcal
