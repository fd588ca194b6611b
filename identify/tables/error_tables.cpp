#include "volcal/identify/tables/error_tables.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/tables/correction_positions.h"
#include "volcal/identify/tables/error_grid.h"
#include "volcal/model/effects/reversal_label.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

constexpr double kEdgeOfMeasured = 1e-6;  // m or rad

/// As asked for; otherwise steps of 1, 2 or 5 x 10^n that give 21 to 51 positions; the last step may be
/// shorter.
std::vector<double> table_positions(const Axis& axis, const ErrorTableOptions& options) {
  if (options.step > 0.0 && !is_rotary(axis.name)) return correction_positions(axis, options.step, false);
  const int positions = options.positions;
  std::vector<double> table;
  if (positions >= 2) {
    for (int i = 0; i < positions; ++i) {
      table.push_back(axis.travel_min + axis.travel() * static_cast<double>(i) / (positions - 1));
    }
    return table;
  }
  const double edge = is_rotary(axis.name) ? 3.14159265358979323846 / 180.0 : 1e-3;
  const double coarsest = axis.travel() / edge / 20.0;
  const double decade = std::pow(10.0, std::floor(std::log10(coarsest)));
  double step = decade;
  for (const double factor : {2.0, 5.0}) {
    if (decade * factor <= coarsest * (1.0 + 1e-9)) step = decade * factor;
  }
  const double first = std::ceil(axis.travel_min / edge / step - 1e-9) * step;
  table.push_back(axis.travel_min);
  for (int i = 0;; ++i) {
    const double q = (first + i * step) * edge;
    if (q >= axis.travel_max - 1e-9) break;
    if (q > axis.travel_min + 1e-9) table.push_back(q);
  }
  table.push_back(axis.travel_max);
  return table;
}

/// Reversal amplitude block of a symbol, if the model has one.
const ParameterBlock* reversal_of(const FitResult& result, ErrorSymbol symbol) {
  return result.layout.find_block(reversal_label(symbol));
}

const FunctionSummary* summary_of(const FitResult& result, ErrorSymbol symbol) {
  const auto found = std::ranges::find(result.functions, symbol, &FunctionSummary::symbol);
  return found == result.functions.end() ? nullptr : &*found;
}

/// Raw row of a table value: function at q, direction share of the reversal, less the same at home when
/// shifted.
Eigen::VectorXd table_row(const FitResult& result, ErrorSymbol symbol, double q, int direction,
                          bool zero_plus) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(result.layout.size);
  const bool at_home = q == result.machine.axis(symbol.axis).home;  // where the datum makes it zero
  if (const auto place = result.layout.find(symbol); place && !at_home) {
    const FunctionGroup& group = result.layout.groups[static_cast<std::size_t>(place->group)];
    const Eigen::VectorXd values = group.basis->row(q);
    for (int j = 0; j < group.basis->size(); ++j) row[group.index(j, place->slot)] = values[j];
  }
  if (const ParameterBlock* reversal = reversal_of(result, symbol)) {
    row[reversal->offset] = 0.5 * direction - (zero_plus ? 0.5 : 0.0);
  }
  return row;
}

ErrorTableRow filled(const FitResult& result, const ErrorTableRow& place, const Eigen::VectorXd& row) {
  ErrorTableRow table_row = place;
  table_row.value = row.dot(result.parameters);
  table_row.u = std::sqrt(std::max(0.0, row.dot(result.covariance * row)));
  table_row.U95 = result.coverage_factor * table_row.u;
  return table_row;
}

/// Of a tool whose offset was estimated.
const ParameterBlock* find_tool_offset(const FitResult& result, const Tool& tool) {
  return result.layout.find_block("tool " + tool.name);
}

/// Per component of the tool's offset, m^2; 0 where it was estimated.
double stated_variance(const FitResult& result, const Tool& tool) {
  return find_tool_offset(result, tool) == nullptr ? tool.offset_sigma * tool.offset_sigma : 0.0;
}

bool outside(const FunctionSummary* summary, double q) {
  return summary != nullptr &&
         (q < summary->measured_min - kEdgeOfMeasured || q > summary->measured_max + kEdgeOfMeasured);
}

/// Calls visit(row without values, its derivatives to the parameters) for every row of the table.
template <class Visit>
void for_each_table_row(const FitResult& result, const ErrorTableOptions& options, const Visit& visit) {
  for (const Axis& axis : result.machine.axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      const bool reversal = reversal_of(result, symbol) != nullptr;
      if (!result.layout.find(symbol) && !reversal) continue;
      for (const int direction : reversal ? std::vector<int>{1, -1} : std::vector<int>{0}) {
        for (const double q : table_positions(axis, options)) {
          ErrorTableRow place;
          place.symbol = symbol.name();
          place.axis = axis.name;
          place.position = q;
          place.direction = direction;
          place.rotation = is_rotation(component);
          place.extrapolated = outside(summary_of(result, symbol), q);
          visit(place, table_row(result, symbol, q, direction, options.zero_plus && reversal));
        }
      }
    }
  }
  for (const ParameterBlock& block : result.layout.blocks) {
    if (!block.location) continue;
    ErrorTableRow place;
    place.symbol = block.name;
    place.rotation = is_rotation(block.location->component);
    visit(place, Eigen::VectorXd::Unit(result.layout.size, block.offset));
  }
}

}  // namespace

std::vector<ErrorTableRow> error_table(const FitResult& result, const ErrorTableOptions& options) {
  std::vector<ErrorTableRow> table;
  for_each_table_row(result, options, [&](const ErrorTableRow& place, const Eigen::VectorXd& row) {
    table.push_back(filled(result, place, row));
  });
  return table;
}

Eigen::MatrixXd error_table_derivatives(const FitResult& result, const ErrorTableOptions& options) {
  std::vector<Eigen::VectorXd> rows;
  for_each_table_row(result, options,
                     [&](const ErrorTableRow&, const Eigen::VectorXd& row) { rows.push_back(row); });
  Eigen::MatrixXd derivatives(static_cast<Eigen::Index>(rows.size()), result.layout.size);
  for (std::size_t i = 0; i < rows.size(); ++i)
    derivatives.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  return derivatives;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> volumetric_error_rows(const FitResult& result,
                                                               const AxisPosition& position,
                                                               const Tool& tool) {
  const KinematicChain chain(result.machine);
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows =
      pose_error_rows(chain, result.layout, position, tool.offset);
  if (const ParameterBlock* fitted_offset = find_tool_offset(result, tool)) {
    rows.block<3, 3>(0, fitted_offset->offset) = chain.nominal_rotation_wt(position);
  }
  return rows;
}

VolumetricError volumetric_error(const FitResult& result, const AxisPosition& position, const Tool& tool) {
  VolumetricError error;
  error.position = position;
  error.tool = tool.name;
  const auto rows = volumetric_error_rows(result, position, tool);
  error.value = rows * result.parameters;
  Eigen::Matrix<double, 6, 6> covariance = rows * result.covariance * rows.transpose();
  covariance.topLeftCorner<3, 3>().diagonal().array() += stated_variance(result, tool);
  error.u = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  error.extrapolated = is_extrapolated(result, position);
  return error;
}

bool is_extrapolated(const FitResult& result, const AxisPosition& position) {
  return std::ranges::any_of(result.functions, [&](const FunctionSummary& function) {
    return outside(&function, position[index_of(function.symbol.axis)]);
  });
}

std::vector<AxisPosition> grid_positions(const Machine& machine, int per_axis) {
  return axis_grid(machine, per_axis).positions();
}

namespace {

using UseOfNodes = std::function<void(std::span<const VolumetricError>)>;

void for_each_plane_of_tool(const FitResult& result, const Tool& tool, const AxisGrid& axes,
                            const UseOfNodes& use) {
  const ErrorGrid errors(result, tool, axes);
  const PlaneTables displacements = errors.displacements(), rotations = errors.rotations(),
                    rotation_variances = errors.rotation_variances();
  const double of_tool = stated_variance(result, tool);
  AxisGrid plane = axes;
  std::vector<VolumetricError> nodes;
  errors.for_each_plane_of_covariances([&](std::size_t first, std::span<const Covariance3> covariance) {
    plane.nodes[0] = {axes.nodes[0][first]};
    const std::vector<AxisPosition> positions = plane.positions();
    const auto displacement = sum_planes(plane_of(displacements, first));
    const auto rotation = sum_planes(plane_of(rotations, first));
    const auto rotation_variance = sum_planes(plane_of(rotation_variances, first));
    nodes.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      VolumetricError& error = nodes[i];
      error.position = positions[i];
      error.tool = tool.name;
      error.value << displacement[i], rotation[i];
      error.u << covariance[i].variances() + Eigen::Vector3d::Constant(of_tool), rotation_variance[i];
      error.u = error.u.cwiseMax(0.0).cwiseSqrt().eval();
      error.extrapolated = is_extrapolated(result, positions[i]);
    }
    use(nodes);
  });
}

}  // namespace

void for_each_plane_of_grid(const FitResult& result, int per_axis,
                            const std::function<void(std::span<const VolumetricError>)>& use) {
  const AxisGrid axes = axis_grid(result.machine, per_axis);
  for (const Tool& tool : result.machine.tools) for_each_plane_of_tool(result, tool, axes, use);
}

std::vector<VolumetricError> volumetric_grid(const FitResult& result, int per_axis) {
  std::vector<VolumetricError> grid;
  for_each_plane_of_grid(result, per_axis, [&grid](std::span<const VolumetricError> nodes) {
    grid.insert(grid.end(), nodes.begin(), nodes.end());
  });
  return grid;
}

}  // namespace volcal
