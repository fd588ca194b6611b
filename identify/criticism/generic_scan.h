#pragma once
/// Two scans that need no catalogue: does anything recorded move the residuals, in whatever way?
///   polynomials  along X, Y, Z or the beam, or as a rotation of an axis with its arms, in every recorded
///                variable and pair of variables
///   kernel       the same with a sum of cosines whose weights fall with frequency, as a variance component:
///                sees bumps, waves and kinks (score test of a variance component, Lin 1997, Biometrika 84;
///                its tail is that of a weighted sum of chi-squared variables)
/// What moves the machine along X, Y or Z, or turns one of its axes, is looked for in what the machine knows:
/// positions, directions of approach, time, temperatures, tool, feed; a station that moves, in time and
/// temperatures; what changes the reading of a beam, in all that is not the machine's: length, elevation,
/// station, time, temperatures.

#include <string>
#include <vector>

#include "volcal/identify/criticism/linear_model.h"
#include "volcal/identify/criticism/projector.h"

namespace volcal {

/// A recorded variable over all observations, scaled to -1..1.
struct ScanVariable {
  std::string name;  ///< "x", "time", "T_air", "dir_x", "length", "tool side", "station P1"
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

inline constexpr const char* kScanDirections[] = {"X", "Y", "Z", "beam"};

struct GenericTest {
  std::vector<std::string> variables;  ///< one or two
  std::string direction;               ///< of kScanDirections; of a rotation, where it shows most
  std::string rotation;                ///< "EBX" if looked for with the arms of this error motion, else empty
  bool kernel = false;
  double log10_p = 0.0;  ///< for this test alone
  double lm = 0.0;
  double dof = 0.0;
  double gain = 0.0;  ///< LM - dof ln n (polynomials)
  double rms = 0.0;   ///< SI: root mean square over the readings of what it would explain
};

/// All tests, polynomials and kernels; the same for any number of threads.
std::vector<GenericTest> generic_scan(const LinearModel& model, const std::vector<ScanVariable>& variables,
                                      const Projector& projector, int threads);

}  // namespace volcal
