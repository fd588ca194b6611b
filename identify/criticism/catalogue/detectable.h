#pragma once
/// The smallest amplitudes that a campaign would have shown: one line per effect of the catalogue.

#include <string>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"

namespace volcal {

struct DetectableEffect {
  EffectName name;
  std::string label;
  std::string shape_text;  ///< where the shape was scanned: that of the best fit
  std::string unit;        ///< edge
  double si_per_unit = 1.0;
  double visible_fraction = 0.0;
  bool visible = false;
  double mdb = 0.0;  ///< SI, the largest of its amplitudes; found with 80 % power at the family-wise level
  /// Root mean square displacement of the functional point over the measured positions, m, by an effect of
  /// this size; NaN for what acts on the instrument and not on the machine.
  double volumetric = 0.0;
};

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
