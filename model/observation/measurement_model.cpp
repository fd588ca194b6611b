#include "volcal/model/observation/measurement_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "volcal/model/description/errors.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr double kReferenceTemperature_degC = 20.0;
constexpr double kDisagreeingPriors = 5.0;  // in standard uncertainties of the difference

ParameterBlock scalar_block(ParameterKind kind, std::string name, std::string unit, double si_per_unit) {
  ParameterBlock block;
  block.kind = kind;
  block.name = std::move(name);
  block.labels = {""};
  block.units = {std::move(unit)};
  block.si_per_unit = {si_per_unit};
  block.guess = Eigen::VectorXd::Zero(1);
  block.prior_mean = Eigen::VectorXd::Zero(1);
  block.prior_sigma = Eigen::VectorXd::Zero(1);
  return block;
}

/// Unit for printing a nuisance parameter: places in mm, small lengths and angles in um and urad.
void set_nuisance_units(ParameterBlock& block, const NuisanceBlock& nuisance) {
  const bool is_scale = block.name.starts_with("length scale");
  for (int k = 0; k < nuisance.size(); ++k) {
    const bool angle = nuisance.is_angle[static_cast<std::size_t>(k)];
    block.units.push_back(is_scale ? "ppm" : angle ? "urad" : "mm");
    block.si_per_unit.push_back(angle ? 1e-6 : 1e-3);
  }
}

}  // namespace

std::vector<int> touched_parameters(const ParameterLayout& layout, const RowJacobian& row) {
  std::vector<int> touched = row.tail_index;
  for (std::size_t g = 0; g < layout.groups.size(); ++g) {
    const FunctionGroup& group = layout.groups[g];
    const int size = group.basis->support() * group.count();
    for (int k = 0; k < size; ++k) touched.push_back(group.index(row.start[g], 0) + k);
  }
  return touched;
}

Eigen::VectorXd dense_row(const ParameterLayout& layout, const RowJacobian& row, int channel) {
  Eigen::VectorXd dense = Eigen::VectorXd::Zero(layout.size);
  const double* basis = row.basis_value.data();
  const double* weight = row.weight[channel].data();
  for (std::size_t g = 0; g < layout.groups.size(); ++g) {
    const FunctionGroup& group = layout.groups[g];
    for (int j = 0; j < group.basis->support(); ++j) {
      for (int slot = 0; slot < group.count(); ++slot) {
        dense[group.index(row.start[g] + j, slot)] = basis[j] * weight[slot];
      }
    }
    basis += group.basis->support();
    weight += group.count();
  }
  for (std::size_t t = 0; t < row.tail_index.size(); ++t)
    dense[row.tail_index[t]] += row.tail_value[channel][t];
  return dense;
}

struct MeasurementModel::EffectPlace {
  const BoundEffect* effect;
  int offset;  ///< of its amplitudes in the parameter vector
};

struct MeasurementModel::SetupPlace {
  std::vector<int> nuisance;  ///< global index of every parameter of the setup's concatenated blocks
  int tool_error = -1;        ///< global index of the tool's offset error, -1 = exact
  Eigen::Vector3d tool_offset;
  struct Expansion {
    AxisName axis;
    double per_kelvin;
    int parameter;  ///< correction of the coefficient, -1 = exact
    const std::vector<double>* temperature;
  };
  std::vector<Expansion> expansions;
};

MeasurementModel::~MeasurementModel() = default;

MeasurementModel::MeasurementModel(const Campaign& campaign, const ModelSpec& spec)
    : campaign_(campaign), spec_(spec), chain_(campaign.machine) {
  build_layout();
}

AxisPosition MeasurementModel::position(const Readings& readings, std::size_t row) const {
  AxisPosition position{};
  for (const Axis& axis : campaign_.machine.axes) {
    position[index_of(axis.name)] = readings.position[index_of(axis.name)][row];
  }
  return position;
}

void MeasurementModel::add_block(ParameterBlock block) {
  block.offset = layout_.size;
  layout_.size += block.size();
  layout_.blocks.push_back(std::move(block));
}

namespace {

/// Groups the functions of an axis that have the same basis.
void add_function_groups(const Machine& machine, const ModelSpec& spec, ParameterLayout& layout) {
  using Key = std::tuple<std::string, int, std::vector<double>>;
  for (const Axis& axis : machine.axes) {
    std::map<Key, std::size_t> group_of;
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      if (is_rotary(axis.name) && !spec.functions.contains(symbol)) continue;
      const FunctionSpec& function = spec.function(symbol);
      const BasisKind* kind = find_basis(function.basis);
      if (kind == nullptr) throw std::invalid_argument("unknown basis " + function.basis);
      std::shared_ptr<const Basis> basis = kind->make(function, axis);
      if (basis->size() == 0) continue;
      const auto [place, is_new] =
          group_of.try_emplace({function.basis, function.degree, function.breakpoints}, layout.groups.size());
      if (is_new) layout.groups.push_back({axis.name, std::move(basis), {}, 0});
      layout.groups[place->second].symbols.push_back(symbol);
    }
  }
  for (FunctionGroup& group : layout.groups) {
    group.offset = layout.size;
    layout.size += group.size();
  }
  layout.function_size = layout.size;
}

std::vector<LocationSymbol> active_locations(const Machine& machine, const ModelSpec& spec) {
  std::vector<LocationSymbol> active;
  for (const LocationSymbol& symbol : machine.datum.squareness()) {
    const bool off = std::ranges::find(spec.locations_off, symbol) != spec.locations_off.end();
    if (!off && machine.has_axis(symbol.axis)) active.push_back(symbol);
  }
  for (const auto& [symbol, value] : spec.locations) {
    if (is_rotary(symbol.axis) && machine.has_axis(symbol.axis)) active.push_back(symbol);
  }
  return active;
}

/// Joins a setup's nuisance block to an existing one of the same name: guesses averaged, priors multiplied.
void merge_nuisance(ParameterBlock& block, const NuisanceBlock& other, int& merged,
                    const SourcePlace& place) {
  for (int k = 0; k < block.size(); ++k) {
    double& sigma = block.prior_sigma[k];
    const double other_sigma = other.prior_sigma[k];
    if (sigma > 0.0 && other_sigma > 0.0) {
      const double apart =
          std::abs(block.prior_mean[k] - other.prior_mean[k]) / std::hypot(sigma, other_sigma);
      if (apart > kDisagreeingPriors) {
        throw InputError(place,
                         block.name + ": the setups that share it state priors " + std::to_string(apart) +
                             " standard uncertainties apart",
                         "correct the positions or their sigma, or give the stations different names");
      }
      if (block.name.starts_with("length scale"))
        continue;  // one and the same statement, made in every setup
      const double weight = 1.0 / (sigma * sigma), other_weight = 1.0 / (other_sigma * other_sigma);
      block.prior_mean[k] =
          (weight * block.prior_mean[k] + other_weight * other.prior_mean[k]) / (weight + other_weight);
      sigma = 1.0 / std::sqrt(weight + other_weight);
      block.guess[k] = block.prior_mean[k];
    } else if (other_sigma > 0.0) {
      block.prior_mean[k] = block.guess[k] = other.prior_mean[k];
      sigma = other_sigma;
    } else if (sigma == 0.0) {
      block.guess[k] = (block.guess[k] * merged + other.guess[k]) / (merged + 1);
      block.prior_mean[k] = block.guess[k];
    }
  }
  ++merged;
}

}  // namespace

void MeasurementModel::build_layout() {
  const Machine& machine = campaign_.machine;
  add_function_groups(machine, spec_, layout_);
  for (const LocationSymbol& symbol : active_locations(machine, spec_)) {
    const bool angle = is_rotation(symbol.component);
    ParameterBlock block = scalar_block(ParameterKind::Location, symbol.name(), angle ? "urad" : "um", 1e-6);
    block.location = symbol;
    add_block(std::move(block));
  }
  for (const EffectSpec& effect_spec : spec_.effects) {
    const EffectKind* kind = find_effect(effect_spec.kind);
    if (kind == nullptr) {
      throw InputError({spec_.file, effect_spec.source_line}, "unknown effect \"" + effect_spec.kind + "\"",
                       "");
    }
    effects_.push_back(kind->bind(effect_spec, spec_.file, machine));
    effect_places_.push_back({effects_.back().get(), layout_.size});
    for (const EffectAmplitude& amplitude : effects_.back()->amplitudes()) {
      if (layout_.find_block(amplitude.label) != nullptr) {
        throw InputError({spec_.file, effect_spec.source_line},
                         "effect \"" + amplitude.label + "\" is given twice", "delete one of the two");
      }
      ParameterBlock block =
          scalar_block(ParameterKind::Effect, amplitude.label, amplitude.unit, amplitude.si_per_unit);
      block.guess[0] = amplitude.guess;
      block.prior_mean[0] = amplitude.prior_mean;
      block.prior_sigma[0] = amplitude.prior_sigma;
      add_block(std::move(block));
    }
  }
  std::map<AxisName, int> expansion_parameter;
  for (const Axis& axis : machine.axes) {
    if (!axis.expansion) continue;
    expansion_parameter[axis.name] = -1;
    if (axis.expansion->per_kelvin_sigma == 0.0) continue;
    expansion_parameter[axis.name] = layout_.size;
    ParameterBlock block = scalar_block(ParameterKind::Expansion,
                                        std::string("expansion ") + letter_of(axis.name), "um/m/K", 1e-6);
    block.prior_sigma[0] = axis.expansion->per_kelvin_sigma;
    add_block(std::move(block));
  }
  std::map<std::size_t, int> tool_parameter;
  for (const Setup& setup : campaign_.setups) {
    const Tool& tool = machine.tools[setup.tool];
    if (tool.offset_sigma == 0.0 || tool_parameter.contains(setup.tool)) continue;
    tool_parameter[setup.tool] = layout_.size;
    ParameterBlock block;
    block.kind = ParameterKind::ToolOffset;
    block.name = "tool " + tool.name;
    block.labels = {"x", "y", "z"};
    block.units = {"um", "um", "um"};
    block.si_per_unit = {1e-6, 1e-6, 1e-6};
    block.guess = block.prior_mean = Eigen::VectorXd::Zero(3);
    block.prior_sigma = Eigen::VectorXd::Constant(3, tool.offset_sigma);
    add_block(std::move(block));
  }

  std::map<std::string, std::pair<std::size_t, int>>
      block_of;  // name -> index in layout_.blocks, setups merged
  for (const Setup& setup : campaign_.setups) {
    SetupPlace place;
    place.tool_offset = machine.tools[setup.tool].offset;
    if (tool_parameter.contains(setup.tool)) place.tool_error = tool_parameter.at(setup.tool);
    for (const Axis& axis : machine.axes) {
      if (!axis.expansion) continue;
      const auto channel = setup.readings.temperature.find(axis.expansion->channel);
      if (channel == setup.readings.temperature.end()) {
        throw InputError({setup.data, 1},
                         "column T_" + axis.expansion->channel +
                             "_degC is missing, but the expansion of axis " + letter_of(axis.name) +
                             " needs it",
                         "add the column or delete the axis's temperature from the machine file");
      }
      place.expansions.push_back(
          {axis.name, axis.expansion->per_kelvin, expansion_parameter.at(axis.name), &channel->second});
    }
    const Instrument* instrument = find_instrument(setup.instrument);
    if (instrument == nullptr) {
      throw InputError({campaign_.file, setup.source_line}, "unknown instrument \"" + setup.instrument + "\"",
                       "");
    }
    SetupContext context{setup, machine, campaign_.file, {}};
    context.nominal_point_w.reserve(setup.readings.size());
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      context.nominal_point_w.push_back(
          chain_.nominal_point_w(position(setup.readings, row), place.tool_offset));
    }
    bound_.push_back(instrument->bind(std::move(context)));
    for (const NuisanceBlock& nuisance : bound_.back()->nuisance()) {
      const auto [found, is_new] = block_of.try_emplace(nuisance.name, layout_.blocks.size(), 1);
      if (is_new) {
        ParameterBlock block;
        block.kind = ParameterKind::Nuisance;
        block.name = nuisance.name;
        block.labels = nuisance.labels;
        set_nuisance_units(block, nuisance);
        block.guess = nuisance.guess;
        block.prior_mean = nuisance.prior_mean;
        block.prior_sigma = nuisance.prior_sigma;
        block.weak_default_prior = nuisance.weak_default_prior;
        add_block(std::move(block));
      } else {
        merge_nuisance(layout_.blocks[found->second.first], nuisance, found->second.second,
                       {campaign_.file, setup.source_line});
      }
      const ParameterBlock& block = layout_.blocks[found->second.first];
      for (int k = 0; k < block.size(); ++k) place.nuisance.push_back(block.offset + k);
    }
    setup_places_.push_back(std::move(place));
  }
}

Eigen::VectorXd MeasurementModel::initial_parameters() const {
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(layout_.size);
  for (const FunctionGroup& group : layout_.groups) {
    for (int slot = 0; slot < group.count(); ++slot) {
      const FunctionSpec& function = spec_.function(group.symbols[static_cast<std::size_t>(slot)]);
      if (function.coefficients.empty()) continue;
      if (static_cast<int>(function.coefficients.size()) != group.basis->size()) {
        throw InputError({spec_.file, 0},
                         group.symbols[static_cast<std::size_t>(slot)].name() + ": " +
                             std::to_string(function.coefficients.size()) + " coefficients for " +
                             std::to_string(group.basis->size()) + " basis functions",
                         "knots and coefficients must come from the same identification");
      }
      for (int j = 0; j < group.basis->size(); ++j) {
        parameters[group.index(j, slot)] = function.coefficients[static_cast<std::size_t>(j)];
      }
    }
  }
  for (const ParameterBlock& block : layout_.blocks) {
    parameters.segment(block.offset, block.size()) = block.guess;
    if (!block.location) continue;
    const auto known = spec_.locations.find(*block.location);
    if (known != spec_.locations.end()) parameters[block.offset] = known->second;
  }
  return parameters;
}

PoseErrors<double> MeasurementModel::errors_at(const AxisPosition& position,
                                               const Eigen::VectorXd& parameters) const {
  PoseErrors<double> errors;
  double values[kMaxSupport];
  for (const FunctionGroup& group : layout_.groups) {
    const int start = group.basis->evaluate(position[index_of(group.axis)], values);
    for (int slot = 0; slot < group.count(); ++slot) {
      double sum = 0.0;
      for (int j = 0; j < group.basis->support(); ++j)
        sum += values[j] * parameters[group.index(start + j, slot)];
      const ErrorSymbol symbol = group.symbols[static_cast<std::size_t>(slot)];
      errors.motion[index_of(symbol.axis)][index_of(symbol.component)] = sum;
    }
  }
  for (const ParameterBlock& block : layout_.blocks) {
    if (!block.location) continue;
    errors.location[index_of(block.location->axis)][index_of(block.location->component)] =
        parameters[block.offset];
  }
  return errors;
}

namespace {

constexpr int kMaxAmplitudes = 64;

/// Everything about one reading that does not depend on the channel.
struct RowState {
  AxisPosition position{};
  JointLever levers[kAxisCount];
  Eigen::Vector3d nominal_w;
  Eigen::Matrix3d rotation_wt;
  ToolState<double> state;
};

const JointLever& lever_of(const JointLever* levers, std::size_t count, AxisName axis) {
  for (std::size_t i = 0; i < count; ++i) {
    if (levers[i].axis == axis) return levers[i];
  }
  throw std::logic_error("axis is not a joint of the chain");
}

/// Adds motion errors of one joint to the tool's state.
void add_motion(const JointLever& lever, const Eigen::Vector3d& shift_s, const Eigen::Vector3d& turn_s,
                ToolState<double>& state) {
  state.point_w += lever.rotation_ws * (shift_s + turn_s.cross(lever.arm_s));
  (lever.workpiece_side ? state.rotation_workpiece_side : state.rotation_tool_side) +=
      lever.rotation_ws * turn_s;
}

void add_motion(const JointLever& lever, Component component, double value, ToolState<double>& state) {
  const Eigen::Vector3d unit = Eigen::Vector3d::Unit(direction_of(component)) * value;
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  add_motion(lever, is_rotation(component) ? zero : unit, is_rotation(component) ? unit : zero, state);
}

/// Sensitivity of a reading to one error motion component of a lever's axis.
double motion_weight(const JointLever& lever, Component component, const Eigen::Vector3d& point_s,
                     const Eigen::Vector3d& turn_s) {
  const int k = direction_of(component);
  return is_rotation(component) ? lever.arm_s.cross(point_s)[k] + turn_s[k] : point_s[k];
}

void add_functions(const ParameterLayout& layout, const RowState& row, std::size_t joints,
                   const Eigen::VectorXd& parameters, ToolState<double>& state) {
  double values[kMaxSupport];
  for (const FunctionGroup& group : layout.groups) {
    const int start = group.basis->evaluate(row.position[index_of(group.axis)], values);
    const int support = group.basis->support();
    Eigen::Matrix<double, 6, 1> motion = Eigen::Matrix<double, 6, 1>::Zero();
    for (int slot = 0; slot < group.count(); ++slot) {
      double sum = 0.0;
      for (int j = 0; j < support; ++j) sum += values[j] * parameters[group.index(start + j, slot)];
      motion[static_cast<Eigen::Index>(index_of(group.symbols[static_cast<std::size_t>(slot)].component))] =
          sum;
    }
    add_motion(lever_of(row.levers, joints, group.axis), motion.head<3>(), motion.tail<3>(), state);
  }
}

void add_locations(const ParameterLayout& layout, const RowState& row, std::size_t joints,
                   const Eigen::VectorXd& parameters, ToolState<double>& state) {
  for (const ParameterBlock& block : layout.blocks) {
    if (!block.location) continue;
    const JointLever& lever = lever_of(row.levers, joints, block.location->axis);
    const double value = parameters[block.offset];
    state.point_w += value * KinematicChain::location_lever_w(lever, block.location->component);
    (lever.workpiece_side ? state.rotation_workpiece_side : state.rotation_tool_side) +=
        value * KinematicChain::location_rotation_w(lever, block.location->component);
  }
}

}  // namespace

void MeasurementModel::predict(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                               double* predicted) const {
  RowJacobian out;
  linearize(setup, row, parameters, out);
  std::copy_n(out.predicted, out.channels, predicted);
}

void MeasurementModel::linearize(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                                 RowJacobian& out) const {
  const Setup& source = campaign_.setups[setup];
  const SetupPlace& place = setup_places_[setup];
  const std::size_t joints = chain_.joint_count();
  RowState r;
  r.position = position(source.readings, row);
  r.nominal_w = chain_.levers(r.position, place.tool_offset, r.levers);
  r.state.point_w = r.nominal_w;
  if (!remainder_w_.empty()) r.state.point_w += remainder_w_[setup][row];
  add_functions(layout_, r, joints, parameters, r.state);
  add_locations(layout_, r, joints, parameters, r.state);

  double driver[kMaxAmplitudes];
  for (const EffectPlace& effect : effect_places_) {
    effect.effect->drivers(source, row, driver);
    const auto& amplitudes = effect.effect->amplitudes();
    for (std::size_t k = 0; k < amplitudes.size(); ++k) {
      add_motion(lever_of(r.levers, joints, amplitudes[k].target.axis), amplitudes[k].target.component,
                 driver[k] * parameters[effect.offset + static_cast<int>(k)], r.state);
    }
  }
  for (const auto& expansion : place.expansions) {
    const double warmed =
        ((*expansion.temperature)[row] - kReferenceTemperature_degC) * r.position[index_of(expansion.axis)];
    const double per_kelvin =
        expansion.per_kelvin + (expansion.parameter < 0 ? 0.0 : parameters[expansion.parameter]);
    add_motion(lever_of(r.levers, joints, expansion.axis), kAllComponents[index_of(expansion.axis)],
               per_kelvin * warmed, r.state);
  }
  if (place.tool_error >= 0) {
    r.rotation_wt = chain_.nominal_rotation_wt(r.position);
    r.state.point_w += r.rotation_wt * parameters.segment<3>(place.tool_error);
  }

  const BoundSetup& bound = *bound_[setup];
  const int local_size = bound.local_nuisance_size();
  int local_index[kMaxLocalNuisance];
  double nuisance[kMaxLocalNuisance];
  bound.local_nuisance(row, local_index);
  for (int k = 0; k < local_size; ++k) {
    local_index[k] = place.nuisance[static_cast<std::size_t>(local_index[k])];
    nuisance[k] = parameters[local_index[k]];
  }
  Linearization lin;
  bound.linearize(row, r.state, nuisance, lin);

  out.channels = bound.channels();
  out.start.resize(layout_.groups.size());
  out.basis_value.clear();
  double values[kMaxSupport];
  for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
    const FunctionGroup& group = layout_.groups[g];
    out.start[g] = group.basis->evaluate(r.position[index_of(group.axis)], values);
    out.basis_value.insert(out.basis_value.end(), values, values + group.basis->support());
  }
  out.tail_index.clear();
  for (int channel = 0; channel < out.channels; ++channel) {
    out.predicted[channel] = lin.predicted[channel];
    const Eigen::Map<const Eigen::Vector3d> d_point(lin.d_state[channel]);
    const Eigen::Map<const Eigen::Vector3d> d_tool(lin.d_state[channel] + 3);
    const Eigen::Map<const Eigen::Vector3d> d_workpiece(lin.d_state[channel] + 6);
    Eigen::Vector3d point_s[kAxisCount];
    Eigen::Vector3d turn_s[kAxisCount];
    for (std::size_t i = 0; i < joints; ++i) {
      const JointLever& lever = r.levers[i];
      point_s[i] = lever.rotation_ws.transpose() * d_point;
      turn_s[i] = lever.rotation_ws.transpose() * (lever.workpiece_side ? d_workpiece : d_tool);
    }
    const auto joint_of = [&](AxisName axis) {
      return static_cast<std::size_t>(&lever_of(r.levers, joints, axis) - r.levers);
    };
    std::vector<double>& weight = out.weight[channel];
    weight.clear();
    for (const FunctionGroup& group : layout_.groups) {
      const std::size_t i = joint_of(group.axis);
      for (const ErrorSymbol& symbol : group.symbols) {
        weight.push_back(motion_weight(r.levers[i], symbol.component, point_s[i], turn_s[i]));
      }
    }
    std::vector<double>& tail = out.tail_value[channel];
    tail.clear();
    const auto add_tail = [&](int index, double value) {
      if (channel == 0) out.tail_index.push_back(index);
      tail.push_back(value);
    };
    for (const ParameterBlock& block : layout_.blocks) {
      if (!block.location) continue;
      const JointLever& lever = r.levers[joint_of(block.location->axis)];
      add_tail(block.offset,
               d_point.dot(KinematicChain::location_lever_w(lever, block.location->component)) +
                   (lever.workpiece_side ? d_workpiece : d_tool)
                       .dot(KinematicChain::location_rotation_w(lever, block.location->component)));
    }
    for (const EffectPlace& effect : effect_places_) {
      effect.effect->drivers(source, row, driver);
      const auto& amplitudes = effect.effect->amplitudes();
      for (std::size_t k = 0; k < amplitudes.size(); ++k) {
        const std::size_t i = joint_of(amplitudes[k].target.axis);
        add_tail(
            effect.offset + static_cast<int>(k),
            driver[k] * motion_weight(r.levers[i], amplitudes[k].target.component, point_s[i], turn_s[i]));
      }
    }
    for (const auto& expansion : place.expansions) {
      if (expansion.parameter < 0) continue;
      const double warmed =
          ((*expansion.temperature)[row] - kReferenceTemperature_degC) * r.position[index_of(expansion.axis)];
      add_tail(expansion.parameter, warmed * point_s[joint_of(expansion.axis)][direction_of(expansion.axis)]);
    }
    if (place.tool_error >= 0) {
      const Eigen::Vector3d d_offset = r.rotation_wt.transpose() * d_point;
      for (int k = 0; k < 3; ++k) add_tail(place.tool_error + k, d_offset[k]);
    }
    for (int k = 0; k < local_size; ++k) add_tail(local_index[k], lin.d_nuisance[channel][k]);
  }
}

void MeasurementModel::set_second_order_remainder(const Eigen::VectorXd& parameters) {
  remainder_w_.assign(campaign_.setups.size(), {});
  double driver[kMaxAmplitudes];
  for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
    const Setup& source = campaign_.setups[setup];
    const SetupPlace& place = setup_places_[setup];
    remainder_w_[setup].resize(source.readings.size());
    for (std::size_t row = 0; row < source.readings.size(); ++row) {
      const AxisPosition q = position(source.readings, row);
      PoseErrors<double> errors = errors_at(q, parameters);
      for (const EffectPlace& effect : effect_places_) {
        effect.effect->drivers(source, row, driver);
        const auto& amplitudes = effect.effect->amplitudes();
        for (std::size_t k = 0; k < amplitudes.size(); ++k) {
          const ErrorSymbol target = amplitudes[k].target;
          errors.motion[index_of(target.axis)][index_of(target.component)] +=
              driver[k] * parameters[effect.offset + static_cast<int>(k)];
        }
      }
      for (const auto& expansion : place.expansions) {
        const std::size_t axis = index_of(expansion.axis);
        const double per_kelvin =
            expansion.per_kelvin + (expansion.parameter < 0 ? 0.0 : parameters[expansion.parameter]);
        errors.motion[axis][axis] +=
            per_kelvin * ((*expansion.temperature)[row] - kReferenceTemperature_degC) * q[axis];
      }
      const ToolTwist twist = chain_.first_order(q, place.tool_offset, errors);
      const Eigen::Vector3d first_order = chain_.nominal_point_w(q, place.tool_offset) + twist.displacement_w;
      remainder_w_[setup][row] =
          chain_.exact_pose<double>(q, place.tool_offset, errors).point_w - first_order;
    }
  }
}

double MeasurementModel::sigma(std::size_t setup, std::size_t row, int channel,
                               const Eigen::VectorXd& parameters) const {
  const Setup& source = campaign_.setups[setup];
  const BoundSetup& bound = *bound_[setup];
  double variance = 0.0;
  if (!source.readings.sigma.empty()) {
    variance = source.readings.sigma[row] * source.readings.sigma[row];
  } else {
    const double constant = bound.noise_constant(source.noise, channel);
    const double per_metre =
        source.noise.number("per_metre").value_or(0.0) * bound.noise_length(row, channel);
    variance = constant * constant + per_metre * per_metre;
  }
  if (source.repeatability > 0.0) {
    const SetupPlace& place = setup_places_[setup];
    ToolState<double> state;
    state.point_w = chain_.nominal_point_w(position(source.readings, row), place.tool_offset);
    int index[kMaxLocalNuisance];
    double nuisance[kMaxLocalNuisance];
    bound.local_nuisance(row, index);
    for (int k = 0; k < bound.local_nuisance_size(); ++k) {
      nuisance[k] = parameters[place.nuisance[static_cast<std::size_t>(index[k])]];
    }
    Linearization lin;
    bound.linearize(row, state, nuisance, lin);
    const double along = Eigen::Map<const Eigen::Vector3d>(lin.d_state[channel]).norm();
    variance += source.repeatability * source.repeatability * along * along;
  }
  return std::sqrt(variance);
}

Eigen::Matrix<double, 6, Eigen::Dynamic> pose_error_rows(const KinematicChain& chain,
                                                         const ParameterLayout& layout,
                                                         const AxisPosition& position,
                                                         const Eigen::Vector3d& tool_offset) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, layout.size);
  JointLever levers[kAxisCount];
  chain.levers(position, tool_offset, levers);
  double values[kMaxSupport];
  for (const FunctionGroup& group : layout.groups) {
    const JointLever& lever = lever_of(levers, chain.joint_count(), group.axis);
    const int start = group.basis->evaluate(position[index_of(group.axis)], values);
    for (int slot = 0; slot < group.count(); ++slot) {
      const Component component = group.symbols[static_cast<std::size_t>(slot)].component;
      Eigen::Matrix<double, 6, 1> column;
      column.head<3>() = KinematicChain::motion_lever_w(lever, component);
      column.tail<3>().setZero();
      if (is_rotation(component)) column.tail<3>() = lever.rotation_ws.col(direction_of(component));
      for (int j = 0; j < group.basis->support(); ++j)
        rows.col(group.index(start + j, slot)) = values[j] * column;
    }
  }
  for (const ParameterBlock& block : layout.blocks) {
    if (!block.location) continue;
    const JointLever& lever = lever_of(levers, chain.joint_count(), block.location->axis);
    rows.col(block.offset).head<3>() = KinematicChain::location_lever_w(lever, block.location->component);
    rows.col(block.offset).tail<3>() = KinematicChain::location_rotation_w(lever, block.location->component);
  }
  return rows;
}

}  // namespace volcal
