#include "volcal/model/observation/measurement_model.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "volcal/model/description/errors.h"

namespace volcal {

MeasurementModel::MeasurementModel(const Campaign& campaign, ModelSpec spec)
    : campaign_(campaign),
      spec_(std::move(spec)),
      chain_(campaign.machine),
      binding_(bind_campaign(campaign_, spec_, chain_)),
      tables_(campaign_, binding_.layout, spec_) {
  const std::size_t terms = binding_.shared_terms.size() + static_cast<std::size_t>(binding_.effect_drivers);
  if (terms > kMaxSharedTerms) {
    throw InputError({spec_.file, 0},
                     "the model has " + std::to_string(terms) + " location errors and effects, more than " +
                         std::to_string(kMaxSharedTerms),
                     "leave effects out");
  }
  for (const FunctionGroup& group : layout().groups) {
    group_support_.push_back(group.basis->support());
    value_count_ += static_cast<std::size_t>(group.basis->support());
  }
  for (const GroupBinding& group : binding_.groups) {
    for (const int component : group.component) slot_motion_.push_back(6 * group.joint + component);
  }
  for (const auto& [axis, stated] : spec_.measured)
    measured_[axis] = measured_ends(campaign_.machine.axis(axis), spec_);
  bool turns = false;
  for (const Joint& joint : campaign.machine.structure.joints) {
    joint_turns_.push_back(turns || (is_rotary(joint.axis) && joint.workpiece_side) ? 1 : 0);
    turns = turns || is_rotary(joint.axis);
  }
}

Eigen::VectorXd MeasurementModel::initial_parameters() const {
  Eigen::VectorXd parameters = Eigen::VectorXd::Zero(layout().size);
  for (const FunctionGroup& group : layout().groups) {
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
  for (const ParameterBlock& block : layout().blocks) {
    parameters.segment(block.offset, block.size()) = block.guess;
    if (!block.location) continue;
    const auto known = spec_.locations.find(*block.location);
    if (known != spec_.locations.end()) parameters[block.offset] = known->second;
  }
  return parameters;
}

PoseErrors<double> MeasurementModel::errors_at(const AxisPosition& position,
                                               const Eigen::VectorXd& parameters) const {
  AxisPosition held = position;
  for (const auto& [axis, ends] : measured_) held[index_of(axis)] = ends.nearest(position[index_of(axis)]);
  return pose_errors(layout(), held, parameters);
}

PoseErrors<double> MeasurementModel::errors_at_reading(std::size_t setup, std::size_t row,
                                                       const AxisPosition& position,
                                                       const Eigen::VectorXd& parameters) const {
  PoseErrors<double> errors = errors_at(position, parameters);
  const auto add = [&](const MotionTerm& term, double value) {
    const AxisName axis = campaign_.machine.structure.joints[static_cast<std::size_t>(term.joint)].axis;
    errors.motion[index_of(axis)][static_cast<std::size_t>(term.component)] += value;
  };
  for (const EffectBinding& effect : binding_.effects) {
    for (int k = 0; k < effect.term_count(); ++k) {
      const int target = effect.target[static_cast<std::size_t>(k)];
      if (target >= kToolDisturbance) continue;
      const double driver = effect.driver[setup](static_cast<Eigen::Index>(row), k);
      add({target / 6, target % 6, -1},
          driver * parameters[effect.first_parameter + effect.amplitude[static_cast<std::size_t>(k)]]);
    }
  }
  for (const ExpansionBinding& expansion : binding_.setups[setup].expansions) {
    add(expansion.term, expansion.coefficient(parameters) * expansion.warmed(row, position));
  }
  return errors;
}

void MeasurementModel::set_second_order_remainder(const Eigen::VectorXd& parameters) {
  remainder_w_.assign(campaign_.setups.size(), {});
  for (std::size_t setup = 0; setup < campaign_.setups.size(); ++setup) {
    const Setup& source = campaign_.setups[setup];
    const SetupBinding& place = binding_.setups[setup];
    remainder_w_[setup].resize(source.readings.size());
    for (std::size_t row = 0; row < source.readings.size(); ++row) {
      const AxisPosition position = source.readings.commanded_position(row);
      const PoseErrors<double> errors = errors_at_reading(setup, row, position, parameters);
      const ToolTwist twist = chain_.first_order(position, place.tool_offset, errors);
      const Eigen::Vector3d first_order_w =
          chain_.nominal_point_w(position, place.tool_offset) + twist.displacement_w;
      remainder_w_[setup][row] =
          chain_.exact_pose<double>(position, place.tool_offset, errors).point_w - first_order_w;
    }
  }
}

namespace {

bool has_free_shape(const EffectBinding& effect) { return !effect.free_shape.empty(); }

/// From where an effect is expanded to `parameters`.
Eigen::VectorXd shape_step(const EffectBinding& effect, const Eigen::VectorXd& parameters) {
  Eigen::VectorXd step = Eigen::VectorXd::Zero(effect.shape.size());
  for (std::size_t i = 0; i < effect.free_shape.size(); ++i)
    step[effect.free_shape[i]] = parameters[effect.shape_parameter(i)] - effect.shape[effect.free_shape[i]];
  return step;
}

/// Whether the drivers a step further differ from their expansion by less than they are. Those that are not
/// finite do not.
bool follows_at(const std::vector<SetupView>& views, const EffectBinding& effect,
                const Eigen::VectorXd& step) {
  double off = 0.0, before = 0.0, expanded = 0.0;
  for (std::size_t setup = 0; setup < views.size(); ++setup) {
    EffectBinding::Table linear = effect.driver[setup];
    for (std::size_t i = 0; i < effect.free_shape.size(); ++i)
      linear += step[effect.free_shape[i]] * effect.slope[i][setup];
    const EffectBinding::Table exact = effect.effect->drivers(views[setup], effect.shape + step);
    off += (exact - linear).squaredNorm();
    before += effect.driver[setup].squaredNorm();
    expanded += linear.squaredNorm();
  }
  return off <= std::max(before, expanded);
}

bool follows(const std::vector<SetupView>& views, const EffectBinding& effect, const Eigen::VectorXd& step) {
  constexpr int kPlaces = 4;  // on the way: a pole in between is not stepped over
  if (step.isZero(0.0)) return true;
  try {
    for (int place = kPlaces; place > 0; --place) {
      if (!follows_at(views, effect, step * (static_cast<double>(place) / kPlaces))) return false;
    }
  } catch (const InputError&) {  // an expression that is not finite there
    return false;
  }
  return true;
}

}  // namespace

void MeasurementModel::expand_effects(const Eigen::VectorXd& parameters) {
  if (std::ranges::none_of(binding_.effects, has_free_shape)) return;
  const std::vector<SetupView> views = setup_views(campaign_, binding_, chain_);
  for (EffectBinding& effect : binding_.effects) {
    if (!has_free_shape(effect)) continue;
    for (std::size_t i = 0; i < effect.free_shape.size(); ++i) {
      effect.shape[effect.free_shape[i]] = parameters[effect.shape_parameter(i)];
    }
    tabulate_drivers(views, effect);
  }
}

bool MeasurementModel::follow_expansion(const Eigen::VectorXd& parameters) const {
  if (std::ranges::none_of(binding_.effects, has_free_shape)) return true;
  const std::vector<SetupView> views = setup_views(campaign_, binding_, chain_);
  return std::ranges::all_of(binding_.effects, [&](const EffectBinding& effect) {
    return !has_free_shape(effect) || follows(views, effect, shape_step(effect, parameters));
  });
}

void MeasurementModel::approach_effects(Eigen::VectorXd& parameters) {
  constexpr int kHalvings = 20;
  if (std::ranges::none_of(binding_.effects, has_free_shape)) return;
  const std::vector<SetupView> views = setup_views(campaign_, binding_, chain_);
  for (const EffectBinding& effect : binding_.effects) {
    if (!has_free_shape(effect)) continue;
    Eigen::VectorXd step = shape_step(effect, parameters);
    int halvings = 0;
    while (!follows(views, effect, step)) step *= ++halvings < kHalvings ? 0.5 : 0.0;
    if (halvings == 0) continue;
    for (std::size_t i = 0; i < effect.free_shape.size(); ++i) {
      const int index = effect.free_shape[i];
      parameters[effect.shape_parameter(i)] = effect.shape[index] + step[index];
    }
  }
  expand_effects(parameters);
}

void MeasurementModel::local_nuisance(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                                      double* nuisance) const {
  const SetupBinding& place = binding_.setups[setup];
  int index[kMaxLocalNuisance];
  place.bound->local_nuisance(row, index);
  for (int k = 0; k < place.bound->local_nuisance_size(); ++k)
    nuisance[k] = parameters[place.nuisance[static_cast<std::size_t>(index[k])]];
}

double MeasurementModel::noise_length(std::size_t setup, std::size_t row, int channel,
                                      const Eigen::VectorXd& parameters) const {
  double nuisance[kMaxLocalNuisance];
  local_nuisance(setup, row, parameters, nuisance);
  return binding_.setups[setup].bound->noise_length_at(row, channel, nuisance);
}

double MeasurementModel::sigma(std::size_t setup, std::size_t row, int channel,
                               const Eigen::VectorXd& parameters, bool estimated) const {
  const Setup& source = campaign_.setups[setup];
  const SetupBinding& place = binding_.setups[setup];
  const BoundSetup& bound = *place.bound;
  double variance = 0.0;
  if (!source.readings.sigma.empty()) {
    variance = source.readings.sigma[row] * source.readings.sigma[row];
  } else {
    const double constant = place.noise_constant[channel];
    const double length =
        estimated ? noise_length(setup, row, channel, parameters) : bound.noise_length(row, channel);
    const double per_metre = place.noise_per_metre * length;
    variance = constant * constant + per_metre * per_metre;
  }
  if (source.repeatability > 0.0) {
    ToolState<double> state;
    state.point_w = chain_.nominal_point_w(source.readings.commanded_position(row), place.tool_offset);
    double nuisance[kMaxLocalNuisance];
    local_nuisance(setup, row, parameters, nuisance);
    Linearization lin;
    bound.linearize(row, state, nuisance, lin);
    const double along = Eigen::Map<const Eigen::Vector3d>(lin.d_state[channel]).norm();
    variance += source.repeatability * source.repeatability * along * along;
  }
  return std::sqrt(variance);
}

}  // namespace volcal
