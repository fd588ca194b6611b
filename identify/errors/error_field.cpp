#include "volcal/identify/errors/error_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "volcal/identify/errors/effect_displacements.h"
#include "volcal/identify/errors/linear_axis_errors.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/description/units.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

/// Displacement and rotation of the tool per unit of an error motion.
PoseErrorVector motion_column(const JointLever& lever, Component component) {
  PoseErrorVector column;
  column << KinematicChain::motion_lever_w(lever, component),
      KinematicChain::motion_rotation_w(lever, component);
  return column;
}

double temperature_excess_at(const Conditions& conditions, const std::string& channel) {
  const auto stated = conditions.temperature_degC.find(channel);
  return stated == conditions.temperature_degC.end() ? 0.0 : stated->second - kReferenceTemperature_degC;
}

}  // namespace

MeasuredTravel::MeasuredTravel(const FitResult& result) {
  for (const auto& [axis, measured] : measured_positions(result)) {
    const bool round =
        result.machine.has_axis(axis) && goes_round(result.machine.axis(axis), result.identified);
    ends[index_of(axis)] = {measured.first, measured.second, round};
  }
}

AxisPosition MeasuredTravel::held(const AxisPosition& position) const {
  AxisPosition nearest = position;
  for (std::size_t a = 0; a < kAxisCount; ++a) nearest[a] = ends[a].nearest(position[a]);
  return nearest;
}

bool MeasuredTravel::is_beyond(const AxisPosition& position) const {
  for (std::size_t a = 0; a < kAxisCount; ++a) {
    if (ends[a].is_beyond(position[a])) return true;
  }
  return false;
}

ErrorField::ErrorField(const FitResult& result, const Tool& tool, const Conditions& conditions)
    : chain_(result.machine),
      tool_(tool),
      layout_(result.layout),
      parameters_(result.parameters),
      measured_(result),
      effects_(result, tool, conditions) {
  for (const Axis& axis : result.machine.axes) {
    if (!axis.expansion) continue;
    const std::string& channel = axis.expansion->channel;
    Expansion expansion{axis.name, channel, 0.0, temperature_excess_at(conditions, channel), axis.home, -1};
    expansion.strain = axis.expansion->per_kelvin * expansion.excess;
    const std::string name = expansion_parameter(axis.name);
    if (const ParameterBlock* block = layout_.find_block(name)) expansion.parameter = block->offset;
    expansions_.push_back(expansion);
  }
  for (const Expansion& expansion : expansions_) {
    if (expansion.parameter >= 0) condition_parameters_.push_back(expansion.parameter);
  }
  for (const EffectColumn& column : effects_.columns()) {
    if (std::ranges::find(condition_parameters_, column.parameter) == condition_parameters_.end())
      condition_parameters_.push_back(column.parameter);
    places_of_columns_.push_back(place_of(column.parameter));
  }
  if (const ParameterBlock* block = layout_.find_block(tool_parameter(tool.name))) {
    tool_parameter_ = block->offset;
  } else {
    stated_tool_variance_ = tool.offset_sigma * tool.offset_sigma;
  }
}

/// `offset_t`: displacement of the tool's offset by effects.
PoseErrors<double> ErrorField::errors_at(const AxisPosition& position, const ApproachDirection& direction,
                                         Vector3d& offset_t) const {
  const AxisPosition held = measured_.held(position);
  PoseErrors<double> errors = pose_errors(layout_, held, parameters_);
  offset_t.setZero();
  for (const Expansion& expansion : expansions_) {
    const double deviation =
        expansion.parameter < 0 ? 0.0 : parameters_[expansion.parameter] * expansion.excess;
    errors.motion[index_of(expansion.axis)][index_of(positioning_component(expansion.axis))] +=
        (expansion.strain + deviation) * (position[index_of(expansion.axis)] - expansion.home);
  }
  if (!effects_.empty()) {
    const Eigen::MatrixXd drivers = effects_.drivers({&held, 1}, {&direction, 1});
    for (std::size_t c = 0; c < effects_.amplitude_count(); ++c) {
      const EffectColumn& column = effects_.columns()[c];
      const double value = parameters_[column.parameter] * drivers(0, static_cast<Eigen::Index>(c));
      if (column.target.kind == TargetKind::ToolOffset) {
        offset_t[column.target.component] += value;
      } else if (column.target.kind == TargetKind::Motion) {
        errors.motion[index_of(column.target.symbol.axis)][index_of(column.target.symbol.component)] += value;
      }
    }
  }
  return errors;
}

PoseErrors<double> ErrorField::joint_errors(const AxisPosition& position,
                                            const ApproachDirection& direction) const {
  Vector3d offset_t;
  return errors_at(position, direction, offset_t);
}

Vector3d ErrorField::tool_displacement(const AxisPosition& position,
                                       const ApproachDirection& direction) const {
  Vector3d offset_t;
  errors_at(position, direction, offset_t);
  return offset_t;
}

PoseErrorVector ErrorField::at(const AxisPosition& position, const ApproachDirection& direction) const {
  Vector3d offset_t;
  const PoseErrors<double> errors = errors_at(position, direction, offset_t);
  if (tool_parameter_ >= 0) offset_t += parameters_.segment<3>(tool_parameter_);
  const ToolTwist twist = chain_.first_order(position, tool_.offset, errors);
  PoseErrorVector error;
  error << twist.displacement_w, twist.rotation_tool_side_w + twist.rotation_workpiece_side_w;
  if (!offset_t.isZero(0.0)) error.head<3>() += chain_.nominal_rotation_wt(position) * offset_t;
  return error;
}

Eigen::Index ErrorField::place_of(int parameter) const {
  return std::ranges::find(condition_parameters_, parameter) - condition_parameters_.begin();
}

void ErrorField::add_expansion_rows(const JointLever* levers, const AxisPosition& position,
                                    Eigen::Ref<PoseErrorRows> rows) const {
  for (const Expansion& expansion : expansions_) {
    if (expansion.parameter < 0) continue;
    const JointLever& lever = joint_lever(levers, chain_.joint_count(), expansion.axis);
    rows.col(place_of(expansion.parameter)) =
        motion_column(lever, positioning_component(expansion.axis)) *
        (expansion.excess * (position[index_of(expansion.axis)] - expansion.home));
  }
}

void ErrorField::add_effect_rows(const JointLever* levers, const AxisPosition& position,
                                 const Eigen::Ref<const Eigen::RowVectorXd, 0, Eigen::InnerStride<>>& drivers,
                                 Eigen::Ref<PoseErrorRows> rows) const {
  for (std::size_t c = 0; c < effects_.columns().size(); ++c) {
    const EffectColumn& column = effects_.columns()[c];
    double driver = drivers[static_cast<Eigen::Index>(c)];
    if (column.shape >= 0) driver *= parameters_[column.amplitude_parameter];
    auto row = rows.col(places_of_columns_[c]);
    if (column.target.kind == TargetKind::ToolOffset) {
      row.head<3>() += driver * chain_.nominal_rotation_wt(position).col(column.target.component);
    } else if (column.target.kind == TargetKind::Motion) {
      const JointLever& lever = joint_lever(levers, chain_.joint_count(), column.target.symbol.axis);
      row += driver * motion_column(lever, column.target.symbol.component);
    }
  }
}

PoseErrorRows ErrorField::condition_rows(std::span<const AxisPosition> positions,
                                         const ApproachDirection& direction) const {
  const auto count = static_cast<Eigen::Index>(condition_parameters_.size());
  PoseErrorRows rows = PoseErrorRows::Zero(6, count * static_cast<Eigen::Index>(positions.size()));
  if (condition_parameters_.empty()) return rows;
  Eigen::MatrixXd drivers;
  if (!effects_.empty()) {
    std::vector<AxisPosition> held(positions.size());
    std::ranges::transform(positions, held.begin(), [this](const auto& at) { return measured_.held(at); });
    drivers = effects_.drivers_and_slopes(held, {&direction, 1});
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto pose = static_cast<Eigen::Index>(i);
    JointLever levers[kAxisCount];
    chain_.levers(positions[i], tool_.offset, levers);
    add_expansion_rows(levers, positions[i], rows.middleCols(pose * count, count));
    if (!effects_.empty())
      add_effect_rows(levers, positions[i], drivers.row(pose), rows.middleCols(pose * count, count));
  }
  return rows;
}

PoseErrorVector ErrorField::condition_value(const AxisPosition& position,
                                            const Eigen::Ref<const PoseErrorRows>& rows) const {
  PoseErrorVector error = known_expansion(position);
  for (const Expansion& expansion : expansions_) {
    if (expansion.parameter >= 0)
      error += rows.col(place_of(expansion.parameter)) * parameters_[expansion.parameter];
  }
  std::set<int> taken;  // one amplitude may have several columns, and has one place
  for (std::size_t c = 0; c < effects_.amplitude_count(); ++c) {
    const int parameter = effects_.columns()[c].parameter;
    if (taken.insert(parameter).second) error += rows.col(places_of_columns_[c]) * parameters_[parameter];
  }
  return error;
}

PoseErrorVector ErrorField::known_expansion(const AxisPosition& position,
                                            std::optional<AxisName> only) const {
  PoseErrorVector error = PoseErrorVector::Zero();
  if (expansions_.empty()) return error;
  JointLever levers[kAxisCount];
  chain_.levers(position, tool_.offset, levers);
  for (const Expansion& expansion : expansions_) {
    if (only && *only != expansion.axis) continue;
    error += motion_column(joint_lever(levers, chain_.joint_count(), expansion.axis),
                           positioning_component(expansion.axis)) *
             (expansion.strain * (position[index_of(expansion.axis)] - expansion.home));
  }
  return error;
}

PoseErrorRows ErrorField::rows(const AxisPosition& position, const ApproachDirection& direction) const {
  return rows_at(position, measured_.held(position), direction);
}

PoseErrorRows ErrorField::unheld_rows(const AxisPosition& position,
                                      const ApproachDirection& direction) const {
  PoseErrorRows rows = rows_at(position, position, direction);
  if (const std::optional<PoseErrorRows> faded = faded_rows(position, direction)) rows += *faded;
  return rows;
}

std::optional<PoseErrorRows> ErrorField::faded_rows(const AxisPosition& position,
                                                    const ApproachDirection& direction) const {
  const AxisPosition held = measured_.held(position);
  const Eigen::MatrixXd lost = effects_.faded_drivers({&held, 1}, {&direction, 1});
  if (lost.size() == 0) return std::nullopt;
  Eigen::RowVectorXd drivers = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(effects_.columns().size()));
  drivers.head(lost.cols()) = lost.row(0);
  JointLever levers[kAxisCount];
  chain_.levers(position, tool_.offset, levers);
  PoseErrorRows of_conditions =
      PoseErrorRows::Zero(6, static_cast<Eigen::Index>(condition_parameters_.size()));
  add_effect_rows(levers, position, drivers, of_conditions);
  PoseErrorRows rows = PoseErrorRows::Zero(6, layout_.size);
  rows(Eigen::all, condition_parameters_) = of_conditions;
  return rows;
}

std::vector<FadedError> ErrorField::faded_errors(const AxisPosition& position,
                                                 const ApproachDirection& direction) const {
  const std::vector<FadedSurface> faded = effects_.faded_surfaces(measured_.held(position), direction);
  if (faded.empty()) return {};
  JointLever levers[kAxisCount];
  chain_.levers(position, tool_.offset, levers);
  std::vector<FadedError> errors;
  for (const FadedSurface& each : faded) {
    FadedError error{std::ranges::find(effects_.columns(), each.effect, &EffectColumn::effect)->parameter,
                     each.u};
    if (each.target.kind == TargetKind::ToolOffset)
      error.u.head<3>() = each.u * chain_.nominal_rotation_wt(position).col(each.target.component);
    if (each.target.kind == TargetKind::Motion)
      error.u = each.u * motion_column(joint_lever(levers, chain_.joint_count(), each.target.symbol.axis),
                                       each.target.symbol.component);
    errors.push_back(error);
  }
  return errors;
}

PoseErrorVector ErrorField::faded_variance(const AxisPosition& position,
                                           const ApproachDirection& direction) const {
  PoseErrorVector variance = PoseErrorVector::Zero();
  for (const FadedError& error : faded_errors(position, direction)) variance += error.u.cwiseAbs2();
  return variance;
}

bool ErrorField::is_beyond_readings(const AxisPosition& position, const ApproachDirection& direction) const {
  if (measured_.is_beyond(position)) return true;
  return effects_.faded_drivers({&position, 1}, {&direction, 1}).size() > 0;
}

PoseErrorRows ErrorField::rows_at(const AxisPosition& position, const AxisPosition& functions_at,
                                  const ApproachDirection& direction) const {
  PoseErrorRows rows = pose_error_rows(chain_, layout_, position, tool_.offset, functions_at);
  if (tool_parameter_ >= 0) rows.block<3, 3>(0, tool_parameter_) = chain_.nominal_rotation_wt(position);
  rows(Eigen::all, condition_parameters_) = condition_rows(position, direction);
  return rows;
}

PoseErrorVector ErrorField::contribution(const Contribution& part, const AxisPosition& position,
                                         const ApproachDirection& direction) const {
  const PoseErrorRows all = rows(position, direction);
  PoseErrorVector error = PoseErrorVector::Zero();
  for (const int parameter : part.parameters) error += all.col(parameter) * parameters_[parameter];
  if (const auto* expansion = std::get_if<ExpansionError>(&part.source))
    error += known_expansion(position, expansion->axis);
  return error;
}

std::vector<Contribution> ErrorField::contributions() const {
  std::vector<Contribution> parts;
  for (const FunctionGroup& group : layout_.groups) {
    for (int slot = 0; slot < group.count(); ++slot) {
      const ErrorSymbol symbol = group.symbols[static_cast<std::size_t>(slot)];
      Contribution part{symbol, symbol.name(), {position_of(group.axis)}, {}};
      for (int j = 0; j < group.basis->size(); ++j) part.parameters.push_back(group.index(j, slot));
      parts.push_back(std::move(part));
    }
  }
  for (const ParameterBlock& block : layout_.blocks) {
    if (!block.location) continue;
    const AxisName axis = block.location->axis;
    std::vector<Variable> lever;
    if (!is_rotary(axis)) lever.push_back(position_of(axis));
    parts.push_back({*block.location, block.name, std::move(lever), {block.offset}});
  }
  for (const Expansion& expansion : expansions_) {
    Contribution part{ExpansionError{expansion.axis},
                      expansion_parameter(expansion.axis),
                      {position_of(expansion.axis), temperature_of(expansion.channel)},
                      {}};
    if (expansion.parameter >= 0) part.parameters = {expansion.parameter};
    parts.push_back(std::move(part));
  }
  for (std::size_t e = 0; e < effects_.effect_count(); ++e) {
    Contribution part{effects_.name(e), effects_.label(e), effects_.reach(e).variables(), {}};
    for (std::size_t c = 0; c < effects_.amplitude_count(); ++c) {
      if (effects_.columns()[c].effect == e) part.parameters.push_back(effects_.columns()[c].parameter);
    }
    // One cause that acts in several places is one contribution.
    const auto same = std::ranges::find(parts, part.parameters, &Contribution::parameters);
    if (same == parts.end()) {
      parts.push_back(std::move(part));
    } else if (same->depends_on != part.depends_on) {
      same->depends_on.insert(same->depends_on.end(), part.depends_on.begin(), part.depends_on.end());
    }
  }
  if (tool_parameter_ >= 0)
    parts.push_back({ToolOffsetError{},
                     tool_parameter(tool_.name),
                     {},
                     {tool_parameter_, tool_parameter_ + 1, tool_parameter_ + 2}});
  return parts;
}

struct LinearDisplacements::Parts {
  KinematicChain chain;
  Tool tool;
  ParameterLayout layout;
  Eigen::VectorXd parameters;
  MeasuredTravel measured;
  /// Expansion of an axis' scale from its home.
  struct Strain {
    AxisName axis;
    double strain;  ///< m/m
    double home;    ///< m
  };
  std::vector<Strain> strains;
  EffectDisplacements coupled, single;          ///< single: of one axis; empty where `polynomials` hold them
  std::optional<LinearAxisErrors> polynomials;  ///< in place of the chain

  Vector3d of_effects(const EffectDisplacements& effects, const AxisPosition& position,
                      const ApproachDirection& direction) const {
    const AxisPosition linear = without_rotary_axes(position);
    return effects.at(linear, measured.held(linear), direction);
  }
};

bool is_of_own_axis(const MachineEffects& effects, std::size_t effect) {
  for (std::size_t c = 0; c < effects.amplitude_count(); ++c) {
    const EffectColumn& column = effects.columns()[c];
    if (column.effect != effect) continue;
    if (column.target.kind != TargetKind::Motion || is_rotary(column.target.symbol.axis)) return false;
    const EffectReach& reach = effects.reach(effect);
    for (const AxisName axis : kAllAxes) {
      if (axis == column.target.symbol.axis) continue;
      if (reach.position[index_of(axis)] || reach.direction[index_of(axis)]) return false;
    }
  }
  return true;
}

LinearDisplacements::LinearDisplacements(const FitResult& result, const Tool& tool,
                                         const Conditions& conditions) {
  const MachineEffects effects(result, tool, conditions);
  std::vector<std::size_t> single, coupled;
  for (std::size_t e = 0; e < effects.effect_count(); ++e)
    (is_of_own_axis(effects, e) ? single : coupled).push_back(e);
  const KinematicChain chain(result.machine);
  const MachineEffects of_own_axis = effects.subset(single);
  std::optional<LinearAxisErrors> polynomials = LinearAxisErrors::make(result, tool.offset, of_own_axis);
  const MachineEffects left = polynomials ? of_own_axis.subset(polynomials->effects_left_out()) : of_own_axis;
  auto parts = std::make_shared<Parts>(Parts{chain,
                                             tool,
                                             result.layout,
                                             result.parameters,
                                             MeasuredTravel(result),
                                             {},
                                             {result, chain, tool, effects.subset(coupled)},
                                             {result, chain, tool, left},
                                             std::move(polynomials)});
  for (const Axis& axis : result.machine.axes) {
    if (!axis.expansion || is_rotary(axis.name)) continue;
    const double excess = temperature_excess_at(conditions, axis.expansion->channel);
    double strain = axis.expansion->per_kelvin * excess;
    if (const ParameterBlock* block = result.layout.find_block(expansion_parameter(axis.name)))
      strain += result.parameters[block->offset] * excess;
    if (strain != 0.0) parts->strains.push_back({axis.name, strain, axis.home});
  }
  parts_ = std::move(parts);
}

Vector3d LinearDisplacements::rigid(const AxisPosition& position, const ApproachDirection& direction) const {
  Vector3d displacement;
  if (parts_->polynomials) {
    displacement = parts_->polynomials->at(position, direction);
  } else {
    const AxisPosition linear = without_rotary_axes(position);
    PoseErrors<double> errors =
        pose_errors(parts_->layout, parts_->measured.held(linear), parts_->parameters);
    for (const AxisName axis : {AxisName::A, AxisName::B, AxisName::C}) {
      errors.motion[index_of(axis)] = {};
      errors.location[index_of(axis)] = {};
    }
    displacement = parts_->chain.first_order(linear, parts_->tool.offset, errors).displacement_w;
  }
  for (const Parts::Strain& each : parts_->strains)
    displacement[direction_of(each.axis)] += each.strain * (position[index_of(each.axis)] - each.home);
  if (!parts_->single.empty()) displacement += parts_->of_effects(parts_->single, position, direction);
  return displacement;
}

Vector3d LinearDisplacements::at(const AxisPosition& position, const ApproachDirection& direction) const {
  return rigid(position, direction) + coupled(position, direction);
}

Vector3d LinearDisplacements::coupled(const AxisPosition& position,
                                      const ApproachDirection& direction) const {
  if (!has_coupled()) return Vector3d::Zero();
  return parts_->of_effects(parts_->coupled, position, direction);
}

std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> LinearDisplacements::coupled_units(
    std::span<const AxisPosition> positions, std::span<const ApproachDirection> directions) const {
  std::vector<AxisPosition> linear(positions.size()), held(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    linear[i] = without_rotary_axes(positions[i]);
    held[i] = parts_->measured.held(linear[i]);
  }
  return parts_->coupled.units(linear, held, directions);
}

const MachineEffects& LinearDisplacements::coupled_effects() const { return parts_->coupled.effects(); }

bool LinearDisplacements::has_coupled() const { return !parts_->coupled.empty(); }

bool LinearDisplacements::is_of_two_axes() const {
  const MachineEffects& effects = parts_->coupled.effects();
  for (const EffectColumn& column : effects.columns()) {
    if (effects.reach(column.effect).positions() > 1) return false;
  }
  return true;
}

const MeasuredTravel& LinearDisplacements::measured() const { return parts_->measured; }

DisplacementField displacement_field(const FitResult& result, const Tool& tool,
                                     const Conditions& conditions) {
  return [errors = LinearDisplacements(result, tool, conditions)](const AxisPosition& position,
                                                                  const ApproachDirection& direction) {
    return errors.at(position, direction);
  };
}

}  // namespace volcal
