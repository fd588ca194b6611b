#pragma once
/// Tables of an identified machine: error functions with uncertainty at every position, squareness,
/// volumetric errors at any point and tool. ISO 841/230-1 signs, error = actual - nominal (ISO/TR
/// 16907, 3.14; tables 9.2 and 9.3).

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_field.h"
#include "volcal/model/description/machine_error.h"

namespace volcal {

/// One row of error_tables.csv, SI inside.
struct ErrorTableRow {
  MachineError symbol;           ///< an error motion or a location error
  std::optional<AxisName> axis;  ///< empty for squareness
  double position = 0.0;         ///< m or rad
  int direction = 0;             ///< 0 mean of both; +1, -1 with reversal
  double value = 0.0;            ///< m or rad; beyond the readings the last measured one
  double u = 0.0;                ///< standard uncertainty; beyond the readings that of the function there
  double U95 = 0.0;              ///< expanded uncertainty, 95 %
  bool rotation = false;         ///< value in rad
  bool extrapolated = false;     ///< outside the measured positions
};

struct ErrorTableOptions {
  /// Per axis, ends included; 0 = steps of 1/2/5 x 10^n giving 21 to 51 rows, up to 501 where functions have
  /// short pieces.
  int positions = 0;
  double step = 0.0;  ///< of linear axes from home, m, with the ends of the travel; 0 = as `positions` says
  double rotary_step = 0.0;  ///< of rotary axes, rad, with the ends of the travel; 0 = as `positions` says
  bool zero_plus = false;    ///< shift so that the + direction is zero at home (ISO/TR 16907, Table 1)
  std::optional<Conditions> conditions = {};  ///< default_conditions() when absent
  std::string tool = {};  ///< for which effects that couple axes are shared out; the first when empty
};

/// Of ErrorTableOptions::positions that a user states; 0 is allowed too.
inline constexpr int kFewestTableRows = 2, kMostTableRows = 100000;
/// Throws InputError beyond that range.
void check_table_rows(int positions);

/// "errors.held-beyond-readings" of every axis that was measured over a part of its travel.
std::vector<Finding> unmeasured_travel(const FitResult& result);
/// What was identified and is in no table of linear axes: effects that act on no pose, and the errors of
/// these rotary axes (identified_rotary_axes()).
std::vector<Finding> errors_in_no_table(const FitResult& result, std::span<const AxisName> rotary);
/// "effect.in-no-figure" of effects that act on no pose: no error at a point or in the volume holds them.
std::vector<Finding> effects_in_no_figure(const FitResult& result);

std::vector<ErrorTableRow> error_table(const FitResult& result, const ErrorTableOptions& options = {});
/// Derivatives of the same rows to the parameters: rows x layout.size.
Eigen::MatrixXd error_table_derivatives(const FitResult& result, const ErrorTableOptions& options = {});

/// Volumetric error of one tool at one commanded position with standard uncertainties; m and rad.
struct VolumetricError {
  AxisPosition position{};
  std::string tool;
  Eigen::Matrix<double, 6, 1> value;  ///< ex ey ez ea eb ec
  Eigen::Matrix<double, 6, 1> u;
  bool extrapolated = false;
};

/// Of the tool as it is, at the field's conditions and by direction of approach: a tool whose offset was
/// estimated moves by its fitted error, with the joint covariance; of another, the stated variance of its
/// offset is added. Beyond the readings the value is held and u is that of the function there. `field`: of
/// this result and tool.
VolumetricError volumetric_error(const FitResult& result, const ErrorField& field,
                                 const AxisPosition& position, const Tool& tool,
                                 const ApproachDirection& direction = {});
/// At the default conditions, mean of both directions.
VolumetricError volumetric_error(const FitResult& result, const AxisPosition& position, const Tool& tool);
/// `per_axis` positions on each linear axis, ends included, the last axis fastest; rotary axes at 0.
std::vector<AxisPosition> grid_positions(const Machine& machine, int per_axis);
/// Grid over the travel, `per_axis` positions each, for every tool, plane by plane of the first axis of
/// axis_grid().
void for_each_plane_of_grid(const FitResult& result, int per_axis, const Conditions& conditions,
                            const std::function<void(std::span<const VolumetricError>)>& use);

}  // namespace volcal
