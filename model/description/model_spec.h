#pragma once
/// What we assume of a machine: bases of the error functions, effects beyond the rigid body, known values.
/// Plain data as a model file holds it; SI units.

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volcal/model/description/recorded_conditions.h"
#include "volcal/model/description/schema.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

enum class KnotChoice { Automatic, IntervalCount, Explicit };

/// Choice of basis for one error motion.
struct FunctionSpec {
  std::string basis = "bspline";  ///< a registered basis: bspline, legendre, fourier, zero
  int degree = 3;                 ///< bspline 1..3; legendre: highest degree; fourier: highest harmonic
  bool automatic_degree = false;  ///< fourier: `degree` follows from the readings, and smoothing decides
  KnotChoice knots = KnotChoice::Automatic;
  int intervals = 0;                 ///< for IntervalCount
  std::vector<double> breakpoints;   ///< for Explicit: m or rad, ascending, ends included
  std::vector<double> coefficients;  ///< an identified function: m or rad, one per basis function; else empty
  /// Identified with knots or harmonics that were chosen from the readings and smoothed: where it is
  /// identified anew, they are chosen anew.
  bool smoothed = false;
};

/// How large errors may be before any reading is seen, standard deviations. They hold what the readings do
/// not determine, and what is visible is known ten times better. Absent = the program's
/// (identify/solve/rank.h).
struct PriorWidths {
  std::optional<double> displacement;  ///< of an error motion over the travel, m
  std::optional<double> rotation;      ///< the same, rad
  std::optional<double> squareness;    ///< and other location angles, rad
};

struct EffectSpec {
  std::string kind;
  int source_line = 0;
  Options options;  ///< keys of the effect's schema, SI
};

struct ModelSpec {
  std::string file;
  FunctionSpec default_function;
  std::map<ErrorSymbol, FunctionSpec> functions;  ///< where the user departs from the default
  std::map<LocationSymbol, double> locations;     ///< known values, rad or m (an identified model)
  std::vector<LocationSymbol> locations_off;      ///< left out of the model: held at zero
  /// What tools' offsets are known to be wrong by, actual minus stated, m (an identified model). A tool whose
  /// offset the machine file calls uncertain is estimated anew by a fit; that of any other tool is held.
  std::map<std::string, Eigen::Vector3d> tool_errors;
  /// Coefficients of expansion of scales, 1/K, in place of those of the machine file (an identified model),
  /// which has the temperature. One that the machine file calls uncertain is estimated anew by a fit.
  std::map<AxisName, double> expansions;
  std::vector<EffectSpec> effects;
  PriorWidths priors;
  /// Positions with readings that stated errors follow from, m or rad, first and last: beyond them errors
  /// keep their last value (measured_ends.h). An axis without is known over its whole travel.
  std::map<AxisName, std::pair<double, double>> measured;
  /// Under which stated errors were measured; what is not recorded is not known.
  RecordedConditions conditions;

  const FunctionSpec& function(ErrorSymbol symbol) const {
    const auto found = functions.find(symbol);
    return found == functions.end() ? default_function : found->second;
  }
};

}  // namespace volcal
