#pragma once
/// The ideal compensation of a type: the correction added to the commanded position of every linear axis so
/// that the errors which the type stands for vanish. A compensation is minus the error (ISO/TR 16907:2015,
/// 3.14 and 9.2.4 d), evaluated at the programmed position: with errors below 0.1 mm and slopes below 1e-4
/// the error at the corrected position differs by less than 10 nm.
///
/// With D_i(q_i, s_i) the error along the specific line of axis i, zero at home approached towards +, and
/// s_ki the least-squares slope over the travel of its component k (mean of both directions):
///   L-POS  sum of the components of D_i along i
///   L-STR  components of D_i across i, less s_ki (q_i - home_i)
///   L-SQU  (s_ki + s_ik) (q_i - home_i) of component k, k before i in the order primary, secondary, third
///   L-ANG  e(q, s) - e(home, +) - sum of D_i
///   L-VOL  e(q, s) - e(home, +)
/// Where a machine is no rigid body, D_i is the mean over the other axes (rigid_compromise.h): of what
/// depends on other axes too, a table of one axis holds that best. L-POS + L-STR + L-SQU + L-ANG and L-VOL
/// differ by a small rotation of the machine frame alone. All are zero at home approached towards + (layout
/// of Table 1). Components along axes that the machine lacks are left out.

#include "volcal/identify/compensation/compensation_type.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/volume/volume_points.h"

namespace volcal {

class Compensation {
 public:
  /// Error along the specific line of an axis at a position and direction of approach, m.
  using LineField = std::function<Eigen::Vector3d(AxisName axis, double q, int direction)>;
  /// `lines`: the point that all specific lines go through. `along`: errors that stand for those on the
  /// lines.
  /// `to_home`: approached so, all are zero at home; without a direction their mean is, as tables that stand
  /// for both directions must be.
  Compensation(const Machine& machine, const AxisPosition& lines, CompensationType type,
               DisplacementField errors, LineField along = {},
               const ApproachDirection& to_home = kTowardsPlus);

  CompensationType type() const { return type_; }
  /// Added to the commands of X, Y, Z; m.
  Eigen::Vector3d correction(const AxisPosition& position, const ApproachDirection& direction) const;
  /// The error that the type is about, m, with the components along which no axis moves.
  Eigen::Vector3d error_of_type(const AxisPosition& position, const ApproachDirection& direction) const;
  /// The share of the correction that depends on one axis alone: all of L-POS, L-STR and L-SQU. direction -1,
  /// 0, +1.
  Eigen::Vector3d along_axis(AxisName axis, double q, int direction) const;
  /// Angle between axes i and k on their specific lines beyond 90 degrees, s_ki + s_ik, rad.
  double squareness(AxisName i, AxisName k) const;

 private:
  struct Line {
    AxisName axis = AxisName::X;
    double home = 0.0;
    Eigen::Vector3d at_home = Eigen::Vector3d::Zero();  ///< error at home approached towards +
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();
    Eigen::Vector3d squareness = Eigen::Vector3d::Zero();  ///< what L-SQU takes of the slope
  };

  Eigen::Vector3d on_line(const Line& line, double q, int direction) const;
  Eigen::Vector3d mean_slope(const Line& line, const Axis& axis) const;
  void set_squareness(const Machine& machine);
  const Line* find_line(AxisName axis) const;
  Eigen::Vector3d error_along(const Line& line, double q, int direction) const;

  CompensationType type_;
  DisplacementField errors_;
  LineField along_;
  AxisPosition lines_;
  std::vector<Line> axes_;
  Eigen::Vector3d movable_;
  Eigen::Vector3d at_home_ = Eigen::Vector3d::Zero();
};

}  // namespace volcal
