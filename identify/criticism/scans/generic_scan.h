#pragma once
/// Scans that need no catalogue: does anything recorded move the residuals, in whatever way?
///   polynomials  along X, Y, Z or the beam, or as a rotation of an axis with its arms, in every recorded
///                variable and pair of variables
///   kernel       the same with a sum of cosines whose weights fall with frequency, as a variance component:
///                sees bumps, waves and kinks (score test of a variance component, Lin 1997, Biometrika 84;
///                its tail is that of a weighted sum of chi-squared variables)
///   waves        along X, Y or Z in the position of an axis, finer than the kernel's (wave_scan.h)
/// What moves the machine along X, Y or Z, or turns one of its axes, is looked for in what the machine knows:
/// positions, directions of approach, motion, time, temperatures, tool, feed; a station that moves, in time
/// and temperatures; what changes the reading of a beam, in all that is not the machine's: length, elevation,
/// instrument, station, time, temperatures.

#include <optional>
#include <vector>

#include "volcal/identify/criticism/data/scan_direction.h"
#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/identify/criticism/scans/scan_variables.h"

namespace volcal {

struct GenericTest {
  std::vector<Variable> variables;         ///< one or two
  std::optional<ScanDirection> direction;  ///< of a rotation, where it shows most; set in every finished test
  std::optional<ErrorSymbol> rotation;     ///< if looked for with the arms of this error motion
  bool kernel = false;
  double log10_p = 0.0;  ///< for this test alone
  double lm = 0.0;
  double dof = 0.0;
  double gain = 0.0;           ///< LM - dof ln n (polynomials)
  double rms = 0.0;            ///< SI: root mean square over the readings of what it would explain
  double period = 0.0;         ///< m, of a wave; 0: none
  double log10_choices = 0.0;  ///< what the choice of the period adds to log10 p
};

/// SI: root mean square over the readings of what lowers the sum of weighted squares by `lm`, without what
/// the model can imitate; of readings with the root mean square of all standard deviations.
double explained_rms(double lm, const LinearModel& model, const Projector& projector);

/// What tests of a scan would explain, one a column: displacements of all observations, m or rad; of a kernel
/// up to a factor, in the proportions of its score. `chosen`: indices of `tests`, what generic_scan() has
/// returned, waves after them.
Eigen::MatrixXd scanned_displacements(const LinearModel& model, const std::vector<ScanVariable>& variables,
                                      const Projector& projector, const std::vector<GenericTest>& tests,
                                      const std::vector<std::size_t>& chosen);

/// The best wave of every axis and direction; the same for any number of threads.
std::vector<GenericTest> wave_tests(const LinearModel& model, const Projector& projector, int threads);

/// All polynomials and kernels; the same for any number of threads.
std::vector<GenericTest> generic_scan(const LinearModel& model, const std::vector<ScanVariable>& variables,
                                      const Projector& projector, int threads);

}  // namespace volcal
