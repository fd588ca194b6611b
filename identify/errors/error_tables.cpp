#include "volcal/identify/errors/error_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "volcal/identify/errors/correction_positions.h"
#include "volcal/identify/errors/error_grid.h"
#include "volcal/identify/errors/rigid_compromise.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

constexpr double kRounding = 1e-12;         // m or rad, of a value that the datum makes zero
constexpr double kUnmeasuredTravel = 1e-6;  // m or rad, that is noticed

/// Shortest piece of the functions of a linear axis within the measured positions; infinite without one.
double shortest_piece(const FitResult& result, AxisName axis) {
  double shortest = std::numeric_limits<double>::infinity();
  if (is_rotary(axis)) return shortest;
  const MeasuredTravel measured(result);
  for (const FunctionGroup& group : result.layout.groups) {
    if (group.axis != axis) continue;
    const std::vector<double> ends = group.basis->pieces();
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const bool inside = ends[i] > measured[axis].first - kUnmeasuredTravel &&
                          ends[i + 1] < measured[axis].last + kUnmeasuredTravel;
      if (inside) shortest = std::min(shortest, ends[i + 1] - ends[i]);
    }
  }
  return shortest;
}

/// 1, 2 or 5 x 10^n, mm or degrees, that give 21 to 51 positions, more where these are long beside the pieces
/// of the functions.
double round_step(const FitResult& result, const Axis& axis) {
  constexpr double kFewest = 20.0, kMost = 200.0;  // steps
  constexpr double kOfPiece = 1.5;  // longest step; beyond two a wave of the pieces may be met at its zeros
  const double edge = position_unit(axis.name).si_per_unit;
  const double coarsest = std::clamp(kOfPiece * shortest_piece(result, axis.name), axis.travel() / kMost,
                                     axis.travel() / kFewest) /
                          edge;
  const double decade = std::pow(10.0, std::floor(std::log10(coarsest)));
  double step = decade;
  for (const double factor : {2.0, 5.0}) {
    if (decade * factor <= coarsest * (1.0 + 1e-9)) step = decade * factor;
  }
  return step;
}

/// Multiples of the step (mm, degrees) within the travel, and its ends.
std::vector<double> positions_every(double step, const Axis& axis) {
  const double edge = position_unit(axis.name).si_per_unit;
  const double first = std::ceil(axis.travel_min / edge / step - 1e-9) * step;
  std::vector<double> positions = {axis.travel_min};
  for (int i = 0;; ++i) {
    const double q = (first + i * step) * edge;
    if (q >= axis.travel_max - 1e-9) break;
    if (q > axis.travel_min + 1e-9) positions.push_back(q);
  }
  positions.push_back(axis.travel_max);
  return positions;
}

/// As asked for; otherwise round steps, of which the last may be shorter.
std::vector<double> table_positions(const FitResult& result, const Axis& axis,
                                    const ErrorTableOptions& options) {
  if (options.step > 0.0 && !is_rotary(axis.name)) return correction_positions(axis, options.step, false);
  if (options.rotary_step > 0.0 && is_rotary(axis.name))
    return positions_every(options.rotary_step / kRadianPerDegree, axis);
  const int positions = options.positions;
  if (positions < 2) return positions_every(round_step(result, axis), axis);
  std::vector<double> table;
  for (int i = 0; i < positions; ++i)
    table.push_back(axis.travel_min + axis.travel() * static_cast<double>(i) / (positions - 1));
  return table;
}

/// The tool that the share of effects is found for: the named one, or the machine's first.
Tool tool_of_tables(const Machine& machine, const ErrorTableOptions& options) {
  const auto index = machine.tool_index(options.tool);
  return index ? machine.tools[*index] : machine.functional_tools().front();
}

/// Rows of error tables: error functions, effects by their own axis' position and direction, and the share of
/// other effects that a rigid body can have (rigid_compromise.h), at stated conditions.
class TableRows {
 public:
  TableRows(const FitResult& result, const ErrorTableOptions& options)
      : result_(result),
        options_(options),
        conditions_(options.conditions ? *options.conditions : default_conditions(result)),
        tool_(tool_of_tables(result.machine, options)),
        measured_(result),
        effects_(result, tool_, conditions_),
        compromise_(result, tool_, conditions_) {
    for (std::size_t c = 0; c < effects_.amplitude_count(); ++c) {
      const EffectColumn& column = effects_.columns()[c];
      if (is_of_own_axis(effects_, column.effect)) own_.push_back(c);
    }
    for (const EffectColumn& column : effects_.columns()) {
      if (column.shape >= 0) shape_parameters_.insert(column.parameter);
    }
    for (const Axis& axis : result.machine.axes) {
      if (!axis.expansion) continue;
      const auto stated = conditions_.temperature_degC.find(axis.expansion->channel);
      if (stated == conditions_.temperature_degC.end()) continue;
      excess_[index_of(axis.name)] = stated->second - kReferenceTemperature_degC;
    }
  }

  /// Whether a symbol's value differs between the directions of approach.
  bool has_directions(ErrorSymbol symbol) const {
    const bool own = std::ranges::any_of(own_, [&](std::size_t c) {
      const EffectColumn& column = effects_.columns()[c];
      return column.target.symbol == symbol && effects_.reach(column.effect).direction[index_of(symbol.axis)];
    });
    return own || (has_share(symbol) && coupled_direction(symbol.axis));
  }

  bool has(ErrorSymbol symbol) const {
    const bool own = std::ranges::any_of(
        own_, [&](std::size_t c) { return effects_.columns()[c].target.symbol == symbol; });
    return own || result_.layout.find(symbol).has_value() || has_share(symbol) ||
           (is_expanding(symbol) && excess_[index_of(symbol.axis)] != 0.0);
  }

  /// Beyond the measured positions, or the readings of a curve of this symbol.
  bool is_extrapolated(ErrorSymbol symbol, double q, int direction) const {
    AxisPosition position{};
    position.fill(std::numeric_limits<double>::quiet_NaN());
    position[index_of(symbol.axis)] = q;
    return measured_.is_beyond(position) || !faded(symbol, q, direction).isZero(0.0);
  }

  /// Standard uncertainty of what curves of a symbol may still be beyond their readings.
  double u_of_faded(ErrorSymbol symbol, double q, int direction) const {
    AxisPosition position{};
    position[index_of(symbol.axis)] = q;
    double squares = 0.0;
    for (const FadedSurface& each :
         effects_.faded_surfaces(measured_.held(position), along(symbol.axis, direction))) {
      const bool is_own = each.target.kind == TargetKind::Motion && each.target.symbol == symbol &&
                          is_of_own_axis(effects_, each.effect);
      if (is_own) squares += each.u * each.u;
    }
    return std::sqrt(squares);
  }

  /// Derivatives to the parameters of what curves of a symbol have lost beyond their readings.
  Eigen::VectorXd faded(ErrorSymbol symbol, double q, int direction) const {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(result_.layout.size);
    AxisPosition position{};
    position[index_of(symbol.axis)] = q;
    const AxisPosition held = measured_.held(position);
    const ApproachDirection approach = along(symbol.axis, direction);
    const Eigen::MatrixXd lost = effects_.faded_drivers({&held, 1}, {&approach, 1});
    if (lost.size() == 0) return row;
    for (const std::size_t c : own_) {
      const EffectColumn& column = effects_.columns()[c];
      if (column.target.symbol == symbol) row[column.parameter] += lost(0, static_cast<Eigen::Index>(c));
    }
    return row;
  }

  /// Derivatives of a value to the parameters. Beyond the readings those of the function there, of which the
  /// uncertainty is stated, or, `held`, of the value that is held.
  Eigen::VectorXd derivatives(ErrorSymbol symbol, double q, int direction, bool held) const {
    Eigen::VectorXd row = at(symbol, q, direction, held);
    if (options_.zero_plus && has_directions(symbol))
      row -= at(symbol, result_.machine.axis(symbol.axis).home, 1, held);
    return row;
  }

  /// Of a squareness or another location error: its parameter, where it has one, and the share of effects.
  Eigen::VectorXd derivatives(LocationSymbol symbol) const {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(result_.layout.size);
    for (const ParameterBlock& block : result_.layout.blocks) {
      if (block.location == symbol) row[block.offset] = 1.0;
    }
    if (compromise_.empty()) return row;
    const Eigen::RowVectorXd share = compromise_.squareness(symbol);
    const std::vector<int> parameters = compromise_.parameters();
    for (std::size_t c = 0; c < parameters.size(); ++c)
      row[parameters[c]] += share[static_cast<Eigen::Index>(c)];
    return row;
  }

  /// Those with a parameter, in the order of the layout, then those that are a share of effects alone.
  std::vector<LocationSymbol> locations() const {
    std::vector<LocationSymbol> symbols;
    for (const ParameterBlock& block : result_.layout.blocks) {
      if (block.location) symbols.push_back(*block.location);
    }
    if (compromise_.empty()) return symbols;
    for (const LocationSymbol symbol : squareness_errors(result_.machine)) {
      const bool is_known = std::ranges::find(symbols, symbol) != symbols.end();
      if (!is_known && !compromise_.squareness(symbol).isZero(0.0)) symbols.push_back(symbol);
    }
    return symbols;
  }

  /// What a value has beside its derivatives times the parameters: a known expansion, and the parameters of
  /// shapes, in which it is not linear.
  double constant(ErrorSymbol symbol, double q, const Eigen::VectorXd& derivatives) const {
    double value = 0.0;
    for (const int parameter : shape_parameters_)
      value -= derivatives[parameter] * result_.parameters[parameter];
    const Axis& axis = result_.machine.axis(symbol.axis);
    if (!is_expanding(symbol) || !axis.expansion) return value;
    return value + axis.expansion->per_kelvin * excess_[index_of(symbol.axis)] * (q - axis.home);
  }

 private:
  static bool is_expanding(ErrorSymbol symbol) { return symbol.is_positioning(); }
  static ApproachDirection along(AxisName axis, int direction) {
    ApproachDirection approach{};
    approach[index_of(axis)] = static_cast<std::int8_t>(direction);
    return approach;
  }
  bool has_share(ErrorSymbol symbol) const { return !compromise_.empty() && !is_rotary(symbol.axis); }
  bool coupled_direction(AxisName axis) const {
    for (std::size_t e = 0; e < effects_.effect_count(); ++e) {
      if (!is_of_own_axis(effects_, e) && effects_.reach(e).direction[index_of(axis)]) return true;
    }
    return false;
  }

  /// Identified functions are zero at home but for rounding; stated ones need not be.
  bool is_zero_by_datum(ErrorSymbol symbol, double q, const Eigen::VectorXd& row) const {
    return q == result_.machine.axis(symbol.axis).home && std::abs(row.dot(result_.parameters)) < kRounding;
  }

  Eigen::VectorXd function_row(const ParameterLayout::FunctionPlace& place, double q) const {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(result_.layout.size);
    const FunctionGroup& group = result_.layout.groups[static_cast<std::size_t>(place.group)];
    const Eigen::VectorXd values = group.basis->row(q);
    for (int j = 0; j < group.basis->size(); ++j) row[group.index(j, place.slot)] = values[j];
    return row;
  }

  Eigen::VectorXd at(ErrorSymbol symbol, double q, int direction, bool hold) const {
    AxisPosition position{};
    position[index_of(symbol.axis)] = q;
    const AxisPosition held = measured_.held(position);
    Eigen::VectorXd row = Eigen::VectorXd::Zero(result_.layout.size);
    if (const auto place = result_.layout.find(symbol)) {
      row = function_row(*place, hold ? held[index_of(symbol.axis)] : q);
      if (is_zero_by_datum(symbol, q, row)) row.setZero();
    }
    if (!own_.empty()) add_own_effects(symbol, held, direction, row);
    if (has_share(symbol)) {
      const PoseErrorRows shares = compromise_.motions(symbol.axis, q, direction);
      const std::vector<int> parameters = compromise_.parameters();
      for (std::size_t c = 0; c < parameters.size(); ++c)
        row[parameters[c]] +=
            shares(static_cast<Eigen::Index>(index_of(symbol.component)), static_cast<Eigen::Index>(c));
    }
    const ParameterBlock* expansion = result_.layout.find_block(expansion_parameter(symbol.axis));
    if (is_expanding(symbol) && expansion != nullptr)
      row[expansion->offset] += excess_[index_of(symbol.axis)] * (q - result_.machine.axis(symbol.axis).home);
    return row;
  }

  void add_own_effects(ErrorSymbol symbol, const AxisPosition& held, int direction,
                       Eigen::VectorXd& row) const {
    const ApproachDirection approach = along(symbol.axis, direction);
    const Eigen::MatrixXd drivers = effects_.drivers_and_slopes({&held, 1}, {&approach, 1});
    for (std::size_t c = 0; c < effects_.columns().size(); ++c) {
      const EffectColumn& column = effects_.columns()[c];
      if (!(column.target.kind == TargetKind::Motion && column.target.symbol == symbol) ||
          !is_of_own_axis(effects_, column.effect))
        continue;
      const double amplitude = column.shape < 0 ? 1.0 : result_.parameters[column.amplitude_parameter];
      row[column.parameter] += amplitude * drivers(0, static_cast<Eigen::Index>(c));
    }
  }

  const FitResult& result_;
  const ErrorTableOptions& options_;
  Conditions conditions_;
  Tool tool_;
  MeasuredTravel measured_;
  MachineEffects effects_;
  RigidCompromise compromise_;
  std::vector<std::size_t> own_;  ///< columns of effects by their own axis alone
  std::set<int> shape_parameters_;
  std::array<double, kAxisCount> excess_{};  ///< temperature of the scale less 20 degC, K
};

/// Calls visit(row without its uncertainty, derivatives to the parameters, u of what has faded out) for every
/// row of the table.
template <class Visit>
void for_each_table_row(const FitResult& result, const ErrorTableOptions& options, const Visit& visit) {
  const TableRows rows(result, options);
  for (const Axis& axis : result.machine.axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      if (!rows.has(symbol)) continue;
      for (const int direction :
           rows.has_directions(symbol) ? std::vector<int>{1, -1} : std::vector<int>{0}) {
        for (const double q : table_positions(result, axis, options)) {
          ErrorTableRow place;
          place.symbol = symbol;
          place.axis = axis.name;
          place.position = q;
          place.direction = direction;
          place.rotation = is_rotation(component);
          place.extrapolated = rows.is_extrapolated(symbol, q, direction);
          const Eigen::VectorXd held = rows.derivatives(symbol, q, direction, true);
          place.value = held.dot(result.parameters) + rows.constant(symbol, q, held);
          if (!place.extrapolated) {
            visit(place, held, 0.0);
            continue;
          }
          visit(place, rows.derivatives(symbol, q, direction, false) + rows.faded(symbol, q, direction),
                rows.u_of_faded(symbol, q, direction));
        }
      }
    }
  }
  for (const LocationSymbol symbol : rows.locations()) {
    const Eigen::VectorXd derivatives = rows.derivatives(symbol);
    ErrorTableRow place;
    place.symbol = symbol;
    place.rotation = is_rotation(symbol.component);
    place.value = derivatives.dot(result.parameters);
    visit(place, derivatives, 0.0);
  }
}

PoseErrorVector variance_of(const PoseErrorRows& rows, const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return PoseErrorVector::Zero();
  return (rows * covariance).cwiseProduct(rows).rowwise().sum();
}

/// Of a value that depends on few of the parameters.
double variance_of(const Eigen::VectorXd& derivatives, const Eigen::MatrixXd& covariance) {
  if (covariance.size() == 0) return 0.0;
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < derivatives.size(); ++i) {
    if (derivatives[i] != 0.0) used.push_back(i);
  }
  return std::max(0.0, derivatives(used).dot(covariance(used, used) * derivatives(used)));
}

PoseErrorVector variance_beyond_readings(const FitResult& result, const ErrorField& field,
                                         const AxisPosition& position, const ApproachDirection& direction) {
  return variance_of(field.unheld_rows(position, direction), result.covariance) +
         field.faded_variance(position, direction);
}

}  // namespace

void check_table_rows(int positions) {
  if (positions == 0 || (positions >= kFewestTableRows && positions <= kMostTableRows)) return;
  throw InputError({}, setting("positions") + " " + std::to_string(positions) + " is out of range",
                   "give " + std::to_string(kFewestTableRows) + " to " + std::to_string(kMostTableRows));
}

std::vector<ErrorTableRow> error_table(const FitResult& result, const ErrorTableOptions& options) {
  std::vector<ErrorTableRow> table;
  for_each_table_row(
      result, options, [&](ErrorTableRow row, const Eigen::VectorXd& derivatives, double u_of_faded) {
        row.u = std::sqrt(variance_of(derivatives, result.covariance) + u_of_faded * u_of_faded);
        row.U95 = result.coverage_factor * row.u;
        table.push_back(row);
      });
  return table;
}

Eigen::MatrixXd error_table_derivatives(const FitResult& result, const ErrorTableOptions& options) {
  std::vector<Eigen::VectorXd> rows;
  for_each_table_row(result, options,
                     [&](const ErrorTableRow&, const Eigen::VectorXd& row, double) { rows.push_back(row); });
  Eigen::MatrixXd derivatives(static_cast<Eigen::Index>(rows.size()), result.layout.size);
  for (std::size_t i = 0; i < rows.size(); ++i)
    derivatives.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  return derivatives;
}

VolumetricError volumetric_error(const FitResult& result, const ErrorField& field,
                                 const AxisPosition& position, const Tool& tool,
                                 const ApproachDirection& direction) {
  VolumetricError error;
  error.position = position;
  error.tool = tool.name;
  error.value = field.at(position, direction);
  error.extrapolated = field.is_beyond_readings(position, direction);
  PoseErrorVector variance = PoseErrorVector::Zero();
  if (result.covariance.size() > 0)
    variance = variance_of(field.rows(position, direction), result.covariance);
  if (error.extrapolated)
    variance = variance_beyond_readings(result, field, position, direction).cwiseMax(variance);
  variance.head<3>().array() += field.stated_tool_variance();
  error.u = variance.cwiseMax(0.0).cwiseSqrt();
  return error;
}

VolumetricError volumetric_error(const FitResult& result, const AxisPosition& position, const Tool& tool) {
  return volumetric_error(result, ErrorField(result, tool), position, tool);
}

std::vector<AxisPosition> grid_positions(const Machine& machine, int per_axis) {
  return axis_grid(machine, per_axis).positions();
}

namespace {

void for_each_plane_of_tool(const FitResult& result, const Tool& tool, const AxisGrid& axes,
                            const Conditions& conditions,
                            const std::function<void(std::span<const VolumetricError>)>& use) {
  const ErrorGrid errors(result, tool, axes, conditions);
  const ErrorField field(result, tool, conditions);
  const double of_tool = field.stated_tool_variance();
  AxisGrid plane = axes;
  std::vector<VolumetricError> nodes;
  errors.for_each_plane([&](std::size_t first, std::span<const NodeError> of_plane) {
    plane.nodes[0] = {axes.nodes[0][first]};
    const std::vector<AxisPosition> positions = plane.positions();
    nodes.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      VolumetricError& error = nodes[i];
      error.position = positions[i];
      error.tool = tool.name;
      error.value = of_plane[i].value;
      error.extrapolated = field.is_beyond_readings(positions[i]);
      PoseErrorVector variance = of_plane[i].variance;
      if (error.extrapolated)
        variance = variance_beyond_readings(result, field, positions[i], {}).cwiseMax(variance);
      variance.head<3>().array() += of_tool;
      error.u = variance.cwiseMax(0.0).cwiseSqrt();
    }
    use(nodes);
  });
}

}  // namespace

void for_each_plane_of_grid(const FitResult& result, int per_axis, const Conditions& conditions,
                            const std::function<void(std::span<const VolumetricError>)>& use) {
  const AxisGrid axes = axis_grid(result.machine, per_axis);
  for (const Tool& tool : result.machine.functional_tools())
    for_each_plane_of_tool(result, tool, axes, conditions, use);
}

std::vector<Finding> unmeasured_travel(const FitResult& result) {
  const MeasuredTravel measured(result);
  std::vector<Finding> findings;
  for (const Axis& axis : result.machine.axes) {
    const MeasuredEnds& ends = measured[axis.name];
    if (ends.cover(axis)) continue;
    const Unit unit = position_unit(axis.name);
    const auto at = [&unit](double position) {
      return FindingNumber{position, std::string(unit.suffix), unit.si_per_unit};
    };
    findings.push_back({FindingCode::ErrorsHeldBeyondReadings,
                        {{"axis", std::string{letter_of(axis.name)}},
                         {"measured_from", at(ends.first)},
                         {"measured_to", at(ends.last)},
                         {"travel_from", at(axis.travel_min)},
                         {"travel_to", at(axis.travel_max)}}});
  }
  return findings;
}

std::vector<Finding> effects_in_no_figure(const FitResult& result) {
  std::vector<Finding> findings;
  for (const EffectOnNoPose& effect : effects_on_no_pose(result))
    findings.push_back({FindingCode::EffectInNoFigure, {{"effect", effect.label}}});
  return findings;
}

std::vector<Finding> errors_in_no_table(const FitResult& result, std::span<const AxisName> rotary) {
  std::vector<Finding> findings;
  for (const EffectOnNoPose& effect : effects_on_no_pose(result))
    findings.push_back({FindingCode::EffectInNoTable, {{"effect", effect.label}}});
  for (const AxisName axis : rotary)
    findings.push_back({FindingCode::RotaryErrorsInNoTable, {{"axis", std::string(1, letter_of(axis))}}});
  return findings;
}

}  // namespace volcal
