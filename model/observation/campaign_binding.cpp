#include "volcal/model/observation/campaign_binding.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/measured_ends.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/lagged_channel.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr double kShapeStep = 1e-6;         // of central differences, relative; drivers are smooth
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

ParameterBlock effect_block(const EffectAmplitude& amplitude) {
  ParameterBlock block =
      scalar_block(ParameterKind::Effect, amplitude.label, amplitude.unit(), amplitude.si_per_unit());
  block.guess[0] = amplitude.guess;
  return block;
}

/// The coefficients of one function.
ParameterBlock surface_block(const Effect& effect) {
  const auto size = static_cast<Eigen::Index>(effect.amplitudes().size());
  const EffectAmplitude& first = effect.amplitudes().front();
  ParameterBlock block =
      scalar_block(ParameterKind::Effect, common_label(effect), first.unit(), first.si_per_unit());
  block.units.assign(effect.amplitudes().size(), block.units.front());
  block.si_per_unit.assign(effect.amplitudes().size(), block.si_per_unit.front());
  block.guess = block.prior_mean = block.prior_sigma = Eigen::VectorXd::Zero(size);
  block.labels.clear();
  for (Eigen::Index k = 0; k < size; ++k) {
    block.labels.push_back(std::to_string(k + 1));
    block.guess[k] = effect.amplitudes()[static_cast<std::size_t>(k)].guess;
  }
  return block;
}

ParameterBlock shape_block(const EffectShape& shape) {
  ParameterBlock block =
      scalar_block(ParameterKind::EffectShape, shape.label, shape.unit(), shape.si_per_unit());
  block.guess[0] = block.prior_mean[0] = shape.value;
  block.prior_sigma[0] = shape.sigma;
  return block;
}

/// `known`: what its offset is known to be wrong by.
ParameterBlock tool_block(const Tool& tool, const Eigen::Vector3d& known) {
  ParameterBlock block;
  block.kind = ParameterKind::ToolOffset;
  block.name = tool_parameter(tool.name);
  block.labels = {"x", "y", "z"};
  block.units = {"um", "um", "um"};
  block.si_per_unit = {kMetrePerMicrometre, kMetrePerMicrometre, kMetrePerMicrometre};
  block.guess = block.prior_mean = known;
  block.prior_sigma = Eigen::VectorXd::Constant(3, tool.offset_sigma);
  block.is_held = tool.offset_sigma == 0.0;
  return block;
}

/// Printed in mm (places), urad (angles) or ppm (scales).
ParameterBlock nuisance_block(const NuisanceBlock& nuisance) {
  ParameterBlock block;
  block.kind = ParameterKind::Nuisance;
  block.name = nuisance.name;
  block.labels = nuisance.labels;
  block.guess = nuisance.guess;
  block.prior_mean = nuisance.prior_mean;
  block.prior_sigma = nuisance.prior_sigma;
  block.weak_default_prior = nuisance.weak_default_prior;
  const bool is_scale = is_length_scale(block.name);
  for (int k = 0; k < nuisance.size(); ++k) {
    const bool angle = nuisance.is_angle[static_cast<std::size_t>(k)];
    block.units.emplace_back(is_scale ? "ppm" : angle ? "urad" : "mm");
    block.si_per_unit.push_back(angle ? kRadianPerMicroradian : kMetrePerMillimetre);
  }
  return block;
}

/// Joins a setup's nuisance block to an existing one of the same name: guesses averaged, priors multiplied.
/// `merged` setups have joined so far.
void merge_nuisance(ParameterBlock& block, const NuisanceBlock& other, int merged, const SourcePlace& place) {
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
      if (is_length_scale(block.name)) continue;  // one and the same statement, made in every setup
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
}

int joint_of(const Machine& machine, AxisName axis) {
  const auto& joints = machine.structure.joints;
  const auto found = std::ranges::find(joints, axis, &Joint::axis);
  if (found == joints.end()) throw std::logic_error("axis is not a joint of the chain");
  return static_cast<int>(found - joints.begin());
}

class CampaignBinder {
 public:
  CampaignBinder(const Campaign& campaign, const ModelSpec& spec, const KinematicChain& chain)
      : campaign_(campaign), machine_(campaign.machine), spec_(spec), chain_(chain) {}

  CampaignBinding bind() {
    for (const Axis& axis : machine_.axes) {
      if (is_rotary(axis.name) || is_parallel(axis.name)) continue;
      binding_.floor_pivot_w[direction_of(axis.name)] = 0.5 * (axis.travel_min + axis.travel_max);
    }
    add_function_groups();
    for (const LocationSymbol& symbol : modelled_locations(machine_, spec_)) add_location(symbol);
    for (const Axis& axis : machine_.axes) add_expansion(axis);
    for (const EffectSpec& effect : spec_.effects) add_effect(effect);
    for (const Setup& setup : campaign_.setups) add_tool(setup.tool);
    add_unused_tools();
    for (const Setup& setup : campaign_.setups) add_setup(setup);
    tabulate_effects();
    return std::move(binding_);
  }

 private:
  ParameterLayout& layout() { return binding_.layout; }

  /// Offset of the new block.
  int add_block(ParameterBlock block) {
    block.offset = layout().size;
    layout().size += block.size();
    layout().blocks.push_back(std::move(block));
    return layout().blocks.back().offset;
  }

  MotionTerm motion_term(ErrorSymbol symbol, int parameter) const {
    return {joint_of(machine_, symbol.axis), static_cast<int>(index_of(symbol.component)), parameter};
  }

  /// Groups the functions of an axis that have the same basis.
  void add_function_groups() {
    using Key = std::tuple<AxisName, std::string, int, std::vector<double>>;
    std::map<Key, std::size_t> group_of;
    for (const ErrorSymbol symbol : modelled_motions(machine_, spec_)) {
      const FunctionSpec& function = spec_.function(symbol);
      const BasisKind* kind = find_basis(function.basis);
      if (kind == nullptr) throw std::invalid_argument("unknown basis " + function.basis);
      std::shared_ptr<const Basis> basis = kind->make(function, machine_.axis(symbol.axis));
      if (basis->size() == 0) continue;
      const auto [place, is_new] = group_of.try_emplace(
          {symbol.axis, function.basis, function.degree, function.breakpoints}, layout().groups.size());
      if (is_new) {
        layout().groups.push_back({symbol.axis, std::move(basis), {}, 0});
        binding_.groups.push_back({symbol.axis, joint_of(machine_, symbol.axis), {}});
      }
      layout().groups[place->second].symbols.push_back(symbol);
      binding_.groups[place->second].component.push_back(static_cast<int>(index_of(symbol.component)));
    }
    for (FunctionGroup& group : layout().groups) {
      group.offset = layout().size;
      layout().size += group.size();
    }
    layout().function_size = layout().size;
  }

  void add_location(LocationSymbol symbol) {
    const bool angle = is_rotation(symbol.component);
    ParameterBlock block =
        scalar_block(ParameterKind::Location, symbol.name(), angle ? "urad" : "um", kMicro);
    block.location = symbol;
    const int parameter = add_block(std::move(block));

    // Which motion it is, and its sign: what it does to a lever without arm, at position 1.
    const int joint = joint_of(machine_, symbol.axis);
    JointLever lever;
    lever.axis = symbol.axis;
    lever.workpiece_side = machine_.structure.joints[static_cast<std::size_t>(joint)].workpiece_side;
    lever.position = 1.0;
    Eigen::Matrix<double, 6, 1> motion;
    motion << KinematicChain::location_lever_w(lever, symbol.component),
        KinematicChain::location_rotation_w(lever, symbol.component);
    int component = 0;
    motion.cwiseAbs().maxCoeff(&component);
    const MotionTerm term{joint, component, parameter};
    binding_.locations.push_back({term, symbol.axis, motion[component], !is_rotary(symbol.axis)});
    binding_.shared_terms.push_back(term);
  }

  void add_effect(const EffectSpec& effect) {
    const SourcePlace place{spec_.file, effect.source_line};
    const EffectKind* kind = find_effect(effect.kind);
    if (kind == nullptr) throw InputError(place, "unknown effect \"" + effect.kind + "\"", "");
    EffectBinding binding;
    binding.effect = kind->make(effect, spec_.file);
    binding.effect->check(campaign_, place);
    binding.first_parameter = layout().size;
    for (const EffectAmplitude& amplitude : binding.effect->amplitudes()) {
      if (layout().find_parameter(amplitude.label)) {
        throw InputError(place, "effect \"" + amplitude.label + "\" is given twice", "delete one of the two");
      }
      if (binding.effect->surface() == nullptr) add_block(effect_block(amplitude));
    }
    if (binding.effect->surface() != nullptr) add_block(surface_block(*binding.effect));
    for (const EffectTerm& term : binding.effect->terms()) {
      binding.target.push_back(disturbance_of(term.target, machine_));
      binding.amplitude.push_back(static_cast<int>(term.amplitude));
      binding_.effect_moves_tool |= term.target.kind == TargetKind::ToolOffset;
      binding_.effect_tilts_floor |= term.target.kind == TargetKind::Floor;
    }
    binding.shape = binding.effect->shape_values();
    const auto& shapes = binding.effect->shapes();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      if (shapes[i].sigma == 0.0) continue;
      binding.free_shape.push_back(static_cast<int>(i));
      add_block(shape_block(shapes[i]));
    }
    binding_.effect_parameters += binding.parameter_count();
    binding_.effect_drivers += binding.term_count() * (1 + static_cast<int>(binding.free_shape.size()));
    binding_.effects.push_back(std::move(binding));
  }

  void add_expansion(const Axis& axis) {
    if (!axis.expansion) return;
    int parameter = -1;
    const auto known = spec_.expansions.find(axis.name);
    const bool is_known = known != spec_.expansions.end();
    if (axis.expansion->per_kelvin_sigma > 0.0 || is_known) {
      ParameterBlock block =
          scalar_block(ParameterKind::Expansion, expansion_parameter(axis.name), "um/m/K", kMicro);
      if (is_known) block.guess[0] = known->second - axis.expansion->per_kelvin;
      block.prior_sigma[0] = axis.expansion->per_kelvin_sigma;
      block.is_held = axis.expansion->per_kelvin_sigma == 0.0;
      parameter = add_block(std::move(block));
    }
    ExpansionBinding expansion;
    expansion.term = motion_term({positioning_component(axis.name), axis.name}, parameter);
    expansion.axis = axis.name;
    expansion.per_kelvin = axis.expansion->per_kelvin;
    expansion.home = axis.home;
    expansions_.push_back(expansion);
    if (parameter >= 0) binding_.shared_terms.push_back(expansion.term);
  }

  void tabulate_effects() {
    if (binding_.effects.empty()) return;
    const std::vector<SetupView> views = setup_views(campaign_, binding_, chain_);
    const Campaign held = spec_.measured.empty() ? Campaign{} : held_campaign();
    const std::vector<SetupView> held_views =
        spec_.measured.empty() ? std::vector<SetupView>{} : setup_views(held, binding_, chain_);
    for (EffectBinding& effect : binding_.effects)
      tabulate_drivers(held_views.empty() || !acts_on_machine(effect) ? views : held_views, effect);
  }

  static bool acts_on_machine(const EffectBinding& binding) {
    return std::ranges::all_of(binding.effect->terms(), [](const EffectTerm& term) {
      return term.target.kind == TargetKind::Motion || term.target.kind == TargetKind::ToolOffset;
    });
  }

  /// With positions beyond those that stated errors follow from moved to the last of these.
  Campaign held_campaign() const {
    Campaign held = campaign_;
    for (Setup& setup : held.setups) {
      for (const auto& [axis, stated] : spec_.measured) {
        const MeasuredEnds ends = measured_ends(campaign_.machine.axis(axis), spec_);
        for (double& position : setup.readings.position[index_of(axis)]) position = ends.nearest(position);
      }
    }
    return held;
  }

  void add_tool(std::size_t number) {
    const Tool& tool = machine_.tools[number];
    const auto known = spec_.tool_errors.find(tool.name);
    const bool is_known = known != spec_.tool_errors.end();
    if ((tool.offset_sigma == 0.0 && !is_known) || tool_parameter_.contains(number)) return;
    tool_parameter_[number] = add_block(tool_block(tool, is_known ? known->second : Eigen::Vector3d::Zero()));
  }

  /// Of tools that no setup has and whose error is known: results have it, too.
  void add_unused_tools() {
    for (std::size_t number = 0; number < machine_.tools.size(); ++number) {
      const auto known = spec_.tool_errors.find(machine_.tools[number].name);
      if (known == spec_.tool_errors.end() || tool_parameter_.contains(number)) continue;
      ParameterBlock block = tool_block(machine_.tools[number], known->second);
      block.is_held = true;
      add_block(std::move(block));
    }
  }

  void add_setup(const Setup& setup) {
    SetupBinding binding;
    binding.tool_offset = machine_.tools[setup.tool].offset;
    const auto tool = tool_parameter_.find(setup.tool);
    if (tool != tool_parameter_.end()) binding.tool_error = tool->second;
    for (ExpansionBinding expansion : expansions_) {
      expansion.temperature_degC = &temperature_of(setup, machine_.axis(expansion.axis));
      binding.expansions.push_back(expansion);
    }
    binding.bound = bind_instrument(setup, binding.tool_offset);
    for (const NuisanceBlock& nuisance : binding.bound->nuisance()) {
      const ParameterBlock& block = add_nuisance(nuisance, setup);
      for (int k = 0; k < block.size(); ++k) binding.nuisance.push_back(block.offset + k);
    }
    for (int channel = 0; channel < binding.bound->channels(); ++channel)
      binding.noise_constant[channel] = binding.bound->noise_constant(setup.noise, channel);
    binding.noise_per_metre = setup.noise.number("per_metre").value_or(0.0);
    binding_.setups.push_back(std::move(binding));
  }

  static const std::vector<double>& temperature_of(const Setup& setup, const Axis& axis) {
    const auto channel = setup.readings.temperature.find(axis.expansion->channel);
    if (channel != setup.readings.temperature.end()) return channel->second;
    throw InputError({setup.data, 1},
                     "column T_" + axis.expansion->channel + "_degC is missing, but the expansion of axis " +
                         letter_of(axis.name) + " needs it",
                     "add the column or delete the axis's temperature from the machine file");
  }

  std::unique_ptr<BoundSetup> bind_instrument(const Setup& setup, const Eigen::Vector3d& tool_offset) const {
    const Instrument* instrument = find_instrument(setup.instrument);
    if (instrument == nullptr) {
      throw InputError({campaign_.file, setup.source_line}, "unknown instrument \"" + setup.instrument + "\"",
                       "");
    }
    SetupContext context{setup, machine_, campaign_.file, {}};
    context.nominal_point_w.reserve(setup.readings.size());
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      context.nominal_point_w.push_back(
          chain_.nominal_point_w(setup.readings.commanded_position(row), tool_offset));
    }
    return instrument->bind(std::move(context));
  }

  /// The block of this name, new or merged into.
  const ParameterBlock& add_nuisance(const NuisanceBlock& nuisance, const Setup& setup) {
    const auto [place, is_new] = nuisance_place_.try_emplace(nuisance.name, layout().blocks.size(), 1);
    auto& [index, merged] = place->second;
    if (is_new) {
      add_block(nuisance_block(nuisance));
    } else {
      merge_nuisance(layout().blocks[index], nuisance, merged++, {campaign_.file, setup.source_line});
    }
    return layout().blocks[index];
  }

  const Campaign& campaign_;
  const Machine& machine_;
  const ModelSpec& spec_;
  const KinematicChain& chain_;
  CampaignBinding binding_;
  std::vector<ExpansionBinding> expansions_;
  std::map<std::size_t, int> tool_parameter_;
  std::map<std::string, std::pair<std::size_t, int>>
      nuisance_place_;  ///< name -> index of the block, number of setups merged into it
};

}  // namespace

CampaignBinding bind_campaign(const Campaign& campaign, const ModelSpec& spec, const KinematicChain& chain) {
  return CampaignBinder(campaign, spec, chain).bind();
}

int disturbance_of(const EffectTarget& target, const Machine& machine) {
  switch (target.kind) {
    case TargetKind::Motion:
      return 6 * joint_of(machine, target.symbol.axis) + static_cast<int>(index_of(target.symbol.component));
    case TargetKind::ToolOffset:
      return kToolDisturbance + target.component;
    case TargetKind::Station:
      return kStationDisturbance + target.component;
    case TargetKind::Floor:
      return kFloorDisturbance + target.component;
    case TargetKind::Reading:
      return kReadingDisturbance + target.component;
  }
  throw std::logic_error("unknown target of an effect");
}

std::vector<SetupView> setup_views(const Campaign& campaign, const CampaignBinding& binding,
                                   const KinematicChain& chain) {
  std::vector<SetupView> views;
  const double first_time = time_span(campaign).first;
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Setup& setup = campaign.setups[i];
    SetupView view{campaign, setup, {}, Eigen::VectorXd(static_cast<Eigen::Index>(setup.readings.size()))};
    view.clock_start = first_time;
    view.histories = std::make_shared<KeptHistories>();
    view.nominal_point_w.reserve(setup.readings.size());
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      view.nominal_point_w.push_back(
          chain.nominal_point_w(setup.readings.commanded_position(row), binding.setups[i].tool_offset));
      view.length[static_cast<Eigen::Index>(row)] = binding.setups[i].bound->noise_length(row, 0);
    }
    views.push_back(std::move(view));
  }
  return views;
}

void tabulate_drivers(const std::vector<SetupView>& views, EffectBinding& binding) {
  const Effect& effect = *binding.effect;
  binding.driver.clear();
  binding.slope.assign(binding.free_shape.size(), {});
  for (const SetupView& view : views) {
    binding.driver.emplace_back(effect.drivers(view, binding.shape));
    for (std::size_t i = 0; i < binding.free_shape.size(); ++i) {
      const int index = binding.free_shape[i];
      const double step = kShapeStep * std::max(std::abs(binding.shape[index]),
                                                effect.shapes()[static_cast<std::size_t>(index)].sigma);
      Eigen::VectorXd above = binding.shape, below = binding.shape;
      above[index] += step;
      below[index] -= step;
      binding.slope[i].emplace_back((effect.drivers(view, above) - effect.drivers(view, below)) /
                                    (above[index] - below[index]));
    }
  }
}

}  // namespace volcal
