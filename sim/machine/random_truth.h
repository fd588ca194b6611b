#pragma once
/// Random truth machines whose error functions lie outside every fitted basis: a Legendre series of degree 1
/// or 2 to 7 with decaying amplitudes plus two sines of incommensurate period; of a rotary axis harmonics 1
/// to 9 with decaying amplitudes, or two sines where it turns less than once. m and rad.

#include <cstdint>

#include "volcal/sim/machine/truth_machine.h"

namespace volcal::sim {

struct RandomTruthOptions {
  /// The volumetric error, sqrt(mean |e|^2) over the volume after rigid alignment with the first tool, is
  /// drawn from this range and all functions and squareness scaled to it.
  double volumetric_rms_min = 15.5e-6;
  double volumetric_rms_max = 21.5e-6;
  /// Relative size of angular errors, squareness and sines before that scaling.
  double angular_scale = 1.0;
  double squareness_scale = 1.0;
  double wave_scale = 1.0;
  /// Reversal of positioning drawn from 0 to this (m), of angles from 0 to this (rad).
  double reversal_max = 0.0;
  double angular_reversal_max = 0.0;
};

/// Functions are zero at home. The straightness slopes that would rotate the machine frame are zero, the
/// other three are not: squareness in the datum differs from location(). The same seed and machine give the
/// same truth, whatever else is simulated.
TruthMachine random_truth(const Machine& machine, std::uint64_t seed, const RandomTruthOptions& options = {});

/// sqrt(mean |e|^2) after rigid alignment over 8 x 8 x 8 equal cells of the travel (their middles), rotary
/// axes at home.
double volumetric_rms(const TruthMachine& truth, const Eigen::Vector3d& tool_offset);

}  // namespace volcal::sim
