#include "volcal/identify/compensation/rotary_tables.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "volcal/identify/compensation/compensation.h"
#include "volcal/identify/compensation/joint_error_shares.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/model/description/errors.h"

namespace volcal {

double grid_step(const TableFormatOptions& options) {
  return options.rotary_step > 0.0 ? options.rotary_step : kDefaultRotaryGridStep;
}

double rotary_table_step(const TableFormatOptions& options) {
  return options.rotary_step > 0.0 ? options.rotary_step : kDefaultRotaryTableStep;
}

Eigen::Vector3d error_at_home_of_table(const FitResult& result, const TableFormatOptions& options) {
  const auto table = outermost_table_axis(result.machine.structure);
  const std::vector<AxisName> identified = identified_rotary_axes(result);
  const bool is_left =
      table && std::ranges::find(identified, *table) != identified.end() && !options.type.linear().empty();
  if (!is_left) return Eigen::Vector3d::Zero();
  return errors_to_correct(result, options)(home_of(result.machine), kTowardsPlus);
}

Eigen::Vector3d displacement_at_home(const FitResult& result, const TableFormatOptions& options) {
  if (!options.type.has(CompensationPart::RotaryLocation)) return Eigen::Vector3d::Zero();
  return error_at_home_of_table(result, options);
}

void add_displacement_of_table(const Structure& structure, const Eigen::Vector3d& displacement,
                               PoseErrors<double>& errors) {
  const auto axis = outermost_table_axis(structure);
  if (!axis) return;
  for (std::size_t k = 0; k < 3; ++k)
    errors.location[index_of(*axis)][k] -= displacement[static_cast<Eigen::Index>(k)];
}

JointErrorSource rotary_errors_to_correct(const FitResult& result, const TableFormatOptions& options) {
  return [errors = of_rotary_axes(
              joint_errors(result, tool_of(result.machine, options), conditions_of(result, options))),
          displacement = displacement_at_home(result, options), structure = result.machine.structure](
             const AxisPosition& position, const ApproachDirection& direction) {
    PoseErrors<double> all = errors(position, direction);
    add_displacement_of_table(structure, displacement, all);
    return all;
  };
}

std::vector<RotaryGrid> rotary_grids_to_correct(const FitResult& result, const TableFormatOptions& options,
                                                const RotaryShares& shares) {
  std::vector<RotaryGrid> grids =
      rotary_grids(result, conditions_of(result, options), grid_step(options), shares);
  const Eigen::Vector3d displacement = displacement_at_home(result, options);
  for (RotaryGrid& grid : grids) {
    if (grid.body != TurnedBody::Table) continue;
    for (RotaryTwist& twist : grid.twists) twist.value.head<3>() += displacement;
  }
  return grids;
}

RotaryShares twist_shares(const TableFormat& format, CompensationType type) {
  if (type.has(CompensationPart::RotaryRadialAxial) != type.has(CompensationPart::RotaryAngular))
    throw InputError({}, std::string(format.name) + " holds R-RAX and R-ANG together alone: a twist has both",
                     "give both, or R-VOL");
  return {.own = false,
          .location = type.has(CompensationPart::RotaryLocation),
          .motion = type.has(CompensationPart::RotaryAngular)};
}

std::vector<SampledTable> sample_rotary_positioning(const TableFormat& format, const FitResult& result,
                                                    const TableFormatOptions& options) {
  FiveAxisSettings settings;
  settings.type = CompensationPart::RotaryPositioning;
  const FiveAxisCompensation ideal(
      result.machine, settings,
      joint_errors(result, tool_of(result.machine, options), conditions_of(result, options)));
  std::vector<SampledTable> tables;
  for (const AxisName axis : identified_rotary_axes(result)) {
    const RotaryNodes nodes = rotary_nodes(result, axis, rotary_table_step(options));
    require_points(format, result.machine.axis(axis), nodes.positions.size());
    AxisTable table{.input = axis, .position = nodes.positions, .forward = {}, .backward = {}};
    if (nodes.full_turn) table.beyond = BeyondEnds::Repeat;
    const auto value = [&](double q, int towards) {
      AxisPosition position{};
      position[index_of(axis)] = q;
      ApproachDirection direction{};
      direction[index_of(axis)] = static_cast<std::int8_t>(format.limits.both_directions ? towards : 0);
      return ideal.correction(position, direction).rotary[direction_of(axis)];
    };
    for (const double q : nodes.positions) {
      table.forward.push_back(value(q, 1));
      table.backward.push_back(value(q, -1));
    }
    tables.push_back({axis, std::move(table)});
  }
  return tables;
}

AxisTable turn_from_zero(const AxisTable& table) {
  if (table.beyond != BeyondEnds::Repeat) return table;
  AxisTable turned = table;
  const auto count = static_cast<double>(table.position.size() - 1);
  for (std::size_t i = 0; i < table.position.size(); ++i) {
    turned.position[i] = static_cast<double>(i) / count * (table.position.back() - table.position.front());
    AxisPosition at{};
    at[index_of(table.input)] = turned.position[i];
    ApproachDirection direction{};
    direction[index_of(table.input)] = 1;
    turned.forward[i] = table.value(at, direction);
    direction[index_of(table.input)] = -1;
    turned.backward[i] = table.value(at, direction);
  }
  turned.forward.back() = turned.forward.front();
  turned.backward.back() = turned.backward.front();
  return turned;
}

bool make_a_turn(const std::vector<double>& positions) {
  constexpr double kTurn = 2.0 * std::numbers::pi, kSame = 1e-6;  // rad
  return positions.size() > 1 && std::abs(positions.back() - positions.front() - kTurn) < kSame;
}

}  // namespace volcal
