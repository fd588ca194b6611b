#pragma once
/// The volumetric error of a machine as a function: what compensations are computed from and judged by.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/solve/result.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

/// Direction of approach of every axis, by AxisName: -1, +1, 0 = mean of both.
using ApproachDirection = std::array<std::int8_t, kAxisCount>;
inline constexpr ApproachDirection kTowardsPlus = {1, 1, 1, 1, 1, 1};

/// Error vector (ex, ey, ez) of the functional point at a commanded position, actual minus nominal, workpiece
/// coordinates, m.
using ErrorField = std::function<Eigen::Vector3d(const AxisPosition&, const ApproachDirection&)>;

/// Errors that a result holds: functions, squareness, and reversals (+b/2 towards +, -b/2 towards -).
class IdentifiedErrors {
 public:
  struct Reversal {
    ErrorSymbol symbol;
    double amplitude = 0.0;  ///< value towards + minus value towards -, m or rad
  };

  explicit IdentifiedErrors(const FitResult& result);

  PoseErrors<double> at(const AxisPosition& position, const ApproachDirection& direction) const;
  const std::vector<Reversal>& reversals() const { return reversals_; }

 private:
  ParameterLayout layout_;
  Eigen::VectorXd parameters_;
  std::vector<Reversal> reversals_;
};

/// The same position with every rotary axis at 0.
AxisPosition without_rotary_axes(const AxisPosition& position);

/// First order (chain.h), linear axes only: rotary axes contribute neither errors nor motion. From
/// polynomials between knots where the functions are such (linear_axis_errors.h), otherwise the plain field.
ErrorField identified_error_field(const FitResult& result, const Eigen::Vector3d& tool_offset);
/// The same along the chain, joint by joint, at every call.
ErrorField plain_error_field(const FitResult& result, const Eigen::Vector3d& tool_offset);

/// Names of identified effects that tables cannot hold: everything beyond error motions, squareness and
/// reversal.
std::vector<std::string> effects_not_in_tables(const FitResult& result);

}  // namespace volcal
