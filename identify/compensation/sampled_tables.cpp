#include "volcal/identify/compensation/sampled_tables.h"

#include <algorithm>
#include <set>
#include <span>

#include "volcal/identify/errors/correction_positions.h"
#include "volcal/identify/errors/plane_tables.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::size_t kMostGridPoints = 500'000;

bool moves(CompensationType type, AxisName input, AxisName output) {
  if (input == output) return type.has(CompensationPart::Positioning);
  return type.has(CompensationPart::Straightness) || type.has(CompensationPart::Squareness);
}

AxisTable sampled_axis(const Compensation& ideal, AxisName input, AxisName output,
                       const std::vector<double>& positions, bool both_directions) {
  AxisTable table{.input = input, .position = positions, .forward = {}, .backward = {}};
  const auto value = [&](double q, int direction) {
    return ideal.along_axis(input, q, direction)[direction_of(output)];
  };
  for (const double q : positions) {
    table.forward.push_back(value(q, both_directions ? 1 : 0));
    table.backward.push_back(value(q, both_directions ? -1 : 0));
  }
  return table;
}

/// Values at every node. `of_two_axes`: the field has no term of three axes, as corrections of identified
/// errors; those of tables that were active may have.
template <class Field>
std::vector<Eigen::Vector3d> sampled(const std::array<std::vector<double>, 3>& nodes, bool of_two_axes,
                                     const Field& field) {
  const auto at_node = [&](std::size_t i, std::size_t j, std::size_t k) {
    return field(AxisPosition{nodes[0][i], nodes[1][j], nodes[2][k], 0.0, 0.0, 0.0});
  };
  if (of_two_axes)
    return sum_planes(sample_planes({nodes[0].size(), nodes[1].size(), nodes[2].size()}, at_node));
  std::vector<Eigen::Vector3d> values;
  for_each_node(nodes, [&](std::size_t, const AxisPosition& position) { values.push_back(field(position)); });
  return values;
}

[[noreturn]] void fail_grid(const SourcePlace& place) {
  throw InputError(place, "the rows are not a complete grid",
                   "write every X, Y, Z combination once, ascending, Z fastest; write the tables again");
}

}  // namespace

std::vector<SampledTable> sample_axis_tables(const TableFormat& format, const FitResult& result,
                                             const TableFormatOptions& options) {
  const Compensation ideal = sampled_compensation(format, result, options);
  std::vector<SampledTable> tables;
  for (const AxisName input : result.machine.main_linear_axes()) {
    const Axis& axis = result.machine.axis(input);
    const auto positions = correction_positions(axis, options.step, format.limits.equidistant);
    require_points(format, axis, positions.size());
    for (const AxisName output : result.machine.main_linear_axes()) {
      if (!moves(options.type, input, output)) continue;
      tables.push_back(
          {output, sampled_axis(ideal, input, output, positions, format.limits.both_directions)});
    }
  }
  return tables;
}

CorrectionGrid sample_grid(const TableFormat& format, const FitResult& result,
                           const TableFormatOptions& options) {
  const Compensation ideal = sampled_compensation(format, result, options);
  CorrectionGrid grid;
  grid.nodes = {{{0.0}, {0.0}, {0.0}}};
  for (const AxisName axis : result.machine.main_linear_axes()) {
    auto& nodes = grid.nodes[index_of(axis)];
    nodes = correction_positions(result.machine.axis(axis), options.step, format.limits.equidistant);
    require_points(format, result.machine.axis(axis), nodes.size());
  }
  if (grid.size() > kMostGridPoints)
    throw InputError({},
                     "the grid would have " + std::to_string(grid.size()) + " points, " +
                         std::to_string(kMostGridPoints) + " are written at most",
                     "give a larger --step");
  const bool of_two_axes = is_of_two_axes(result, options);
  grid.mean = sampled(grid.nodes, of_two_axes,
                      [&](const AxisPosition& position) { return ideal.correction(position, {}); });
  if (!format.limits.both_directions) return grid;
  for (std::size_t i = 0; i < 3; ++i) {
    ApproachDirection towards_plus{};
    towards_plus[i] = 1;
    grid.half_reversal[i] =
        sampled(grid.nodes, of_two_axes, [&](const AxisPosition& position) -> Eigen::Vector3d {
          return ideal.correction(position, towards_plus) - ideal.correction(position, {});
        });
  }
  return grid;
}

std::array<std::vector<double>, 3> grid_nodes(const std::vector<std::array<double, 3>>& points,
                                              const std::vector<SourcePlace>& places) {
  std::array<std::vector<double>, 3> nodes;
  for (std::size_t i = 0; i < 3; ++i) {
    std::set<double> values;
    for (const auto& point : points) values.insert(point[i]);
    nodes[i].assign(values.begin(), values.end());
  }
  for_each_node(nodes, [&](std::size_t row, const AxisPosition& node) {
    if (row >= points.size()) fail_grid(places.back());
    if (!std::ranges::equal(points[row], std::span(node).first<3>())) fail_grid(places[row]);
  });
  const std::size_t size = nodes[0].size() * nodes[1].size() * nodes[2].size();
  if (size != points.size()) fail_grid(places[size]);
  return nodes;
}

}  // namespace volcal
