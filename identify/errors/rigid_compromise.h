#pragma once
/// The rigid-body model nearest to effects that no rigid body has: what one-dimensional error and
/// compensation tables can hold of an error motion that depends on another axis (ISO/TR 16907:2015, 7.4.2
/// and 9.3.1).
///
/// Over the travel of the linear axes, uniformly weighted, the displacement f of a tool's functional point is
/// approximated by least squares by what the errors of single axes can do,
///   f ~ mean f + sum_i D_i(q_i) + sum_{i < k} (q_k - m_k) E_i(q_i) x u_k,
/// i nearer the workpiece than k, u the directions of the axes, m the middles of their travel. The summands
/// are orthogonal: D_i is the mean over the other axes less the mean of all; E_i, of mean zero, follows from
/// the moments of f with q_k - m_k. As error motions: rotation E_i, displacement D_i less what E_i makes of
/// the arm at the middle of the other axes. Means by Gauss' rule, exact for polynomials up to degree 23.
///
/// Without the mean of f, zero at home as every error is (mean of both directions of approach): what E_i is
/// at home is, of the error motions, a slope of the displacements of the axes behind.
///
/// With s_ki the least-squares slope over the travel of component k of axis i's displacement, s_ki + s_ik is
/// the squareness of i and k, as in compensation.h. The error motions are stated without it: the slope s_ki
/// of the earlier axis of the datum stays, and its opposite of the later one, which together are a rotation
/// of the machine frame. Motions and squareness move the functional point as before, but for a constant where
/// an axis is not at 0 at home.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "volcal/identify/errors/error_field.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

class RigidCompromise {
 public:
  /// Of the effects of a result that couple axes or move the tool.
  RigidCompromise(const FitResult& result, const Tool& tool, const Conditions& conditions);

  bool empty() const;
  /// Parameters of the effects' amplitudes.
  std::vector<int> parameters() const;
  /// Error motions EX EY EZ (m) EA EB EC (rad) of a linear axis without squareness(), per unit of every
  /// amplitude: 6 x parameters.
  PoseErrorRows motions(AxisName axis, double q, int direction) const;
  /// Of squareness_errors(), rad per unit of every amplitude; zeros for other location errors.
  Eigen::RowVectorXd squareness(LocationSymbol symbol) const;
  /// D_i of the result less its value at home, m.
  Eigen::Vector3d along(AxisName axis, double q, int direction) const;
  /// All of it at a position, zero at home, m.
  Eigen::Vector3d at(const AxisPosition& position, const ApproachDirection& direction) const;

 private:
  class Sums;
  std::shared_ptr<Sums> sums_;
};

}  // namespace volcal
