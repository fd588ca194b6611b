#pragma once
/// Rotary axes counted: simulated five-axis machines, read by an R-test over a grid of two rotary axes with
/// three spheres and three tools, identified, and judged at fresh poses of all axes after the datums of a
/// set-up. Campaign i has structure i mod 4 and seed `seed` + i.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace volcal::studies {

struct FiveAxisStudyOptions {
  int campaigns = 8;
  std::uint64_t seed = 1;
  int turns = 24;      ///< positions of C
  int tilts = 13;      ///< of the other rotary axis
  std::string output;  ///< folder of finished campaigns; empty = none is kept
  bool resume = false;
  int threads = 0;  ///< 0 = all; results do not depend on it
  std::function<void(int done, int all)> progress;
};

/// Lengths in m: RMS of the displacement vector at fresh poses after datums.
struct FiveAxisCampaign {
  std::string structure;
  std::uint64_t seed = 0;
  double before = 0.0;  ///< without residual errors of the linear axes
  double after = 0.0;
  double coverage = 0.0;       ///< share of the displacements' components in their 95 % interval
  double chi2 = 0.0;           ///< of the readings by degree of freedom, noise as stated
  double before_beside = 0.0;  ///< with linear axes whose 1 um and 2 urad nobody models
  double after_beside = 0.0;
  double coverage_beside = 0.0;
  double locations_only = 0.0;  ///< the same readings, without error motions in the model
  /// Location errors from one sphere, one tool, one axis after the other, as a probing cycle takes them.
  double one_sphere_singly = 0.0;
};

/// In the order of the campaigns. Repeatable to the bit. Throws InputError for a folder that holds campaigns
/// of other options, or any without `resume`.
std::vector<FiveAxisCampaign> five_axis_study(const FiveAxisStudyOptions& options);

}  // namespace volcal::studies
