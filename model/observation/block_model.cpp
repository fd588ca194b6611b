#include "volcal/model/observation/block_model.h"

#include <algorithm>
#include <cmath>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr std::size_t kMostFunctions = kAllComponents.size();  // of a group

int round_up_to_alignment(int size) {
  return (size + BlockModel::kRowAlignment - 1) / BlockModel::kRowAlignment * BlockModel::kRowAlignment;
}

/// lanes = column of a row-major table, from `first` on; the last row is repeated.
void take_rows(const double* first, std::ptrdiff_t stride, int size, Lanes& lanes) {
  for (int i = 0; i < size; ++i) lanes[i] = first[i * stride];
  std::fill(lanes.value + size, lanes.value + kLanes, lanes[size - 1]);
}

std::size_t motion_index(int of_state_or_disturbance) {
  return static_cast<std::size_t>(of_state_or_disturbance);
}

bool all_equal(const std::uint32_t* numbers, int count) {
  return std::all_of(numbers, numbers + count, [&](std::uint32_t number) { return number == *numbers; });
}

void set_zero(Lanes* lanes, int count) {
  for (int k = 0; k < count; ++k) lanes[k].fill(0.0);
}

/// lanes += factor * position from home times the excess over the reference temperature.
void add_warmed(const ExpansionBinding& expansion, const ReadingBlock& block, const Lanes& position,
                double factor, Lanes& lanes) {
  const double* const temperature_degC = expansion.temperature_degC->data() + block.first_row;
  for (int i = 0; i < kLanes; ++i) {
    const double excess = temperature_degC[std::min(i, block.size - 1)] - kReferenceTemperature_degC;
    lanes[i] += factor * (excess * (position[i] - expansion.home));
  }
}

/// Calls f(place in the shared tail, parameter, driver, disturbance) for what shared terms and effects add.
template <class F>
void for_each_shared(const CampaignBinding& binding, const BlockLevers& levers, const F& f) {
  const Lanes* driver = levers.driver.data();
  int place = 0;
  for (const MotionTerm& term : binding.shared_terms)
    f(place++, term.parameter, *driver++, 6 * term.joint + term.component);
  for (const EffectBinding& effect : binding.effects) {
    int parameter = effect.first_parameter;
    for (std::size_t k = 0; k < effect.target.size(); ++k)
      f(place + effect.amplitude[k], parameter + effect.amplitude[k], *driver++, effect.target[k]);
    place += effect.amplitude_count();
    parameter += effect.amplitude_count();
    for (std::size_t i = 0; i < effect.free_shape.size(); ++i, ++place, ++parameter) {
      for (const int target : effect.target) f(place, parameter, *driver++, target);
    }
  }
}

}  // namespace

BlockModel::BlockModel(const MeasurementModel& model) : model_(model) {
  const CampaignBinding& binding = model.binding();
  for (const Joint& joint : model.campaign().machine.structure.joints)
    turns_ = turns_ || is_rotary(joint.axis);
  moves_tool_ = binding.effect_moves_tool ||
                std::ranges::any_of(binding.setups, [](const auto& s) { return s.tool_error >= 0; });
  for (std::size_t setup = 0; setup < binding.setups.size(); ++setup) cut_setup(setup);
  int begin = 0;
  for (std::size_t g = 0; g < group_count(); ++g) {
    segment_begin_.push_back(begin);
    begin += round_up_to_alignment(model.layout().groups[g].count());
  }
  std::size_t own = 0;
  for (const auto& parameters : own_) own = std::max(own, parameters.size());
  for (const int size : {model.shared_tail_size(), static_cast<int>(own)}) {
    segment_begin_.push_back(begin);
    begin += round_up_to_alignment(size);
  }
  segment_begin_.push_back(begin);
}

/// Cuts the readings of a setup where their own parameters change.
void BlockModel::cut_setup(std::size_t setup) {
  const SetupBinding& place = model_.binding().setups[setup];
  const std::size_t rows = model_.campaign().setups[setup].readings.size();
  const int count = place.bound->local_nuisance_size();
  int index[kMaxLocalNuisance], last[kMaxLocalNuisance];
  std::vector<int> own;
  std::uint32_t number = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    place.bound->local_nuisance(row, index);
    const bool is_new = row == 0 || !std::equal(index, index + count, last);
    if (is_new) {
      own.clear();
      for (int k = 0; k < 3 && place.tool_error >= 0; ++k) own.push_back(place.tool_error + k);
      for (int k = 0; k < count; ++k) own.push_back(place.nuisance[static_cast<std::size_t>(index[k])]);
      number = own_number(own);
      std::copy_n(index, count, last);
    }
    if (is_new || blocks_.back().size == kLanes) {
      blocks_.push_back({static_cast<std::uint32_t>(setup), static_cast<std::uint32_t>(row), 0, number});
    }
    ++blocks_.back().size;
  }
}

std::uint32_t BlockModel::own_number(const std::vector<int>& parameters) {
  const auto [found, is_new] = own_numbers_.try_emplace(parameters, static_cast<std::uint32_t>(own_.size()));
  if (is_new) own_.push_back(parameters);
  return found->second;
}

std::span<const int> BlockModel::nuisance_of(const ReadingBlock& block) const {
  const int count = model_.binding().setups[block.setup].bound->local_nuisance_size();
  return std::span(own_[block.own]).last(static_cast<std::size_t>(count));
}

std::vector<int> BlockModel::shared_parameters() const {
  const CampaignBinding& binding = model_.binding();
  std::vector<int> parameters;
  for (const MotionTerm& term : binding.shared_terms) parameters.push_back(term.parameter);
  for (const EffectBinding& effect : binding.effects) {
    for (int k = 0; k < effect.parameter_count(); ++k) parameters.push_back(effect.first_parameter + k);
  }
  return parameters;
}

BlockLevers BlockModel::make_levers() const {
  const CampaignBinding& binding = model_.binding();
  const std::size_t joints = model_.chain().joint_count();
  BlockLevers levers;
  levers.position.resize(kAxisCount);
  levers.arm_s.resize(3 * joints);
  if (turns_) levers.rotation_ws.resize(9 * joints);
  if (turns_ && moves_tool_) levers.rotation_wt.resize(9);
  levers.driver.resize(binding.shared_terms.size() + static_cast<std::size_t>(binding.effect_drivers));
  levers.motion.resize(kDisturbances);
  return levers;
}

void BlockModel::find_levers(const ReadingBlock& block, const Eigen::VectorXd& parameters,
                             BlockLevers& levers) const {
  const Machine& machine = model_.campaign().machine;
  const Readings& readings = model_.campaign().setups[block.setup].readings;
  for (const Joint& joint : machine.structure.joints) {
    const std::size_t axis = index_of(joint.axis);
    take_rows(readings.position[axis].data() + block.first_row, 1, block.size, levers.position[axis]);
  }
  const Eigen::Vector3d& tool_offset = model_.binding().setups[block.setup].tool_offset;
  model_.chain().levers(levers.position.data(), tool_offset, levers.tool.point_w, levers.arm_s.data(),
                        turns_ ? levers.rotation_ws.data() : nullptr);
  if (!levers.rotation_wt.empty()) {
    AxisPosition at{};
    for (int i = 0; i < kLanes; ++i) {
      for (const Joint& joint : machine.structure.joints)
        at[index_of(joint.axis)] = levers.position[index_of(joint.axis)][i];
      const Eigen::Matrix3d rotation_wt = model_.chain().nominal_rotation_wt(at);
      for (int k = 0; k < 9; ++k)
        levers.rotation_wt[static_cast<std::size_t>(k)][i] = rotation_wt(k / 3, k % 3);
    }
  }
  find_drivers(block, parameters, levers);
}

/// Of locations, uncertain expansions, and effects: terms, then amplitudes times slopes.
void BlockModel::find_drivers(const ReadingBlock& block, const Eigen::VectorXd& parameters,
                              BlockLevers& levers) const {
  const CampaignBinding& binding = model_.binding();
  Lanes* driver = levers.driver.data();
  for (const LocationBinding& location : binding.locations) {
    driver->fill(location.times_position ? 0.0 : location.sign);
    if (location.times_position) add_scaled(levers.position[index_of(location.axis)], location.sign, *driver);
    ++driver;
  }
  for (const ExpansionBinding& expansion : binding.setups[block.setup].expansions) {
    if (expansion.term.parameter < 0) continue;
    driver->fill(0.0);
    add_warmed(expansion, block, levers.position[index_of(expansion.axis)], 1.0, *driver++);
  }
  for (const EffectBinding& effect : binding.effects) {
    const int count = effect.term_count();
    const auto take = [&](const EffectBinding::Table& table, int k, Lanes& lanes) {
      take_rows(table.data() + block.first_row * static_cast<std::size_t>(count) + k, count, block.size,
                lanes);
    };
    Lanes* slope = driver + count;
    for (int k = 0; k < count; ++k) take(effect.driver[block.setup], k, driver[k]);
    for (std::size_t i = 0; i < effect.free_shape.size(); ++i) {
      const double change = parameters[effect.shape_parameter(i)] - effect.shape[effect.free_shape[i]];
      for (int k = 0; k < count; ++k, ++slope) {
        Lanes tabulated;
        take(effect.slope[i][block.setup], k, tabulated);
        add_scaled(tabulated, change, driver[k]);
        slope->fill(0.0);
        add_scaled(tabulated,
                   parameters[effect.first_parameter + effect.amplitude[static_cast<std::size_t>(k)]],
                   *slope);
      }
    }
    driver = slope;
  }
}

void BlockModel::add_functions(const ReadingBlock& block, const TabulatedFunctions& tabulated,
                               BlockLevers& levers) const {
  const int* slot_motion = model_.slot_motion().data();
  for (std::size_t g = 0; g < group_count(); ++g) {
    const FunctionGroup& group = model_.layout().groups[g];
    const std::uint32_t* entry =
        model_.tables().entries(block.setup, index_of(group.axis)).data() + block.first_row;
    const int count = group.count();
    const double* const table = tabulated[g].data();
    const bool is_one_position = all_equal(entry, block.size);
    std::int32_t place[kLanes];
    for (int i = 0; i < kLanes; ++i)
      place[i] = static_cast<std::int32_t>(entry[std::min(i, block.size - 1)]) * count;
    for (int slot = 0; slot < count; ++slot) {
      Lanes& motion = levers.motion[static_cast<std::size_t>(*slot_motion++)];
      if (is_one_position) {
        add_number(table[place[0] + slot], motion);
      } else {
        add_entries(table + slot, place, motion);
      }
    }
  }
}

void BlockModel::add_terms(const ReadingBlock& block, const Eigen::VectorXd& parameters,
                           BlockLevers& levers) const {
  const CampaignBinding& binding = model_.binding();
  const auto motion = [&](const MotionTerm& term) -> Lanes& {
    return levers.motion[motion_index(6 * term.joint + term.component)];
  };
  for (const ExpansionBinding& expansion : binding.setups[block.setup].expansions) {
    add_warmed(expansion, block, levers.position[index_of(expansion.axis)], expansion.per_kelvin,
               motion(expansion.term));
  }
  const Lanes* driver = levers.driver.data();
  for (const MotionTerm& term : binding.shared_terms)
    add_scaled(*driver++, parameters[term.parameter], motion(term));
  for (const EffectBinding& effect : binding.effects) {
    const double* amplitude = parameters.data() + effect.first_parameter;
    for (std::size_t k = 0; k < effect.target.size(); ++k)
      add_scaled(*driver++, amplitude[effect.amplitude[k]],
                 levers.motion[static_cast<std::size_t>(effect.target[k])]);
    driver += effect.target.size() * effect.free_shape.size();
  }
}

/// Adds the motions of joints, tool, station and floor to the tool's state.
void BlockModel::move_tool(const ReadingBlock& block, const Eigen::VectorXd& parameters, BlockLevers& levers,
                           BlockLinearization& out) const {
  const CampaignBinding& binding = model_.binding();
  ToolStateLanes& tool = levers.tool;
  add_remainder(block, tool.point_w);
  set_zero(tool.rotation_tool_side, 3);
  set_zero(tool.rotation_workpiece_side, 3);
  const auto& joints = model_.campaign().machine.structure.joints;
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    Lanes* shift = &levers.motion[6 * joint];
    const Lanes* turn = shift + 3;
    add_cross(turn, &levers.arm_s[3 * joint], shift);
    Lanes turned[6];
    if (model_.joint_turns(joint)) {
      rotate(&levers.rotation_ws[9 * joint], shift, false, turned);
      rotate(&levers.rotation_ws[9 * joint], turn, false, turned + 3);
      shift = turned;
      turn = turned + 3;
    }
    Lanes* const side = joints[joint].workpiece_side ? tool.rotation_workpiece_side : tool.rotation_tool_side;
    for (int k = 0; k < 3; ++k) {
      add_scaled(shift[k], 1.0, tool.point_w[k]);
      add_scaled(turn[k], 1.0, side[k]);
    }
  }
  for (int k = 0; k < 3 && !binding.effects.empty(); ++k)
    add_scaled(levers.motion[motion_index(kStationDisturbance + k)], -1.0, tool.point_w[k]);
  if (binding.effect_moves_tool) move_offset(levers, &levers.motion[kToolDisturbance]);
  if (binding.effect_tilts_floor) tilt_floor(levers, out);
  const int tool_error = binding.setups[block.setup].tool_error;
  if (tool_error >= 0) {
    Lanes error[3];
    for (int k = 0; k < 3; ++k) error[k].fill(parameters[tool_error + k]);
    move_offset(levers, error);
  }
}

void BlockModel::add_remainder(const ReadingBlock& block, Lanes* point_w) const {
  const auto& remainder_w = model_.second_order_remainder_w();
  if (remainder_w.empty()) return;
  const Eigen::Vector3d* const first = remainder_w[block.setup].data() + block.first_row;
  for (int i = 0; i < kLanes; ++i) {
    for (int k = 0; k < 3; ++k) point_w[k][i] += first[std::min(i, block.size - 1)][k];
  }
}

/// Adds a change of the tool's offset, tool coordinates.
void BlockModel::move_offset(BlockLevers& levers, const Lanes* change_t) const {
  Lanes turned[3];
  if (turns_) {
    rotate(levers.rotation_wt.data(), change_t, false, turned);
    change_t = turned;
  }
  for (int k = 0; k < 3; ++k) add_scaled(change_t[k], 1.0, levers.tool.point_w[k]);
}

void BlockModel::tilt_floor(BlockLevers& levers, BlockLinearization& out) const {
  const Lanes* const tilt = &levers.motion[kFloorDisturbance];
  ToolStateLanes& tool = levers.tool;
  out.floor_arm_w.resize(3);
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < kLanes; ++i)
      out.floor_arm_w[static_cast<std::size_t>(k)][i] =
          tool.point_w[k][i] - model_.binding().floor_pivot_w[k];
    add_scaled(tilt[k], 1.0, tool.rotation_tool_side[k]);
    add_scaled(tilt[k], -1.0, tool.rotation_workpiece_side[k]);
  }
  add_cross(tilt, out.floor_arm_w.data(), tool.point_w);
}

void BlockModel::find_state(const ReadingBlock& block, const Eigen::VectorXd& parameters,
                            const TabulatedFunctions& tabulated, BlockLevers& levers,
                            BlockLinearization& out) const {
  find_levers(block, parameters, levers);
  set_zero(levers.motion.data(), 6 * static_cast<int>(model_.chain().joint_count()));
  if (!model_.binding().effects.empty())
    set_zero(&levers.motion[kToolDisturbance], kDisturbances - kToolDisturbance);
  add_functions(block, tabulated, levers);
  add_terms(block, parameters, levers);
  move_tool(block, parameters, levers, out);
}

void BlockModel::measure(const ReadingBlock& block, const Eigen::Ref<const Eigen::VectorXd>& parameters,
                         const ToolStateLanes& tool, LinearizationLanes& out) const {
  const BoundSetup& bound = *model_.binding().setups[block.setup].bound;
  double nuisance[kMaxLocalNuisance];
  std::ranges::transform(nuisance_of(block), nuisance, [&](int parameter) { return parameters[parameter]; });
  out.resize(bound.channels(), bound.sees_rotation() ? kStateSize : 3, bound.local_nuisance_size());
  bound.linearize_lanes(block.first_row, block.size, tool, nuisance, out);
}

void BlockModel::linearize(const ReadingBlock& block, const Eigen::VectorXd& parameters,
                           const TabulatedFunctions& tabulated, BlockLevers& levers,
                           BlockLinearization& out) const {
  find_state(block, parameters, tabulated, levers, out);
  measure(block, parameters, levers.tool, out.reading);
  for (int channel = 0; channel < out.reading.channels() && !model_.binding().effects.empty(); ++channel) {
    add_scaled(levers.motion[motion_index(kReadingDisturbance + channel)], 1.0,
               out.reading.predicted(channel));
  }
}

/// Work of a force on the functional point and torques on both sides (null: none) on a unit of every
/// disturbance but the reading's own: into levers.motion.
void BlockModel::find_work(const BlockLinearization& linearized, const Lanes* force, const Lanes* torque,
                           BlockLevers& levers) const {
  const auto& joints = model_.campaign().machine.structure.joints;
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    const Lanes* own_force = force;
    const Lanes* own_torque = torque == nullptr ? nullptr : torque + (joints[joint].workpiece_side ? 3 : 0);
    Lanes turned[6];
    if (model_.joint_turns(joint)) {
      rotate(&levers.rotation_ws[9 * joint], force, true, turned);
      own_force = turned;
      if (torque != nullptr) {
        rotate(&levers.rotation_ws[9 * joint], own_torque, true, turned + 3);
        own_torque = turned + 3;
      }
    }
    Lanes* const work = &levers.motion[6 * joint];
    std::copy_n(own_force, 3, work);
    if (own_torque != nullptr) {
      std::copy_n(own_torque, 3, work + 3);
    } else {
      set_zero(work + 3, 3);
    }
    add_cross(&levers.arm_s[3 * joint], own_force, work + 3);
  }
  if (moves_tool_) {
    Lanes* const work = &levers.motion[kToolDisturbance];
    if (turns_) {
      rotate(levers.rotation_wt.data(), force, true, work);
    } else {
      std::copy_n(force, 3, work);
    }
  }
  Lanes* const station = &levers.motion[kStationDisturbance];
  set_zero(station, 3);
  for (int k = 0; k < 3; ++k) add_scaled(force[k], -1.0, station[k]);
  if (!model_.binding().effect_tilts_floor) return;
  Lanes* const floor = &levers.motion[kFloorDisturbance];
  set_zero(floor, 3);
  add_cross(linearized.floor_arm_w.data(), force, floor);
  for (int k = 0; k < 3 && torque != nullptr; ++k) {
    add_scaled(torque[k], 1.0, floor[k]);
    add_scaled(torque[3 + k], -1.0, floor[k]);
  }
}

void BlockModel::add_work(const ReadingBlock& block, const BlockLinearization& linearized, const Lanes* error,
                          BlockLevers& levers, GradientSums& sums) const {
  const LinearizationLanes& reading = linearized.reading;
  Lanes load[kStateSize];
  set_zero(load, reading.state_size());
  for (int channel = 0; channel < reading.channels(); ++channel) {
    for (int k = 0; k < reading.state_size(); ++k)
      add_product(error[channel], reading.d_state(channel)[k], load[k]);
    levers.motion[motion_index(kReadingDisturbance + channel)] = error[channel];
  }
  find_work(linearized, load, reading.state_size() == kStateSize ? load + 3 : nullptr, levers);
  gather(block, levers, sums);
  for_each_shared(
      model_.binding(), levers, [&](int /*place*/, int parameter, const Lanes& driver, int disturbance) {
        sums.add_to_parameter(parameter, dot(driver, levers.motion[static_cast<std::size_t>(disturbance)]));
      });
  const int tool_error = model_.binding().setups[block.setup].tool_error;
  for (int k = 0; k < 3 && tool_error >= 0; ++k)
    sums.add_to_parameter(tool_error + k, sum(levers.motion[motion_index(kToolDisturbance + k)]));
  const std::span<const int> nuisance = nuisance_of(block);
  for (std::size_t k = 0; k < nuisance.size(); ++k) {
    for (int channel = 0; channel < reading.channels(); ++channel)
      sums.add_to_parameter(nuisance[k], dot(error[channel], reading.d_nuisance(channel)[k]));
  }
}

/// Adds the work on the joints' motions to the positions where it is done.
void BlockModel::gather(const ReadingBlock& block, const BlockLevers& levers, GradientSums& sums) const {
  const int* slot_motion = model_.slot_motion().data();
  for (std::size_t g = 0; g < group_count(); ++g) {
    const FunctionGroup& group = model_.layout().groups[g];
    const std::uint32_t* entry =
        model_.tables().entries(block.setup, index_of(group.axis)).data() + block.first_row;
    const double* work[kMostFunctions];
    for (int slot = 0; slot < group.count(); ++slot)
      work[slot] = levers.motion[static_cast<std::size_t>(*slot_motion++)].value;
    sums.add_at_positions(g, entry, block.size, work);
  }
}

void BlockModel::make_rows(const ReadingBlock& block, const BlockLinearization& linearized, int channel,
                           const Lanes& scale, BlockLevers& levers, double* rows) const {
  const LinearizationLanes& reading = linearized.reading;
  Lanes load[kStateSize];
  set_zero(load, reading.state_size());
  for (int k = 0; k < reading.state_size(); ++k) add_product(scale, reading.d_state(channel)[k], load[k]);
  find_work(linearized, load, reading.state_size() == kStateSize ? load + 3 : nullptr, levers);
  set_zero(&levers.motion[kReadingDisturbance], reading.channels());
  levers.motion[motion_index(kReadingDisturbance + channel)] = scale;
  make_rows_of_work(block, levers, rows);
  std::ptrdiff_t own = segment_begin_[group_count() + 1];
  if (model_.binding().setups[block.setup].tool_error >= 0) own += 3;
  for (int k = 0; k < reading.nuisance_size(); ++k) {
    Lanes product = {};
    add_product(scale, reading.d_nuisance(channel)[k], product);
    add_column(product, block.size, rows + own + k);
  }
}

void BlockModel::make_rows_of_state(const ReadingBlock& block, int component, BlockLevers& levers,
                                    double* rows) const {
  Lanes load[kStateSize];
  set_zero(load, kStateSize);
  set_zero(&levers.motion[kReadingDisturbance], kMaxChannels);
  (component < kStateSize ? load[component]
                          : levers.motion[motion_index(kReadingDisturbance + component - kStateSize)])
      .fill(1.0);
  find_work({}, load, load + 3, levers);
  make_rows_of_work(block, levers, rows);
}

void BlockModel::add_column(const Lanes& lanes, int size, double* column) const {
  const std::ptrdiff_t width = row_width();
  for (int i = 0; i < size; ++i) column[i * width] += lanes[i];
}

/// Rows from the work on a unit of every disturbance; nothing at the places of the nuisance.
void BlockModel::make_rows_of_work(const ReadingBlock& block, const BlockLevers& levers, double* rows) const {
  std::fill_n(rows, static_cast<std::ptrdiff_t>(row_width()) * block.size, 0.0);
  const int* slot_motion = model_.slot_motion().data();
  for (std::size_t g = 0; g < group_count(); ++g) {
    for (int slot = 0; slot < model_.layout().groups[g].count(); ++slot)
      add_column(levers.motion[static_cast<std::size_t>(*slot_motion++)], block.size,
                 rows + segment_begin_[g] + slot);
  }
  for_each_shared(model_.binding(), levers,
                  [&](int place, int /*parameter*/, const Lanes& driver, int disturbance) {
                    Lanes product = {};
                    add_product(driver, levers.motion[static_cast<std::size_t>(disturbance)], product);
                    add_column(product, block.size, rows + segment_begin_[group_count()] + place);
                  });
  double* own = rows + segment_begin_[group_count() + 1];
  for (int k = 0; k < 3 && model_.binding().setups[block.setup].tool_error >= 0; ++k)
    add_column(levers.motion[motion_index(kToolDisturbance + k)], block.size, own + k);
}

}  // namespace volcal
