#include "volcal/identify/errors/machine_effects.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/conditions_of_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/tensor_basis.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

constexpr double kShapeStep = 1e-5;    // of the value or its uncertainty
constexpr double kSameDriver = 1e-12;  // of the largest driver
constexpr int kProbes = 48;

/// The poses as readings of a setup without an instrument, which effects take their drivers from.
class PoseReadings {
 public:
  PoseReadings(const Machine& machine, const Tool& tool, const Conditions& conditions,
               std::optional<double> clock_start)
      : conditions_(conditions), chain_(machine), tool_offset_(tool.offset) {
    campaign_.machine = machine;
    campaign_.machine.tools = {tool};
    campaign_.setups.resize(1);
    view_.emplace(SetupView{campaign_, campaign_.setups.front(), {}, {}, clock_start, false});
    for (const auto& [channel, value] : conditions_.temperature_degC) readings().temperature[channel] = {};
  }
  PoseReadings(const PoseReadings&) = delete;
  PoseReadings& operator=(const PoseReadings&) = delete;

  const SetupView& at(std::span<const AxisPosition> positions,
                      std::span<const ApproachDirection> directions) {
    if (positions.size() != readings().size()) resize(positions.size());
    for (const Axis& axis : campaign_.machine.axes) {
      const std::size_t a = index_of(axis.name);
      for (std::size_t i = 0; i < positions.size(); ++i) {
        readings().position[a][i] = positions[i][a];
        readings().direction[a][i] = directions[directions.size() == 1 ? 0 : i][a];
      }
    }
    for (std::size_t i = 0; i < positions.size(); ++i)
      view_->nominal_point_w[i] = nominal_point(positions[i]);
    return *view_;
  }

 private:
  Readings& readings() { return campaign_.setups.front().readings; }

  Eigen::Vector3d nominal_point(const AxisPosition& position) const {
    const bool beyond_main_axes =
        std::any_of(position.begin() + 3, position.end(), [](double value) { return value != 0.0; });
    if (beyond_main_axes) return chain_.nominal_point_w(position, tool_offset_);
    return tool_offset_ + Eigen::Vector3d(position[0], position[1], position[2]);
  }

  void resize(std::size_t size) {
    Readings& all = readings();
    for (const Axis& axis : campaign_.machine.axes) {
      all.position[index_of(axis.name)].resize(size);
      all.direction[index_of(axis.name)].resize(size);
    }
    if (conditions_.time) all.time.assign(size, *conditions_.time);
    if (conditions_.feed) all.feed.assign(size, *conditions_.feed);
    for (auto& [channel, column] : all.temperature)
      column.assign(size, conditions_.temperature_degC.at(channel));
    all.source_line.assign(size, 0);
    view_->nominal_point_w.resize(size);
  }

  Conditions conditions_;
  KinematicChain chain_;
  Eigen::Vector3d tool_offset_;
  Campaign campaign_;
  std::optional<SetupView> view_;
};

bool acts_on_machine(const Effect& effect) {
  return std::ranges::any_of(effect.amplitudes(), [](const EffectAmplitude& amplitude) {
    return amplitude.target.kind == TargetKind::Motion || amplitude.target.kind == TargetKind::ToolOffset;
  });
}

/// Poses that fill the travel, with both directions of approach. Their places are irrational shares of it, at
/// which no wave has one phase.
void probe_poses(const Machine& machine, std::vector<AxisPosition>& positions,
                 std::vector<ApproachDirection>& directions) {
  constexpr std::array<int, kAxisCount> kBases = {2, 3, 5, 7, 11, 13, 17, 19, 23};
  constexpr std::array<int, kAxisCount> kBasesOfDirections = {3, 5, 7, 11, 13, 2, 19, 23, 17};
  for (int i = 1; i <= kProbes; ++i) {
    AxisPosition position{};
    ApproachDirection direction{};
    for (const Axis& axis : machine.axes) {
      const std::size_t a = index_of(axis.name);
      position[a] = axis.travel_min + axis.travel() * std::fmod(i * std::sqrt(kBases[a]), 1.0);
      direction[a] = radical_inverse(i, kBasesOfDirections[a]) < 0.5 ? -1 : 1;
    }
    positions.push_back(position);
    directions.push_back(direction);
  }
}

bool differ(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
  const double size = std::max(one.cwiseAbs().maxCoeff(), other.cwiseAbs().maxCoeff());
  return (one - other).cwiseAbs().maxCoeff() > kSameDriver * size;
}

}  // namespace

int EffectReach::positions() const { return static_cast<int>(std::ranges::count(position, true)); }

std::vector<Variable> EffectReach::variables() const {
  std::vector<Variable> all;
  for (const AxisName axis : kAllAxes) {
    if (position[index_of(axis)]) all.push_back(position_of(axis));
  }
  for (const AxisName axis : kAllAxes) {
    if (direction[index_of(axis)]) all.push_back(direction_of_approach(axis));
  }
  for (const std::string& channel : temperature) all.push_back(temperature_of(channel));
  if (time) all.push_back({Variable::Kind::Time});
  if (feed) all.push_back({Variable::Kind::Feed});
  return all;
}

/// What all copies share: the effects, and the poses' readings by thread.
struct MachineEffects::Shared {
  /// An effect, or a term of one that acts in several places.
  struct One {
    std::shared_ptr<const Effect> effect;
    std::string label;
    Eigen::VectorXd shape;
    EffectReach reach;
    std::array<bool, kAxisCount> uneven{};
    bool polynomial = false;
    Eigen::VectorXd coefficients = {};  ///< of a curve or surface, m or rad
    double rms = 0.0;                   ///< of a curve or surface over its range, m or rad
  };

  Shared(const FitResult& result, const Tool& of_tool, const Conditions& at)
      : machine(result.machine), tool(of_tool), conditions(at), number(next_number()) {
    if (result.conditions.time) clock_start = result.conditions.time->min;
  }

  static std::uint64_t next_number() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
  }

  /// Of this thread.
  PoseReadings& readings() const {
    thread_local std::uint64_t owner = 0;
    thread_local std::unique_ptr<PoseReadings> kept;
    if (owner != number) {
      kept = std::make_unique<PoseReadings>(machine, tool, conditions, clock_start);
      owner = number;
    }
    return *kept;
  }

  Machine machine;
  Tool tool;
  Conditions conditions;
  std::optional<double> clock_start;
  std::vector<One> effects;
  std::uint64_t number;
};

namespace {

/// Finds what an effect depends on.
class ReachProbe {
 public:
  ReachProbe(const Machine& machine, const Tool& tool, const Conditions& conditions,
             std::optional<double> clock_start)
      : machine_(machine), tool_(tool), conditions_(conditions), clock_start_(clock_start) {
    probe_poses(machine, positions_, directions_);
    shifted_ = positions_;
    std::rotate(shifted_.begin(), shifted_.begin() + 1, shifted_.end());
  }

  /// `named`: conditions that the effect is written of.
  EffectReach reach_of(const Effect& effect, const std::set<Variable>& named) {
    if (effect.surface() != nullptr) return reach_of_surface(effect);
    EffectReach reach;
    const Eigen::MatrixXd here = at(effect, conditions_, positions_, directions_);
    add_dependence(effect, conditions_, here, reach);
    for (const auto& [channel, value] : conditions_.temperature_degC) {
      Conditions warmer = conditions_;
      warmer.temperature_degC[channel] += 1.7;
      if (differs(effect, here, warmer, reach)) reach.temperature.insert(channel);
    }
    if (conditions_.time) {
      Conditions later = conditions_;
      *later.time += 1234.0;
      reach.time = differs(effect, here, later, reach);
    }
    if (conditions_.feed) {
      Conditions faster = conditions_;
      faster.feed = 1.3 * *conditions_.feed + 0.01;
      reach.feed = differs(effect, here, faster, reach);
    }
    if (!named.empty()) add_elsewhere(effect, named, reach);
    return reach;
  }

  std::array<bool, kAxisCount> uneven_directions(const Effect& effect, const EffectReach& reach) {
    std::array<bool, kAxisCount> uneven{};
    for (const Axis& axis : machine_.axes) {
      const std::size_t a = index_of(axis.name);
      if (!reach.direction[a]) continue;
      const auto approached = [&](std::int8_t direction) {
        auto directions = directions_;
        for (ApproachDirection& each : directions) each[a] = direction;
        return at(effect, conditions_, positions_, directions);
      };
      uneven[a] = differ(0.5 * (approached(-1) + approached(1)), approached(0));
    }
    return uneven;
  }

 private:
  /// All that it is drawn over: at the stated conditions it may have faded out.
  EffectReach reach_of_surface(const Effect& effect) {
    EffectReach reach;
    PoseReadings readings(machine_, tool_, conditions_, clock_start_);
    const SetupView& view = readings.at(positions_, directions_);
    const Eigen::MatrixXd faded = effect.faded_drivers(view);
    reach.acts = !effect.drivers(view, effect.shape_values()).isZero(0.0) || !faded.isZero(0.0);
    if (!reach.acts) return reach;
    for (const Variable& variable : effect.name().driver.variables()) {
      if (variable.kind == Variable::Kind::Position) reach.position[index_of(variable.axis)] = true;
      if (variable.kind == Variable::Kind::Direction) reach.direction[index_of(variable.axis)] = true;
      if (variable.kind == Variable::Kind::Time) reach.time = true;
      if (variable.kind == Variable::Kind::Feed) reach.feed = true;
      for (const auto& [channel, value] : conditions_.temperature_degC) {
        if (variable.written() == temperature_of(channel).written()) reach.temperature.insert(channel);
      }
    }
    return reach;
  }

  void add_dependence(const Effect& effect, const Conditions& conditions, const Eigen::MatrixXd& there,
                      EffectReach& reach) {
    if (!there.isZero(0.0)) reach.acts = true;
    for (const Axis& axis : machine_.axes) {
      const std::size_t a = index_of(axis.name);
      if (!reach.position[a])
        reach.position[a] = differ(there, at(effect, conditions, moved(a), directions_));
      if (!reach.direction[a])
        reach.direction[a] = differ(there, at(effect, conditions, positions_, turned(a)));
    }
  }

  /// An effect may act, and depend on what it is written of, where several conditions are far from the stated
  /// ones at once: a product of temperatures, a step in time.
  void add_elsewhere(const Effect& effect, const std::set<Variable>& named, EffectReach& reach) {
    constexpr std::array<double, 4> kFar = {1.0, -6.0, 7.0, 30.0};
    for (const double far : kFar) {
      try {
        const Conditions other = moved_by(far);
        add_dependence(effect, other, at(effect, other, positions_, directions_), reach);
      } catch (const InputError&) {  // an expression that is not finite there
      }
    }
    if (!reach.acts) return;
    for (const Variable& each : named) {
      if (each.kind == Variable::Kind::Time) reach.time |= conditions_.time.has_value();
      if (each.kind == Variable::Kind::Feed) reach.feed |= conditions_.feed.has_value();
      for (const auto& [channel, value] : conditions_.temperature_degC) {
        if (each.written() == temperature_of(channel).written()) reach.temperature.insert(channel);
      }
    }
  }

  /// Every temperature by its own multiple of a kelvin, time of 20 minutes and feed of 1 m/min.
  Conditions moved_by(double far) const {
    Conditions other = conditions_;
    double step = 1.7;
    for (auto& [channel, value] : other.temperature_degC) {
      value += far * step;
      step *= 1.13;
    }
    if (other.time) *other.time = std::max(0.0, *other.time + far * 1234.0);
    if (other.feed) *other.feed = std::max(0.0, *other.feed + far * 0.017);
    return other;
  }

  Eigen::MatrixXd at(const Effect& effect, const Conditions& conditions,
                     std::span<const AxisPosition> positions, std::span<const ApproachDirection> directions) {
    PoseReadings readings(machine_, tool_, conditions, clock_start_);
    return effect.drivers(readings.at(positions, directions), effect.shape_values());
  }

  /// A condition at which an effect begins to act may hide what else it depends on.
  bool differs(const Effect& effect, const Eigen::MatrixXd& here, const Conditions& other,
               EffectReach& reach) {
    const Eigen::MatrixXd there = at(effect, other, positions_, directions_);
    if (!differ(here, there)) return false;
    add_dependence(effect, other, there, reach);
    reach.acts = true;
    return true;
  }

  std::vector<AxisPosition> moved(std::size_t axis) const {
    std::vector<AxisPosition> positions = positions_;
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i][axis] = shifted_[i][axis];
    return positions;
  }

  std::vector<ApproachDirection> turned(std::size_t axis) const {
    std::vector<ApproachDirection> directions = directions_;
    for (ApproachDirection& direction : directions)
      direction[axis] = static_cast<std::int8_t>(-direction[axis]);
    return directions;
  }

  const Machine& machine_;
  const Tool& tool_;
  Conditions conditions_;
  std::optional<double> clock_start_;
  std::vector<AxisPosition> positions_, shifted_;
  std::vector<ApproachDirection> directions_;
};

int parameter_of(const FitResult& result, const std::string& label) {
  const std::optional<int> place = result.layout.find_parameter(label);
  if (!place) throw std::logic_error("an effect's parameter is missing: " + label);
  return *place;
}

}  // namespace

MachineEffects::MachineEffects(const FitResult& result, const Tool& tool, const Conditions& conditions) {
  auto shared = std::make_shared<Shared>(result, tool, conditions);
  std::optional<ReachProbe> probe;
  for (const EffectSpec& spec : result.identified.effects) {
    const EffectKind* kind = find_effect(spec.kind);
    if (kind == nullptr) throw std::logic_error("an effect of the result is not registered: " + spec.kind);
    for (std::shared_ptr<const Effect>& effect : single_terms(kind->make(spec, result.identified.file))) {
      Shared::One one;
      one.effect = std::move(effect);
      if (!acts_on_machine(*one.effect)) continue;
      if (!probe) probe.emplace(shared->machine, shared->tool, conditions, shared->clock_start);
      one.reach = probe->reach_of(*one.effect, conditions_of_effect(spec, *one.effect));
      if (!one.reach.acts) continue;
      one.label = effect_label(*one.effect);
      one.shape = one.effect->shape_values();
      const auto& shapes = one.effect->shapes();
      for (std::size_t s = 0; s < shapes.size(); ++s) {
        if (const ParameterBlock* block = result.layout.find_block(shapes[s].label))
          one.shape[static_cast<Eigen::Index>(s)] = result.parameters[block->offset];
      }
      one.polynomial = kind->schema().polynomial;
      one.uneven = probe->uneven_directions(*one.effect, one.reach);
      if (const TensorBasis* surface = one.effect->surface()) {
        one.coefficients.resize(surface->size());
        for (int k = 0; k < surface->size(); ++k)
          one.coefficients[k] = result.parameters[parameter_of(
              result, one.effect->amplitudes()[static_cast<std::size_t>(k)].label)];
        one.rms = surface->root_mean_square(one.coefficients);
      }
      shared->effects.push_back(std::move(one));
    }
  }
  std::vector<EffectColumn> slopes;
  for (std::size_t e = 0; e < shared->effects.size(); ++e) {
    const Effect& effect = *shared->effects[e].effect;
    used_.push_back(e);
    for (std::size_t a = 0; a < kAxisCount; ++a) uneven_in_direction_[a] |= shared->effects[e].uneven[a];
    for (std::size_t k = 0; k < effect.amplitudes().size(); ++k) {
      const EffectAmplitude& amplitude = effect.amplitudes()[k];
      const int parameter = parameter_of(result, amplitude.label);
      const EffectColumn column{e, static_cast<int>(k), -1, amplitude.target, parameter, parameter};
      columns_.push_back(column);
      for (std::size_t s = 0; s < effect.shapes().size(); ++s) {
        const ParameterBlock* block = result.layout.find_block(effect.shapes()[s].label);
        if (block == nullptr) continue;
        slopes.push_back(column);
        slopes.back().shape = static_cast<int>(s);
        slopes.back().parameter = block->offset;
      }
    }
  }
  amplitude_count_ = columns_.size();
  columns_.insert(columns_.end(), slopes.begin(), slopes.end());
  shared_ = std::move(shared);
}

const EffectName& MachineEffects::name(std::size_t i) const { return shared_->effects[i].effect->name(); }
const std::string& MachineEffects::label(std::size_t effect) const { return shared_->effects[effect].label; }
const EffectReach& MachineEffects::reach(std::size_t effect) const { return shared_->effects[effect].reach; }
std::size_t MachineEffects::effect_count() const { return shared_->effects.size(); }
bool MachineEffects::is_surface(std::size_t effect) const {
  return shared_->effects[effect].effect->surface() != nullptr;
}
bool MachineEffects::is_polynomial(std::size_t effect) const { return shared_->effects[effect].polynomial; }

MachineEffects MachineEffects::subset(std::span<const std::size_t> effects) const {
  MachineEffects part = *this;
  part.used_.assign(effects.begin(), effects.end());
  std::erase_if(part.columns_, [&](const EffectColumn& column) {
    return std::ranges::find(effects, column.effect) == effects.end();
  });
  part.amplitude_count_ = static_cast<std::size_t>(
      std::ranges::count(part.columns_, -1, [](const EffectColumn& column) { return column.shape; }));
  part.uneven_in_direction_ = {};
  for (const std::size_t e : effects) {
    for (std::size_t a = 0; a < kAxisCount; ++a)
      part.uneven_in_direction_[a] |= shared_->effects[e].uneven[a];
  }
  return part;
}

Eigen::MatrixXd MachineEffects::at_given_directions(std::span<const AxisPosition> positions,
                                                    std::span<const ApproachDirection> directions,
                                                    bool slopes) const {
  const SetupView& view = shared_->readings().at(positions, directions);
  const std::size_t count = slopes ? columns_.size() : amplitude_count_;
  Eigen::MatrixXd all(static_cast<Eigen::Index>(positions.size()), static_cast<Eigen::Index>(count));
  for (const std::size_t e : used_) {
    const Shared::One& one = shared_->effects[e];
    const Eigen::MatrixXd drivers = one.effect->drivers(view, one.shape);
    std::vector<Eigen::MatrixXd> slope(static_cast<std::size_t>(slopes ? one.shape.size() : 0));
    for (std::size_t s = 0; s < slope.size(); ++s) {
      const auto index = static_cast<Eigen::Index>(s);
      const double step = kShapeStep * std::max(std::abs(one.shape[index]), one.effect->shapes()[s].sigma);
      if (!(step > 0.0)) continue;
      Eigen::VectorXd above = one.shape, below = one.shape;
      above[index] += step;
      below[index] -= step;
      slope[s] = (one.effect->drivers(view, above) - one.effect->drivers(view, below)) /
                 (above[index] - below[index]);
    }
    for (std::size_t c = 0; c < count; ++c) {
      const EffectColumn& column = columns_[c];
      if (column.effect != e) continue;
      const Eigen::MatrixXd& source =
          column.shape < 0 ? drivers : slope[static_cast<std::size_t>(column.shape)];
      all.col(static_cast<Eigen::Index>(c)) = source.col(column.amplitude);
    }
  }
  return all;
}

/// At direction 0 the mean of both, axis by axis.
Eigen::MatrixXd MachineEffects::evaluate(std::span<const AxisPosition> positions,
                                         std::span<const ApproachDirection> directions, bool slopes) const {
  for (std::size_t a = 0; a < kAxisCount; ++a) {
    const auto is_mean = [a](const ApproachDirection& direction) { return direction[a] == 0; };
    if (!uneven_in_direction_[a] || std::ranges::none_of(directions, is_mean)) continue;
    std::vector<ApproachDirection> minus(directions.begin(), directions.end()), plus = minus;
    for (std::size_t i = 0; i < minus.size(); ++i) {
      if (!is_mean(directions[i])) continue;
      minus[i][a] = -1;
      plus[i][a] = 1;
    }
    return 0.5 * (evaluate(positions, minus, slopes) + evaluate(positions, plus, slopes));
  }
  return at_given_directions(positions, directions, slopes);
}

Eigen::MatrixXd MachineEffects::drivers(std::span<const AxisPosition> positions,
                                        std::span<const ApproachDirection> directions) const {
  return evaluate(positions, directions, false);
}

Eigen::MatrixXd MachineEffects::faded_drivers(std::span<const AxisPosition> positions,
                                              std::span<const ApproachDirection> directions) const {
  Eigen::MatrixXd all;
  if (std::ranges::none_of(used_, [this](std::size_t e) { return is_surface(e); })) return all;
  const SetupView& view = shared_->readings().at(positions, directions);
  for (const std::size_t e : used_) {
    const Eigen::MatrixXd lost = shared_->effects[e].effect->faded_drivers(view);
    if (lost.size() == 0) continue;
    if (all.size() == 0)
      all = Eigen::MatrixXd::Zero(lost.rows(), static_cast<Eigen::Index>(amplitude_count_));
    for (std::size_t c = 0; c < amplitude_count_; ++c) {
      if (columns_[c].effect == e) all.col(static_cast<Eigen::Index>(c)) = lost.col(columns_[c].amplitude);
    }
  }
  return all;
}

std::vector<FadedSurface> MachineEffects::faded_surfaces(const AxisPosition& position,
                                                         const ApproachDirection& direction) const {
  std::vector<FadedSurface> faded;
  const SetupView* view = nullptr;
  for (const std::size_t e : used_) {
    const Shared::One& one = shared_->effects[e];
    if (one.effect->surface() == nullptr) continue;
    if (view == nullptr) view = &shared_->readings().at({&position, 1}, {&direction, 1});
    const Eigen::MatrixXd lost = one.effect->faded_drivers(*view);
    if (lost.size() == 0) continue;
    const double share = lost.sum();  // splines add up to 1
    faded.push_back({e, one.effect->amplitudes().front().target,
                     std::max(std::abs(lost.row(0).dot(one.coefficients)), std::abs(share) * one.rms)});
  }
  return faded;
}

Eigen::MatrixXd MachineEffects::drivers_and_slopes(std::span<const AxisPosition> positions,
                                                   std::span<const ApproachDirection> directions) const {
  return evaluate(positions, directions, true);
}

std::vector<EffectOnNoPose> effects_on_no_pose(const FitResult& result) {
  std::vector<EffectOnNoPose> found;
  if (result.identified.effects.empty()) return found;
  const Conditions conditions = default_conditions(result);
  std::optional<double> clock_start;
  if (result.conditions.time) clock_start = result.conditions.time->min;
  for (const EffectSpec& spec : result.identified.effects) {
    const EffectKind* kind = find_effect(spec.kind);
    if (kind == nullptr) continue;
    const std::unique_ptr<Effect> effect = kind->make(spec, result.identified.file);
    if (!acts_on_machine(*effect)) continue;
    const std::set<Variable> named = conditions_of_effect(spec, *effect);
    const bool acts = std::ranges::any_of(result.machine.functional_tools(), [&](const Tool& tool) {
      return ReachProbe(result.machine, tool, conditions, clock_start).reach_of(*effect, named).acts;
    });
    if (!acts) found.push_back({effect_label(*effect), named});
  }
  return found;
}

}  // namespace volcal
