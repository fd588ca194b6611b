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
  double motion[kAxisCount][6];    ///< per joint: EX EY EZ EA EB EC
  double driver[kMaxSharedTerms];  ///< per shared term
  Eigen::Matrix3d rotation_wt;     ///< filled when the tool's offset is uncertain
  ToolState<double> tool;
};

namespace {

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
  double* motion = &state.motion[0][0];
  const int* slot_motion = slot_motion_.data();
  for (std::size_t g = 0; g < binding_.groups.size(); ++g) {
    const FunctionGroup& group = layout().groups[g];
    const GroupBinding& place = binding_.groups[g];
    const std::size_t axis = index_of(place.axis);
    const int support = group_support_[g];
    const double* values = computed;
    if (tables_.has_table(setup, axis)) {
      const std::size_t entry = tables_.entry(setup, axis, row);
      out.start[g] = tables_.basis_values(g, support, entry, basis);
      if (tabulated != nullptr) values = (*tabulated)[g].data() + entry * place.component.size();
    } else {
      out.start[g] = group.basis->evaluate(state.position[axis], basis);
    }
    if (values == computed) function_values(group, out.start[g], basis, parameters, computed);
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
  for (const EffectBinding& effect : binding_.effects) {
    effect.effect->drivers(campaign_.setups[setup], row, driver);
    driver += effect.terms.size();
  }
  for (const ExpansionBinding& expansion : binding_.setups[setup].expansions) {
    const double warmed = expansion.warmed(row, state.position);
    state.motion[expansion.term.joint][expansion.term.component] += expansion.per_kelvin * warmed;
    if (expansion.term.parameter >= 0) *driver++ = warmed;
  }
  driver = state.driver;
  for (const MotionTerm& term : binding_.shared_terms) {
    state.motion[term.joint][term.component] += *driver++ * parameters[term.parameter];
  }
}

/// Adds the joints' motions to the tool's state.
void MeasurementModel::move_tool(RowState& state) const {
  using Eigen::Vector3d;
  for (std::size_t i = 0; i < joint_turns_.size(); ++i) {
    const JointLever& lever = state.levers[i];
    Vector3d turn = Eigen::Map<const Vector3d>(state.motion[i] + 3);
    Vector3d shift = Eigen::Map<const Vector3d>(state.motion[i]) + turn.cross(lever.arm_s);
    if (joint_turns_[i]) {
      shift = (lever.rotation_ws * shift).eval();
      turn = (lever.rotation_ws * turn).eval();
    }
    state.tool.point_w += shift;
    (lever.workpiece_side ? state.tool.rotation_workpiece_side : state.tool.rotation_tool_side) += turn;
  }
}

void MeasurementModel::fill_channel(const SetupBinding& place, const RowState& state,
                                    const Linearization& reading, int channel, RowJacobian& out) const {
  out.predicted[channel] = reading.predicted[channel];
  double sensitivity[kAxisCount * 6];
  for (std::size_t i = 0; i < joint_turns_.size(); ++i) {
    motion_weights(state.levers[i], joint_turns_[i], reading.d_state[channel], sensitivity + 6 * i);
  }
  double* weight = out.weight[channel].data();
  for (const int motion : slot_motion_) *weight++ = sensitivity[motion];
  double* tail = out.tail_value[channel].data();
  const double* driver = state.driver;
  for (const MotionTerm& term : binding_.shared_terms) {
    *tail++ = *driver++ * sensitivity[6 * term.joint + term.component];
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
  const Setup& source = campaign_.setups[setup];
  const SetupBinding& place = binding_.setups[setup];
  const BoundSetup& bound = *place.bound;
  const int local_size = bound.local_nuisance_size();
  resize(bound.channels(), (place.tool_error >= 0 ? 3 : 0) + local_size, out);

  RowState state;
  state.levers = out.levers.data();
  std::fill_n(&state.motion[0][0], 6 * joint_turns_.size(), 0.0);
  for (const Joint& joint : campaign_.machine.structure.joints) {
    const std::size_t axis = index_of(joint.axis);
    state.position[axis] = source.readings.position[axis][row];
  }
  state.tool.point_w = chain_.levers(state.position, place.tool_offset, state.levers);
  if (!remainder_w_.empty()) state.tool.point_w += remainder_w_[setup][row];
  add_functions(setup, row, parameters, tabulated, state, out);
  add_terms(setup, row, parameters, state);
  move_tool(state);

  int* index = out.tail_index.data() + shared_tail_size();
  if (place.tool_error >= 0) {
    state.rotation_wt = chain_.nominal_rotation_wt(state.position);
    state.tool.point_w += state.rotation_wt * parameters.segment<3>(place.tool_error);
    for (int k = 0; k < 3; ++k) *index++ = place.tool_error + k;
  }
  double nuisance[kMaxLocalNuisance];
  bound.local_nuisance(row, index);
  for (int k = 0; k < local_size; ++k) {
    index[k] = place.nuisance[static_cast<std::size_t>(index[k])];
    nuisance[k] = parameters[index[k]];
  }
  Linearization reading;
  bound.linearize(row, state.tool, nuisance, reading);
  for (int channel = 0; channel < out.channels; ++channel) fill_channel(place, state, reading, channel, out);
}

/// Gives the row its sizes and the shared part of its tail; without effect on a row that had them.
void MeasurementModel::resize(int channels, int own_tail, RowJacobian& out) const {
  const std::size_t tail = binding_.shared_terms.size() + static_cast<std::size_t>(own_tail);
  out.channels = channels;
  out.levers.resize(joint_turns_.size());
  out.start.resize(binding_.groups.size());
  out.basis_value.resize(value_count_);
  for (int channel = 0; channel < channels; ++channel) {
    out.weight[channel].resize(slot_motion_.size());
    out.tail_value[channel].resize(tail);
  }
  out.tail_index.resize(tail);
  for (std::size_t i = 0; i < binding_.shared_terms.size(); ++i) {
    out.tail_index[i] = binding_.shared_terms[i].parameter;
  }
}

void MeasurementModel::predict(std::size_t setup, std::size_t row, const Eigen::VectorXd& parameters,
                               double* predicted) const {
  RowJacobian out;
  linearize(setup, row, parameters, out);
  std::copy_n(out.predicted, out.channels, predicted);
}

}  // namespace volcal
