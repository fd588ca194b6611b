#pragma once
/// A scan without a catalogue for what repeats along a linear axis too finely for polynomials and kernels: a
/// screw, a scale, a rack, whatever the period and the direction in which it moves the tool.
///
/// Sine and cosine of an axis' position along X, Y or Z, whatever their period from a fifth of the measured
/// range down to kFinestWave. For w = Sigma^-1 (y - J x) the score of a wave is g~^T r~ = g^T w, which is a
/// sum over uneven positions for every frequency at once (periodogram, Scargle 1982, Astrophys. J. 263, 835):
/// positions are put into bins of half of kFinestWave and transformed. The best are then projected and
/// tested as every other candidate is, so that what the bins lose loses no test its level. The choice among
/// all frequencies costs
///
///   p = W sqrt(z) exp(-z),  z = LM / 2,  W = (f_max - f_min) sqrt(4 pi var(q))
///
/// (Baluev 2008, Mon. Not. R. Astron. Soc. 385, 1279, eq. 6; q the axis' positions).
///
/// Where something else is missing from the model, readings of a position err together, and thousands of
/// fine waves fit them by chance as well as a true one would. LM is therefore that of the projected wave in
/// units of the mean over all frequencies, where this is larger than the noise puts there: a wave stands out
/// of what it does not explain.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/criticism/projection/projector.h"

namespace volcal {

inline constexpr double kFinestWave = 20e-6;  ///< m
inline constexpr double kWavesOfKernels = 5;  ///< over the measured range: coarser ones are the kernels'

/// The best wave of an axis along a direction.
struct WaveTest {
  AxisName axis = AxisName::X;
  ScanDirection direction = ScanDirection::X;  ///< of the workpiece
  double period = 0.0;                         ///< m
  double lm = 0.0;             ///< against the mean of all periods, if that is above the noise
  double projected_lm = 0.0;   ///< against the noise
  int dof = 0;                 ///< 0: no wave of this axis is visible
  double log10_p = 0.0;        ///< with the choice among periods, for this test alone
  double log10_choices = 0.0;  ///< its part in log10_p
};

/// One test per direction and linear axis that moves by more than kWavesOfKernels of the finest waves; the
/// same for any number of threads.
std::vector<WaveTest> wave_scan(const LinearModel& model, const Projector& projector, int threads);

/// Cosine and sine along a direction, all observations.
Eigen::MatrixXd wave_columns(const LinearModel& model, AxisName axis, ScanDirection direction, double period);

}  // namespace volcal
