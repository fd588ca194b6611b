#pragma once
/// What a Monte Carlo study gives distributions of: every value of the error tables, every other parameter
/// (effects, tool offsets, expansions, stations, dead paths), the largest value of every surface, volumetric
/// errors on a grid over the travel for every tool, and of each tool the root mean square and the largest
/// error of the volume as budgets judge it, which are not linear.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/volume/volume_size.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

enum class QuantityKind { TableValue, Parameter, VolumetricError, VolumetricRms, VolumetricMax };
std::string_view to_string(QuantityKind kind);

struct Quantity {
  QuantityKind kind = QuantityKind::TableValue;
  std::string name;                ///< "EXX", "station P1 x", "curve EYX by x at x = 310", "ex", "max"
  std::optional<AxisName> axis;    ///< of a table value with a position
  double position = 0.0;           ///< m or rad
  int direction = 0;               ///< as in the tables
  std::string tool;                ///< of a volumetric error; without a name the spindle reference
  std::optional<AxisPosition> at;  ///< of a volumetric error
  std::string unit;                ///< edge unit: "um", "urad", "mm", "ppm" ...
  double si_per_unit = 1.0;
  double estimate = 0.0;  ///< SI, of the fit

  bool is_of_volume() const {
    return kind == QuantityKind::VolumetricError || kind == QuantityKind::VolumetricRms ||
           kind == QuantityKind::VolumetricMax;
  }
  /// "tool long", "spindle reference": of a volumetric error.
  std::string functional_point() const;
  /// "EXX at 400 mm +", "station P1 x", "ex of tool long at 500, 300, 0 mm": for messages.
  std::string words() const;
};

/// Quantities that are exactly known (a function at home) are left out.
struct QuantitySet {
  std::vector<Quantity> items;
  /// Derivatives to the parameters, quantities x layout.size; of rms and max about the estimate.
  Eigen::MatrixXd rows;
  /// The volume of one tool.
  struct Volume {
    std::string tool;  ///< without a name the spindle reference (Machine::functional_tools)
    VolumeSize size;
    std::size_t rms = 0;  ///< index of the quantity
    std::size_t largest = 0;
  };
  std::vector<Volume> volumes;
};

/// `grid_per_axis`: points of the grid per linear axis; 0 leaves the volume out. At these conditions, the
/// default ones where none are given.
QuantitySet quantities_of(const FitResult& result, int grid_per_axis,
                          const std::optional<Conditions>& conditions = {});

}  // namespace volcal
