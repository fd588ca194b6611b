#include <algorithm>
#include <set>
#include <utility>

#include "volcal/model/description/errors.h"
#include "volcal/sim/known/known_errors.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/measurement/instruments.h"
#include "volcal/sim/measurement/paths.h"
#include "volcal/sim/study.h"

namespace volcal::sim {
namespace {

/// Offset of a tool that reaches farther from the spindle along z.
Eigen::Vector3d longer(const Tool& tool, double by) {
  return tool.offset + by * Eigen::Vector3d(0.0, 0.0, tool.offset.z() > 0.0 ? 1.0 : -1.0);
}

std::vector<Eigen::Vector3d> true_tool_offsets(const Study& study) {
  std::vector<Eigen::Vector3d> offsets;
  offsets.reserve(study.machine.tools.size());
  for (const Tool& tool : study.machine.tools) {
    RandomStream random(study.seed, "tool " + tool.name);
    const Eigen::Vector3d drawn = tool.offset_sigma * random.normal_vector();
    const auto known = study.truth.tools.find(tool.name);
    offsets.emplace_back(longer(tool, study.wrong_tool_length) +
                         (known == study.truth.tools.end() ? drawn : known->second));
  }
  return offsets;
}

void set_expansions(const Study& study, TruthMachine& truth) {
  for (const Axis& axis : study.machine.axes) {
    const auto exact = study.truth.expansions.find(axis.name);
    if (exact != study.truth.expansions.end()) {
      truth.set_scale_expansion(axis.name, exact->second.per_kelvin, exact->second.channel);
    } else if (axis.expansion) {
      RandomStream random(study.seed, std::string("expansion ") + letter_of(axis.name));
      truth.set_scale_expansion(
          axis.name, axis.expansion->per_kelvin + axis.expansion->per_kelvin_sigma * random.normal(),
          axis.expansion->channel);
    }
  }
}

void check_channels(const Study& study) {
  const auto check = [&](AxisName axis, const ScaleExpansion& expansion) {
    const auto& channels = study.environment.channels;
    if (std::ranges::find(channels, expansion.channel, &TemperatureChannel::name) != channels.end()) return;
    throw InputError({study.file, 0},
                     std::string("axis ") + letter_of(axis) + " expands with the temperature \"" +
                         expansion.channel + "\", which the study does not simulate",
                     "add a [[temperatures]] table with channel = \"" + expansion.channel + "\"");
  };
  for (const auto& [axis, expansion] : study.truth.expansions) check(axis, expansion);
  for (const Axis& axis : study.machine.axes) {
    if (axis.expansion && !study.truth.expansions.contains(axis.name)) check(axis.name, *axis.expansion);
  }
}

std::vector<SetupPlan> all_plans(const Study& study) {
  std::vector<SetupPlan> plans;
  std::set<std::string> names;
  for (const Measurement& measurement : study.measurements) {
    for (SetupPlan& plan : plan_setups(measurement, study.machine, study.seed)) {
      if (!names.insert(plan.name).second) {
        throw InputError(measurement.place, "two setups would be called " + plan.name,
                         "give the measurements different names");
      }
      plans.push_back(std::move(plan));
    }
  }
  return plans;
}

template <class IsWanted>
bool moves_axes(const Machine& machine, const std::vector<SetupPlan>& plans, const IsWanted& is_wanted) {
  return std::ranges::any_of(plans, [&](const SetupPlan& plan) {
    return std::ranges::any_of(machine.axes, [&](const Axis& axis) {
      if (!is_wanted(axis.name)) return false;
      const double first = plan.points.front().position[index_of(axis.name)];
      return std::ranges::any_of(plan.points, [&](const CommandedPoint& point) {
        return point.position[index_of(axis.name)] != first;
      });
    });
  });
}

Campaign validation_campaign(const Study& study, const TruthMachine& truth, const Interference& known,
                             const std::vector<SetupPlan>& plans) {
  const RotaryMotion rotary =
      moves_axes(study.machine, plans, is_rotary) ? RotaryMotion::Random : RotaryMotion::Home;
  const bool parallel_moves = moves_axes(study.machine, plans, is_parallel);
  Campaign campaign;
  campaign.machine = study.machine;
  std::vector<std::string> tools = study.validation.tools;
  if (tools.empty()) tools.push_back(study.machine.tools.front().name);
  std::vector<Eigen::Vector3d> nominal_offsets;
  for (const Tool& tool : study.machine.tools)
    nominal_offsets.push_back(longer(tool, study.wrong_tool_length));
  const MeasuringConditions conditions{truth, study.environment, nominal_offsets, study.seed, true, false,
                                       &known};
  for (const std::string& tool : tools) {
    const auto index = study.machine.tool_index(tool);
    if (!index) {
      throw InputError({study.file, 0}, "validation names the tool \"" + tool + "\", which does not exist",
                       "use a tool of the machine file");
    }
    SetupPlan plan;
    plan.name = "truth_" + tool;
    plan.instrument = kVolumetricPoints;
    plan.tool = *index;
    RandomStream random(study.seed, "validation points " + tool);
    plan.points = random_points(study.machine, study.validation.points, random, rotary);
    if (parallel_moves) {
      RandomStream parallel(study.seed, "parallel axes at validation points " + tool);
      add_parallel_motion(study.machine, false, parallel, plan.points);
    }
    Setup setup = measure(plan, conditions, 0.0);
    setup.noise.set("constant", study.validation.stated_noise);
    campaign.setups.push_back(std::move(setup));
  }
  return campaign;
}

/// The setups of a study read out one after another.
class StudyReadout : public Readout {
 public:
  StudyReadout(const Study& study, const std::vector<Eigen::Vector3d>& tool_offsets,
               std::vector<SetupPlan> plans)
      : study_(study), tool_offsets_(tool_offsets), plans_(std::move(plans)) {}

  Campaign noise_free(const TruthMachine& truth, const Interference& interference) const override {
    return read(truth, interference, true);
  }
  Campaign with_noise(const TruthMachine& truth, const Interference& interference) const {
    return read(truth, interference, false);
  }

 private:
  Campaign read(const TruthMachine& truth, const Interference& interference, bool noise_free) const {
    Campaign campaign;
    campaign.machine = study_.machine;
    const std::uint64_t noise_seed = study_.noise_seed.value_or(study_.seed);
    const MeasuringConditions conditions{truth, study_.environment, tool_offsets_, noise_seed,
                                         false, noise_free,         &interference};
    double start = 0.0, end = 0.0;
    for (const SetupPlan& plan : plans_) {
      if (!plan.with_setup_before) start = end;
      campaign.setups.push_back(measure(plan, conditions, start));
      end = start + plan.seconds_per_reading * static_cast<double>(plan.points.size()) +
            study_.pause_between_setups;
    }
    return campaign;
  }

  const Study& study_;
  const std::vector<Eigen::Vector3d>& tool_offsets_;
  std::vector<SetupPlan> plans_;
};

std::vector<SetupPlan> at_unseen_positions(std::vector<SetupPlan> plans) {
  for (SetupPlan& plan : plans) plan.points = plan.unseen;
  return plans;
}

TruthMachine machine_with_errors(const Study& study) {
  if (!study.truth.errors && !study.truth.perfect)
    return random_truth(study.machine, study.seed, study.truth.random);
  TruthMachine truth(study.machine);
  if (study.truth.errors) set_known_errors(*study.truth.errors, truth);
  return truth;
}

/// `known`: gets what known effects do besides moving axes.
TruthMachine true_machine_of(const Study& study, const std::vector<SetupPlan>& plans, Interference& known) {
  TruthMachine truth = machine_with_errors(study);
  HiddenScene scene{truth, known};
  if (study.truth.errors)
    add_known_effects(*study.truth.errors, {study.machine, study.environment, plans}, scene);
  set_known_functions(study.truth.functions, study.file, truth);
  for (const auto& [symbol, value] : study.truth.locations) truth.set_location(symbol, value);
  for (const auto& [symbol, value] : study.truth.reversals) truth.set_reversal(symbol, value);
  set_expansions(study, truth);
  if (study.truth.alter) study.truth.alter(truth);
  if (!study.compensation.tables.empty()) truth.set_correction(command_correction(study.compensation));
  return truth;
}

}  // namespace

TruthMachine true_machine(const Study& study) {
  Interference known;
  return true_machine_of(study, study.truth.errors ? all_plans(study) : std::vector<SetupPlan>{}, known);
}

SimulatedCampaign simulate(const Study& study) {
  if (study.machine.tools.empty()) {
    throw InputError({study.file, 0}, "the machine has no tool", "add a [tools.NAME] table to its file");
  }
  check_channels(study);
  Interference known;
  std::vector<SetupPlan> plans = all_plans(study);
  TruthMachine truth = true_machine_of(study, plans, known);
  SimulatedCampaign simulated{{}, {}, std::move(truth), true_tool_offsets(study), std::move(plans)};
  const TruthMachine without_hidden = simulated.truth;
  const StudyReadout readout{study, simulated.tool_offsets, simulated.plans};
  const HiddenContext context{study.machine, study.environment, simulated.plans};
  simulated.hidden = resolve_hidden(study.hidden, context, without_hidden, readout);
  Interference interference = known;
  HiddenScene scene{simulated.truth, interference};
  for (const HiddenAnswer& answer : simulated.hidden) {
    add_hidden(answer.effect, answer.amplitude, context, scene);
  }
  simulated.campaign = readout.with_noise(simulated.truth, interference);
  simulated.campaign.active_compensations = study.compensation.description;
  simulated.validation = validation_campaign(study, simulated.truth, known, simulated.plans);
  simulated.validation.active_compensations = study.compensation.description;
  for (const SetupPlan& plan : simulated.plans) append_gross_errors(plan, study.seed, simulated.outliers);
  if (study.unseen || !study.hidden.empty()) {
    const StudyReadout elsewhere{study, simulated.tool_offsets, at_unseen_positions(simulated.plans)};
    simulated.unseen = elsewhere.noise_free(simulated.truth, interference);
    simulated.unseen_without_hidden = elsewhere.noise_free(without_hidden, known);
  }
  return simulated;
}

}  // namespace volcal::sim
