#pragma once
/// What an effect of the smallest amplitude that a campaign would have shown does to the machine.

#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"

namespace volcal {

/// Displacements of the functional point by a unit of everything an effect can act on.
class FunctionalPointLevers {
 public:
  explicit FunctionalPointLevers(const LinearModel& model);
  /// Root mean square over the readings, m per SI unit of the effect's amplitude `k`; NaN for effects on
  /// stations and readings. `shape`: values of the shape's parameters.
  double rms(const Effect& effect, const Eigen::VectorXd& shape, std::size_t k) const;

 private:
  const LinearModel& model_;
  /// Per setup: rows x disturbances of the machine (motions of the joints, tool offset), lengths in m per
  /// unit.
  std::vector<Eigen::MatrixXd> length_;
};

}  // namespace volcal
