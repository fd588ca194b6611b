#pragma once
/// The error of an identified machine at a pose: tool relative to workpiece, actual minus nominal (ISO/TR
/// 16907:2015, 3.14), with direction of approach, tool and stated conditions. First order (chain.h), a sum of
/// contributions: error functions, locations, expansions of scales, effects, the tool's offset. What tables,
/// compensations, plans, Monte Carlo and reports say of the volume follows from it.
///
/// Beyond the positions that were measured an error function, and what an effect makes of a position, keep
/// their last measured value. A curve or surface without a name fades out beyond the values of its variables,
/// temperatures and times among them, that it was drawn from.
///
///   const ErrorField field(result, tool, conditions);
///   field.at(position, direction);           // ex ey ez (m), ea eb ec (rad), workpiece coordinates
///   field.rows(position, direction);         // their derivatives to result.parameters

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/machine_effects.h"
#include "volcal/identify/errors/pose.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/measured_ends.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

using PoseErrorVector = Eigen::Matrix<double, 6, 1>;             ///< ex ey ez, m; ea eb ec, rad
using PoseErrorRows = Eigen::Matrix<double, 6, Eigen::Dynamic>;  ///< one column per parameter

/// Range of positions with readings, by AxisName; an axis without functions has no ends.
struct MeasuredTravel {
  std::array<MeasuredEnds, kAxisCount> ends;

  MeasuredTravel() = default;  ///< without ends
  explicit MeasuredTravel(const FitResult& result);
  const MeasuredEnds& operator[](AxisName axis) const { return ends[index_of(axis)]; }
  /// The nearest position that was measured; of an axis that goes round, on the circle.
  AxisPosition held(const AxisPosition& position) const;
  /// Beyond the measured positions of an axis by more than a micrometre or a microradian.
  bool is_beyond(const AxisPosition& position) const;
};

/// Expansion of the scale of an axis.
struct ExpansionError {
  AxisName axis = AxisName::X;
};
/// What the offset of the tool is in error by.
struct ToolOffsetError {};

/// What a summand of the error comes from.
using ErrorSource = std::variant<ErrorSymbol, LocationSymbol, ExpansionError, EffectName, ToolOffsetError>;

/// One summand of the error.
struct Contribution {
  ErrorSource source;
  std::string name;                  ///< "EAY", "EC0Y", "expansion X", "reversal EXX", "tool long"
  std::vector<Variable> depends_on;  ///< empty = a constant
  std::vector<int> parameters;       ///< that it is linear in
};

/// Standard uncertainty that a curve or surface leaves where it has faded out.
struct FadedError {
  int parameter = 0;  ///< the first of its coefficients, in the result's parameters
  double size = 0.0;  ///< of its target, m or rad
  PoseErrorVector u = PoseErrorVector::Zero();
};

class ErrorField {
 public:
  ErrorField(const FitResult& result, const Tool& tool, const Conditions& conditions);
  /// At the result's default conditions.
  ErrorField(const FitResult& result, const Tool& tool)
      : ErrorField(result, tool, default_conditions(result)) {}

  /// By tool and direction at a commanded position. Rotary errors are in it as far as they were identified.
  PoseErrorVector at(const AxisPosition& position, const ApproachDirection& direction = {}) const;
  /// What it is made of: the errors of every axis at that pose, functions held, expansions and effects on
  /// error motions included. The tool's offset is left out: tool_displacement().
  PoseErrors<double> joint_errors(const AxisPosition& position,
                                  const ApproachDirection& direction = {}) const;
  /// Displacement of the tool's offset by effects, tool coordinates, m; without what an offset that was
  /// estimated is in error by.
  Eigen::Vector3d tool_displacement(const AxisPosition& position,
                                    const ApproachDirection& direction = {}) const;
  /// Derivatives to the parameters; errors are linear in all of them but those of an effect's shape.
  PoseErrorRows rows(const AxisPosition& position, const ApproachDirection& direction = {}) const;
  /// The same with error functions as they are beyond the measured positions and with curves and surfaces
  /// that have not faded out: what the uncertainty of a value there follows from.
  PoseErrorRows unheld_rows(const AxisPosition& position, const ApproachDirection& direction = {}) const;
  /// What curves and surfaces have lost that fade out beyond the readings they were drawn from: derivatives
  /// of the error with their last value held, less rows(). Absent where none is beyond.
  std::optional<PoseErrorRows> faded_rows(const AxisPosition& position,
                                          const ApproachDirection& direction = {}) const;
  /// Every curve and surface that has faded out there, as large as it may still be.
  std::vector<FadedError> faded_errors(const AxisPosition& position,
                                       const ApproachDirection& direction = {}) const;
  /// The sum of their squares: variances that what has faded out may still have.
  PoseErrorVector faded_variance(const AxisPosition& position, const ApproachDirection& direction = {}) const;
  /// Beyond the measured positions of an axis, or the readings of a curve or surface, at that pose and the
  /// stated conditions.
  bool is_beyond_readings(const AxisPosition& position, const ApproachDirection& direction = {}) const;
  /// Of one contribution at a pose.
  PoseErrorVector contribution(const Contribution& part, const AxisPosition& position,
                               const ApproachDirection& direction = {}) const;
  std::vector<Contribution> contributions() const;

  /// Parameters of expansions and effects, and the part of rows() that belongs to them.
  const std::vector<int>& condition_parameters() const { return condition_parameters_; }
  PoseErrorRows condition_rows(const AxisPosition& position, const ApproachDirection& direction) const {
    return condition_rows({&position, 1}, direction);
  }
  /// The same at many positions, side by side.
  PoseErrorRows condition_rows(std::span<const AxisPosition> positions,
                               const ApproachDirection& direction) const;
  /// Share of the error by expansions and effects, of the condition_rows() there.
  PoseErrorVector condition_value(const AxisPosition& position,
                                  const Eigen::Ref<const PoseErrorRows>& rows) const;
  /// Whether there are expansions or effects.
  bool depends_on_conditions() const { return !effects_.empty() || !expansions_.empty(); }
  /// Share of the error that is no parameter's: known expansions of all scales, or of one axis.
  PoseErrorVector known_expansion(const AxisPosition& position, std::optional<AxisName> only = {}) const;
  const MachineEffects& effects() const { return effects_; }
  const MeasuredTravel& measured() const { return measured_; }
  /// Standard variance of the tool's offset where it is stated and was not estimated, m^2 per component.
  double stated_tool_variance() const { return stated_tool_variance_; }

 private:
  /// Displacement along an axis by the expansion of its scale.
  struct Expansion {
    AxisName axis = AxisName::X;
    std::string channel;  ///< of its temperature
    double strain = 0.0;  ///< known, m/m at the stated temperature
    double excess = 0.0;  ///< temperature less 20 degC, K
    double home = 0.0;    ///< from which it counts, m
    int parameter = -1;   ///< deviation of the coefficient, 1/K
  };

  PoseErrors<double> errors_at(const AxisPosition& position, const ApproachDirection& direction,
                               Eigen::Vector3d& offset_t) const;
  Eigen::Index place_of(int parameter) const;
  PoseErrorRows rows_at(const AxisPosition& position, const AxisPosition& functions_at,
                        const ApproachDirection& direction) const;
  void add_expansion_rows(const JointLever* levers, const AxisPosition& position,
                          Eigen::Ref<PoseErrorRows> rows) const;
  /// `drivers`: of every column of the effects at that position.
  void add_effect_rows(const JointLever* levers, const AxisPosition& position,
                       const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& drivers,
                       Eigen::Ref<PoseErrorRows> rows) const;

  KinematicChain chain_;
  Tool tool_;
  ParameterLayout layout_;
  Eigen::VectorXd parameters_;
  MeasuredTravel measured_;
  MachineEffects effects_;
  std::vector<Expansion> expansions_;
  std::vector<int> condition_parameters_;
  std::vector<Eigen::Index> places_of_columns_;  ///< in condition_parameters_, of the effects' columns
  int tool_parameter_ = -1;
  double stated_tool_variance_ = 0.0;
};

/// Whether an effect acts on error motions of one linear axis and its driver sees no position or direction of
/// another: it is part of that axis' error functions.
bool is_of_own_axis(const MachineEffects& effects, std::size_t effect);

/// Displacements by the linear axes and the effects, rotary axes at 0 and without errors of theirs: what
/// tables of linear axes correct.
class LinearDisplacements {
 public:
  LinearDisplacements(const FitResult& result, const Tool& tool, const Conditions& conditions);

  Eigen::Vector3d at(const AxisPosition& position, const ApproachDirection& direction) const;
  /// What depends on one axis at a time: functions, squareness, expansions, and effects of one axis.
  Eigen::Vector3d rigid(const AxisPosition& position, const ApproachDirection& direction) const;
  /// What effects add that make the error motion of one axis depend on another, or move the tool.
  Eigen::Vector3d coupled(const AxisPosition& position, const ApproachDirection& direction) const;
  bool has_coupled() const;
  const MachineEffects& coupled_effects() const;
  /// Displacements per unit of every amplitude of the coupled effects, one matrix per position, m per unit.
  std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> coupled_units(
      std::span<const AxisPosition> positions, std::span<const ApproachDirection> directions) const;
  /// Whether it is a sum of terms of two axes each (plane_tables.h).
  bool is_of_two_axes() const;
  const MeasuredTravel& measured() const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

/// LinearDisplacements as a function.
DisplacementField displacement_field(const FitResult& result, const Tool& tool, const Conditions& conditions);

}  // namespace volcal
