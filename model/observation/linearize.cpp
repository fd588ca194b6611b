// Prediction of a reading and its derivatives. Every error is a motion of a joint: functions, location
// errors, effects and expansions add to the six components of their joint, and all of them share the
// sensitivity of the reading to that motion.

#include <algorithm>

#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Everything about one reading that does not depend on the channel. Made for every reading: only what the
/// machine has is filled.
struct MeasurementModel::RowState {
  AxisPosition position;
  JointLever* levers;
  double
      disturbance[kDisturbances];  ///< motions of the joints, EX EY EZ EA EB EC each; tool; station; reading
  double driver[kMaxSharedTerms];  ///< per shared term, then what the effects need
  Eigen::Matrix3d rotation_wt;     ///< filled when the tool's offset is uncertain
  Eigen::Vector3d floor_arm_w;     ///< from the pivot of the floor to the functional point

  double* motion(std::ptrdiff_t joint) { return disturbance + 6 * joint; }
  ToolState<double> tool;
};

namespace {

/// Adds an effect's contribution; writes the drivers of its terms and, per free shape parameter, amplitude
/// times slope. Returns the place after them.
double* add_effect(const EffectBinding& effect, std::size_t setup, std::size_t row,
                   const Eigen::VectorXd& parameters, double* disturbance, double* driver) {
  const int count = effect.term_count();
  const int* of = effect.amplitude.data();
  const double* table = &effect.driver[setup](static_cast<Eigen::Index>(row), 0);
  const double* amplitude = parameters.data() + effect.first_parameter;
  double* slope = driver + count;
  for (int k = 0; k < count; ++k) driver[k] = table[k];
  for (std::size_t i = 0; i < effect.free_shape.size(); ++i) {
    const double* tabulated = &effect.slope[i][setup](static_cast<Eigen::Index>(row), 0);
    const double change = parameters[effect.shape_parameter(i)] - effect.shape[effect.free_shape[i]];
    for (int k = 0; k < count; ++k) {
      driver[k] += change * tabulated[k];
      *slope++ = amplitude[of[k]] * tabulated[k];
    }
  }
  for (int k = 0; k < count; ++k)
    disturbance[effect.target[static_cast<std::size_t>(k)]] += driver[k] * amplitude[of[k]];
  return slope;
}

/// Derivatives of one channel to a unit of each motion component of a joint.
void motion_weights(const JointLever& lever, bool turns, const double* d_state, double* weight) {
  using Eigen::Vector3d;
  Vector3d point = Eigen::Map<const Vector3d>(d_state);
  Vector3d turn = Eigen::Map<const Vector3d>(d_state + (lever.workpiece_side ? 6 : 3));
  if (turns) {
    point = (lever.rotation_ws.transpose() * point).eval();
    turn = (lever.rotation_ws.transpose() * turn).eval();
  }
  Eigen::Map<Vector3d>(weight, 3) = point;
  Eigen::Map<Vector3d>(weight + 3, 3) = lever.arm_s.cross(point) + turn;
}

}  // namespace

void MeasurementModel::add_functions(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                                     const TabulatedFunctions* tabulated, RowState& state,
                                     RowJacobian& out) const {
  double computed[6];
  double* basis = out.basis_value.data();
  double* motion = state.disturbance;
  const int* slot_motion = slot_motion_.data();
  for (std::size_t g = 0; g < binding_.groups.size(); ++g) {
    const FunctionGroup& group = layout().groups[g];
    const GroupBinding& place = binding_.groups[g];
    const std::size_t axis = index_of(place.axis);
    const int support = group_support_[g];
    const double* values = computed;
    const std::size_t entry = tables_.entries(setup, axis)[row];
    out.start[g] = tables_.basis_values(g, support, entry, basis);
    if (tabulated != nullptr) {
      values = (*tabulated)[g].data() + entry * place.component.size();
    } else {
      function_values(group, out.start[g], basis, parameters, computed);
    }
    for (std::size_t s = 0; s < place.component.size(); ++s) motion[*slot_motion++] += values[s];
    basis += support;
  }
}

void MeasurementModel::add_terms(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                                 RowState& state) const {
  double* driver = state.driver;
  for (const LocationBinding& location : binding_.locations) {
    *driver++ =
        location.times_position ? location.sign * state.position[index_of(location.axis)] : location.sign;
  }
  for (const ExpansionBinding& expansion : binding_.setups[setup].expansions) {
    const double warmed = expansion.warmed(row, state.position);
    state.motion(expansion.term.joint)[expansion.term.component] += expansion.per_kelvin * warmed;
    if (expansion.term.parameter >= 0) *driver++ = warmed;
  }
  driver = state.driver;
  for (const MotionTerm& term : binding_.shared_terms) {
    state.motion(term.joint)[term.component] += *driver++ * parameters[term.parameter];
  }
  for (const EffectBinding& effect : binding_.effects) {
    driver = add_effect(effect, setup, row, parameters, state.disturbance, driver);
  }
}

/// Adds the joints' motions to the tool's state.
void MeasurementModel::move_tool(RowState& state) const {
  using Eigen::Vector3d;
  for (std::size_t i = 0; i < joint_turns_.size(); ++i) {
    const JointLever& lever = state.levers[i];
    const double* motion = state.motion(static_cast<int>(i));
    Vector3d turn = Eigen::Map<const Vector3d>(motion + 3);
    Vector3d shift = Eigen::Map<const Vector3d>(motion) + turn.cross(lever.arm_s);
    if (joint_turns_[i]) {
      shift = (lever.rotation_ws * shift).eval();
      turn = (lever.rotation_ws * turn).eval();
    }
    state.tool.point_w += shift;
    (lever.workpiece_side ? state.tool.rotation_workpiece_side : state.tool.rotation_tool_side) += turn;
  }
  state.tool.point_w -= Eigen::Map<const Vector3d>(state.disturbance + kStationDisturbance);
  if (binding_.effect_moves_tool) {
    state.tool.point_w +=
        state.rotation_wt * Eigen::Map<const Vector3d>(state.disturbance + kToolDisturbance);
  }
  state.floor_arm_w = state.tool.point_w - binding_.floor_pivot_w;
  if (binding_.effect_tilts_floor) {
    const Eigen::Map<const Vector3d> tilt(state.disturbance + kFloorDisturbance);
    state.tool.point_w += tilt.cross(state.floor_arm_w);
    state.tool.rotation_tool_side += tilt;
    state.tool.rotation_workpiece_side -= tilt;
  }
}

/// Derivatives of a channel to a unit of every disturbance; those of tool and floor only when an effect needs
/// them.
void MeasurementModel::disturbance_sensitivity(const RowState& state, const Linearization& reading,
                                               int channel, bool all, double* sensitivity) const {
  for (std::size_t i = 0; i < joint_turns_.size(); ++i) {
    motion_weights(state.levers[i], joint_turns_[i] != 0, reading.d_state[channel], sensitivity + 6 * i);
  }
  if (binding_.effects.empty() && !all) return;
  const Eigen::Map<const Eigen::Vector3d> d_point(reading.d_state[channel]);
  if (binding_.effect_moves_tool || all) {
    Eigen::Map<Eigen::Vector3d>(sensitivity + kToolDisturbance) = state.rotation_wt.transpose() * d_point;
  }
  Eigen::Map<Eigen::Vector3d>(sensitivity + kStationDisturbance) = -d_point;
  if (binding_.effect_tilts_floor || all) {
    const double* d_state = reading.d_state[channel];
    Eigen::Map<Eigen::Vector3d>(sensitivity + kFloorDisturbance) =
        state.floor_arm_w.cross(d_point) + Eigen::Map<const Eigen::Vector3d>(d_state + 3) -
        Eigen::Map<const Eigen::Vector3d>(d_state + 6);
  }
  std::fill_n(sensitivity + kReadingDisturbance, kMaxChannels, 0.0);
  sensitivity[kReadingDisturbance + channel] = 1.0;
}

void MeasurementModel::fill_channel(const SetupBinding& place, const RowState& state,
                                    const Linearization& reading, int channel, RowJacobian& out) const {
  out.predicted[channel] = reading.predicted[channel] + state.disturbance[kReadingDisturbance + channel];
  double sensitivity[kDisturbances];
  disturbance_sensitivity(state, reading, channel, false, sensitivity);
  double* weight = out.weight[channel].data();
  for (const int motion : slot_motion_) *weight++ = sensitivity[motion];
  double* tail = out.tail_value[channel].data();
  const double* driver = state.driver;
  for (const MotionTerm& term : binding_.shared_terms) {
    *tail++ = *driver++ * sensitivity[6 * term.joint + term.component];
  }
  for (const EffectBinding& effect : binding_.effects) {
    std::fill_n(tail, effect.amplitude_count(), 0.0);
    for (std::size_t k = 0; k < effect.target.size(); ++k)
      tail[effect.amplitude[k]] += *driver++ * sensitivity[effect.target[k]];
    tail += effect.amplitude_count();
    for (std::size_t i = 0; i < effect.free_shape.size(); ++i) {
      *tail = 0.0;
      for (const int target : effect.target) *tail += *driver++ * sensitivity[target];
      ++tail;
    }
  }
  if (place.tool_error >= 0) {
    const Eigen::Map<const Eigen::Vector3d> d_point(reading.d_state[channel]);
    Eigen::Map<Eigen::Vector3d>(tail, 3) = state.rotation_wt.transpose() * d_point;
    tail += 3;
  }
  std::copy_n(reading.d_nuisance[channel], place.bound->local_nuisance_size(), tail);
}

TabulatedFunctions MeasurementModel::tabulate(const Eigen::VectorXd& parameters) const {
  return tables_.tabulate(layout(), parameters);
}

void MeasurementModel::linearize(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                                 RowJacobian& out, const TabulatedFunctions* tabulated) const {
  const SetupBinding& place = binding_.setups[setup];
  RowState state;
  Linearization reading;
  evaluate(setup, row, parameters, tabulated, state, reading, out);
  for (int channel = 0; channel < out.channels; ++channel) fill_channel(place, state, reading, channel, out);
}

void MeasurementModel::disturbance_rows(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                                        DisturbanceRows& out) const {
  RowJacobian scratch;
  RowState state;
  Linearization reading;
  evaluate(setup, row, parameters, nullptr, state, reading, scratch);
  state.rotation_wt = chain_.nominal_rotation_wt(state.position);
  out.setZero();
  for (int channel = 0; channel < scratch.channels; ++channel) {
    disturbance_sensitivity(state, reading, channel, true, out.row(channel).data());
  }
}

/// State of the tool and linearised reading; sizes `out`, writes its basis values and its tail's indices.
void MeasurementModel::evaluate(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                                const TabulatedFunctions* tabulated, RowState& state, Linearization& reading,
                                RowJacobian& out) const {
  const Setup& source = campaign_.setups[setup];
  const SetupBinding& place = binding_.setups[setup];
  const BoundSetup& bound = *place.bound;
  const int local_size = bound.local_nuisance_size();
  resize(bound.channels(), (place.tool_error >= 0 ? 3 : 0) + local_size, out);

  state.levers = out.levers.data();
  std::fill_n(state.disturbance, 6 * joint_turns_.size(), 0.0);
  std::fill(state.disturbance + kToolDisturbance, state.disturbance + kDisturbances, 0.0);
  for (const Joint& joint : campaign_.machine.structure.joints) {
    const std::size_t axis = index_of(joint.axis);
    state.position[axis] = source.readings.position[axis][row];
  }
  state.tool.point_w = chain_.levers(state.position, place.tool_offset, state.levers);
  if (!remainder_w_.empty()) state.tool.point_w += remainder_w_[setup][row];
  if (place.tool_error >= 0 || binding_.effect_moves_tool) {
    state.rotation_wt = chain_.nominal_rotation_wt(state.position);
  }
  add_functions(setup, row, parameters, tabulated, state, out);
  add_terms(setup, row, parameters, state);
  move_tool(state);

  int* index = out.tail_index.data() + shared_tail_size();
  if (place.tool_error >= 0) {
    state.tool.point_w += state.rotation_wt * parameters.segment<3>(place.tool_error);
    for (int k = 0; k < 3; ++k) *index++ = place.tool_error + k;
  }
  double nuisance[kMaxLocalNuisance];
  bound.local_nuisance(row, index);
  for (int k = 0; k < local_size; ++k) {
    index[k] = place.nuisance[static_cast<std::size_t>(index[k])];
    nuisance[k] = parameters[index[k]];
  }
  bound.linearize(row, state.tool, nuisance, reading);
}

/// Gives the row its sizes and the shared part of its tail; without effect on a row that had them.
void MeasurementModel::resize(int channels, int own_tail, RowJacobian& out) const {
  const auto shared = static_cast<std::size_t>(shared_tail_size());
  const std::size_t tail = shared + static_cast<std::size_t>(own_tail);
  out.channels = channels;
  out.levers.resize(joint_turns_.size());
  out.start.resize(binding_.groups.size());
  out.basis_value.resize(value_count_);
  for (int channel = 0; channel < channels; ++channel) {
    out.weight[channel].resize(slot_motion_.size());
    out.tail_value[channel].resize(tail);
  }
  out.tail_index.resize(tail);
  int* index = out.tail_index.data();
  for (const MotionTerm& term : binding_.shared_terms) *index++ = term.parameter;
  for (const EffectBinding& effect : binding_.effects) {
    for (int k = 0; k < effect.parameter_count(); ++k) *index++ = effect.first_parameter + k;
  }
}

void MeasurementModel::predict(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                               double* predicted) const {
  RowJacobian out;
  linearize(setup, row, parameters, out);
  std::copy_n(out.predicted, out.channels, predicted);
}

}  // namespace volcal
