#pragma once
/// What is recorded with the readings: the variables that scans without a catalogue go through, and what an
/// effect's amplitude is asked whether it varies with.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/criticism/projection/linear_model.h"

namespace volcal {

/// A recorded variable over all observations, scaled to -1..1.
struct ScanVariable {
  std::string name;  ///< "x", "time", "T_air", "dir_x", "speed_x", "length", "tool side", "station P1"
  Eigen::VectorXd value;
  bool two_valued = false;  ///< powers say nothing new
  double centre = 0.0;      ///< what was recorded = centre + scale value, SI
  double scale = 1.0;
};
std::vector<ScanVariable> scan_variables(const LinearModel& model);
/// `value` over all observations, as recorded; nothing is added where it is constant.
void add_scan_variable(std::vector<ScanVariable>& variables, const std::string& name, Eigen::VectorXd value);

/// Names of the recorded variables that an effect depends on: "T_column", "dir_x", "time" and "z" of its
/// driver, "tool side_x" of either, "station P1" of its target. Empty where nothing recorded stands for it.
std::vector<std::string> scan_variables_of(const EffectName& name);

/// v, v^2, v^3; of a two-valued variable v alone.
Eigen::MatrixXd scan_powers(const ScanVariable& variable);
/// cos(k pi (v + 1) / 2) / k, k = 1 ... count: a Brownian-like prior, rough enough for kinks. Of a two-valued
/// variable v alone.
Eigen::MatrixXd scan_waves(const ScanVariable& variable, int count);

}  // namespace volcal
