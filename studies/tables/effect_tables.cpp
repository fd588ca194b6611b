#include "volcal/studies/tables/effect_tables.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/study.h"
#include "volcal/studies/files/control_tables.h"
#include "volcal/studies/tables/exact_machine.h"
#include "volcal/studies/tables/rigid_ideal.h"

namespace volcal::studies {
namespace {

constexpr const char* kTool = "side_x";
constexpr const char* kChannel = "column";
constexpr double kTemperature_degC = 23.0;
constexpr double kLargestReversal = 4e-6;  // m, largest

/// What is hidden in the machine, and what the extended model has of it.
struct EffectCase {
  std::string name;
  std::vector<sim::HiddenEffect> hidden;
  std::vector<EffectSpec> effects;
};

sim::HiddenEffect hidden(const std::string& kind, std::vector<std::pair<std::string, std::string>> texts,
                         double amplitude) {
  sim::HiddenEffect effect{kind, {}, amplitude};
  for (const auto& [key, text] : texts) effect.options.set(key, text);
  return effect;
}

std::vector<EffectCase> all_cases() {
  const sim::HiddenEffect coupled = hidden("cross-axis", {{"symbol", "EAY"}, {"by", "X"}}, 60e-6);
  const EffectSpec coupling =
      effect_spec("axis-coupling", {{"symbol", "EAY"}, {"axis", "X"}, {"shape", "linear"}});
  const sim::HiddenEffect turning = hidden("reversal-position", {{"symbol", "EXX"}}, 12e-6);
  const EffectSpec reversal = effect_spec("position-reversal", {{"symbol", "EXX"}});
  return {
      {"coupled", {coupled}, {coupling}},
      {"product",
       {hidden("cross-product", {{"symbol", "EAY"}, {"by", "Y"}, {"and", "Z"}}, 60e-6)},
       {effect_spec("product-coupling", {{"symbol", "EAY"}, {"axis", "Y"}, {"second_axis", "Z"}})}},
      {"reversal", {turning}, {reversal}},
      {"expansion",
       {hidden("scale-expansion", {{"axis", "X"}, {"channel", kChannel}}, 10e-6)},
       {effect_spec("scale-expansion", {{"axis", "X"}, {"temperature", kChannel}})}},
      {"tool",
       {hidden("tool-load", {{"symbol", "EBX"}, {"tool", kTool}}, 40e-6)},
       {effect_spec("tool-load", {{"symbol", "EBX"}, {"tool", kTool}})}},
      {"pair", {coupled, turning}, {coupling, reversal}},
  };
}

ModelSpec model_with(const std::vector<EffectSpec>& effects) {
  ModelSpec model;
  for (const AxisName axis : kLinearAxes) {
    const ErrorSymbol symbol{positioning_component(axis), axis};
    model.effects.push_back(effect_spec("reversal", {{"symbol", symbol.name()}}));
  }
  model.effects.insert(model.effects.end(), effects.begin(), effects.end());
  return model;
}

sim::Study hiding_study(const EffectTablesOptions& options, int structure, const EffectCase& effect) {
  sim::Study study;
  study.machine = sim::reference_machines()[static_cast<std::size_t>(structure)];
  study.seed = options.seed + static_cast<std::uint64_t>(structure);
  study.truth.random.reversal_max = kLargestReversal;
  sim::TemperatureChannel channel;
  channel.name = kChannel;
  channel.start = 21.0;
  channel.drift = 0.8 / kSecondsPerHour;
  channel.amplitude = 0.5;
  channel.period = 5400.0;
  study.environment.channels.push_back(channel);
  sim::Tracking tracking;
  tracking.noise.constant *= options.noise;
  tracking.noise.per_metre *= options.noise;
  tracking.noise.repeatability *= options.noise;
  study.measurements.emplace_back().settings = tracking;
  study.hidden = effect.hidden;
  return study;
}

/// One machine with one effect, measured, identified twice, compensated with every format.
class MachineWithEffect {
 public:
  MachineWithEffect(const EffectTablesOptions& options, int structure, const EffectCase& effect)
      : study_(hiding_study(options, structure, effect)),
        effect_(effect),
        simulated_(sim::simulate(study_)),
        points_(volume_points(study_.machine, kVolumeCells)),
        lattice_(volume_lattice(study_.machine, kVolumeCells)) {
    std::erase_if(points_, [](const VolumePoint& point) { return !point.inside; });
    surroundings_.temperature[kChannel] = kTemperature_degC;
    surroundings_.tool = *study_.machine.tool_index(kTool);
    surroundings_.settled = true;
    tool_ = study_.machine.tools[surroundings_.tool].offset;
  }

  std::vector<EffectTablesRow> rows(const std::vector<std::string>& formats) const {
    const FitResult rigid = identify({}), extended = identify(effect_.effects);
    std::vector<EffectTablesRow> rows;
    for (const TableFormat* format : table_formats()) {
      if (is_wanted(*format, formats)) rows.push_back(row_of(*format, rigid, extended));
    }
    return rows;
  }

 private:
  FitResult identify(const std::vector<EffectSpec>& effects) const {
    FitOptions options;
    options.threads = 1;
    options.noise = NoisePolicy::White;
    return fit(simulated_.campaign, model_with(effects), options);
  }

  TableFormatOptions options_of(const TableFormat& format, const FitResult& result) const {
    TableFormatOptions options = study_table_options(format, format.supported, kTool);
    options.conditions = default_conditions(result);
    for (auto& [channel, temperature] : options.conditions->temperature_degC) temperature = kTemperature_degC;
    options.step = choose_step(format, result, options, kStudyTableTolerance).step;
    return options;
  }

  EffectTablesRow row_of(const TableFormat& format, const FitResult& rigid, const FitResult& extended) const {
    EffectTablesRow row;
    row.structure = study_.machine.structure.code;
    row.effect = effect_.name;
    row.format = format.name;
    row.type = format.supported.name();
    row.volumetric = !format.rigid && format.limits.both_directions &&
                     format.supported.contains(CompensationType::volumetric());
    row.before = judged(simulated_.truth);
    row.ideal = ideal(format);
    row.rigid = applied(format, write_tables(format, rigid, options_of(format, rigid)));
    const TableFormatOptions options = options_of(format, extended);
    const std::vector<TableFile> files = write_tables(format, extended, options);
    row.extended = applied(format, files);
    const VolumeCheck check = check_in_volume(extended, options, format.read(files));
    row.uncertainty = check.identification_u;
    row.printed = check.expected_rms();
    return row;
  }

  double judged(const sim::TruthMachine& machine) const {
    return exact_rms({machine, surroundings_, tool_}, points_);
  }

  double applied(const TableFormat& format, const std::vector<TableFile>& files) const {
    sim::TruthMachine machine = simulated_.truth;
    machine.set_correction(sim::command_correction({control_tables(format, files), 0.0, {}}));
    return judged(machine);
  }

  Eigen::Vector3d true_error(const VolumePoint& point) const {
    return exact_error({simulated_.truth, surroundings_, tool_}, point);
  }

  double ideal(const TableFormat& format) const {
    const bool both = format.limits.both_directions;
    const DisplacementField errors = [this](const AxisPosition& position,
                                            const ApproachDirection& direction) {
      return true_error({position, direction});
    };
    Compensation::LineField along;
    if (format.rigid) {
      const auto rigid = std::make_shared<const RigidIdeal>(
          study_.machine, lattice_, [this](const VolumePoint& point) { return true_error(point); }, both);
      if (format.supported.contains(CompensationType::volumetric())) return rms_of(rigid->left());
      along = [rigid](AxisName axis, double q, int direction) { return rigid->along(axis, q, direction); };
    }
    const Compensation compensation(study_.machine, middle_of_travel(study_.machine), format.supported,
                                    errors, along);
    sim::TruthMachine machine = simulated_.truth;
    machine.set_correction([&compensation, both](const sim::MachineState& state) {
      return compensation.correction(state.position, both ? state.direction : ApproachDirection{});
    });
    return judged(machine);
  }

  double rms_of(const std::vector<Eigen::Vector3d>& errors) const {
    std::vector<Eigen::Vector3d> places;
    for (const VolumePoint& point : lattice_)
      places.emplace_back(point.position[0], point.position[1], point.position[2]);
    return sim::rms_after_alignment(places, errors);
  }

  sim::Study study_;
  const EffectCase& effect_;
  sim::SimulatedCampaign simulated_;
  std::vector<VolumePoint> points_;   ///< where errors are judged
  std::vector<VolumePoint> lattice_;  ///< where the ideal of a format by positions is solved
  sim::MachineState surroundings_;
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::vector<std::string> effect_table_cases() {
  std::vector<std::string> names;
  for (const EffectCase& effect : all_cases()) names.push_back(effect.name);
  return names;
}

std::vector<EffectTablesRow> effect_tables_study(const EffectTablesOptions& options) {
  std::vector<EffectCase> cases = all_cases();
  std::erase_if(cases, [&](const EffectCase& effect) {
    return !options.cases.empty() && std::ranges::find(options.cases, effect.name) == options.cases.end();
  });
  const std::size_t count = cases.size() * static_cast<std::size_t>(options.structures);
  std::vector<std::vector<EffectTablesRow>> machines(count);
  int done = 0;
  std::mutex reporting;
  run_parallel(count, thread_count(options.threads), [&](std::size_t i) {
    const MachineWithEffect machine(options, static_cast<int>(i / cases.size()), cases[i % cases.size()]);
    machines[i] = machine.rows(options.formats);
    const std::lock_guard lock(reporting);
    ++done;
    if (options.progress) options.progress(done, static_cast<int>(count));
  });
  std::vector<EffectTablesRow> rows;
  for (const auto& machine : machines) rows.insert(rows.end(), machine.begin(), machine.end());
  return rows;
}

}  // namespace volcal::studies
