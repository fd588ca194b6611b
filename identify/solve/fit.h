#pragma once
/// Identification of a machine's geometric errors from a campaign: the whole job.
///
///   1. nuisance parameters on the nominal machine (stations may be guessed wrong by decimetres),
///   2. rank analysis: what the readings cannot tell is named before anything is inverted,
///   3. all parameters together; smoothing and variance components by evidence; the exact transforms'
///      second-order remainder added,
///   4. the noise by restricted maximum likelihood about that; where it is more than white (correlated drift,
///   offsets
///      of lines, a part in proportion to length) generalised least squares (correlated_adjustment.h),
///   5. residuals, redundancy, Baarda's w-test, covariance.

#include <functional>
#include <string>

#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/normals/minimise.h"

namespace volcal {

enum class OutlierPolicy { List, Remove };
/// White: independent readings; also with a robust loss or kept stated sigma, and where an error is not
/// visible and the search for the noise does not end.
enum class NoisePolicy { Automatic, White };

struct FitOptions {
  int threads = 0;  ///< 0 = as many as the machine has
  SolverKind solver = SolverKind::Compressed;
  RobustLoss loss = RobustLoss::None;
  OutlierPolicy outliers = OutlierPolicy::List;
  double outlier_family_risk = 0.05;  ///< chance that any good reading of the campaign is flagged
  bool variance_components = true;    ///< correct a wrong stated sigma, per instrument
  NoisePolicy noise = NoisePolicy::Automatic;
  bool exact_kinematics = true;  ///< second-order remainder of the exact transforms
  int max_iterations = 100;
  /// Called as stages begin, with a share of the work done, 0..1.
  std::function<void(const std::string& stage, double done)> progress;
};

/// Errors of tools' offsets that the model knows are held, those of tools whose offset the machine file calls
/// uncertain estimated. Throws InputError for a campaign that cannot be used.
FitResult fit(const Campaign& campaign, const ModelSpec& spec, const FitOptions& options = {});

}  // namespace volcal
