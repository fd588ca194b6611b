#pragma once
/// What is recorded with the readings: the variables that scans without a catalogue go through, and what an
/// effect's amplitude is asked whether it varies with.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/model/description/variable.h"

namespace volcal {

/// A recorded variable over all observations, scaled to -1..1.
struct ScanVariable {
  Variable variable;
  Eigen::VectorXd value;
  bool two_valued = false;  ///< powers say nothing new
  double centre = 0.0;      ///< what was recorded = centre + scale value, SI
  double scale = 1.0;

  std::string name() const { return variable.name(); }
};
std::vector<ScanVariable> scan_variables(const LinearModel& model);
/// `value` over all observations, as recorded; nothing is added where it is constant.
void add_scan_variable(std::vector<ScanVariable>& variables, const Variable& variable, Eigen::VectorXd value);

/// Recorded variables that an effect depends on: those of its driver, the tool or station of its target. None
/// where nothing recorded stands for it.
std::vector<Variable> scan_variables_of(const EffectName& name);

/// v, v^2, v^3; of a two-valued variable v alone.
Eigen::MatrixXd scan_powers(const ScanVariable& variable);
/// cos(k pi (v + 1) / 2) / k, k = 1 ... count: a Brownian-like prior, rough enough for kinks. Of a two-valued
/// variable v alone.
Eigen::MatrixXd scan_waves(const ScanVariable& variable, int count);

}  // namespace volcal
