#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/interrupt_watch.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/criticism/catalogue/named_effect.h"
#include "volcal/identify/io/campaign/campaign_on_machine.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/plan_writer.h"
#include "volcal/identify/planning/campaign_plan.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/plan_text.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

struct PlanArguments {
  std::string machine;
  std::string model;
  std::string with;
  std::string verify;
  std::string output;
  std::string target = "volumetric";
  std::vector<std::string> tools;
  std::vector<double> noise = {0.25, 0.3, 0.6};  ///< um, um/m, um
  double angle_noise = 1.0;                      ///< urad
  std::vector<double> range_mm = {200.0, 15000.0};
  std::vector<double> elevation_deg = {-35.0, 85.0};
  std::vector<double> region_mm;
  std::vector<double> roughness = {3.0, 6.0, 0.2};  ///< um, urad, share of the travel
  double time_h = 0.0;
  int readings = 0;
  int tool_count = 0;
  double station_min = 20.0;
  double run_min = 5.0;
  double bar_mm = 0.0;
  double bar_sigma_um = -1.0;  ///< negative: not given
  double reading_s = 0.0;      ///< 0: what is usual for the instrument
  double feed_mm_min = 6000.0;
  double turn_deg_s = 20.0;
  double clearance_mm = 100.0;
  double spindle_mm = 100.0;
  bool extend = false;
  bool force = false;
  bool json = false;
  PlanSettings settings;
};

[[noreturn]] void refuse_plan(const std::string& problem, const std::string& remedy) {
  throw InputError({}, problem, remedy);
}

/// Options of an instrument that this one does not have.
void refuse_other_options(const CLI::App& app, const std::string& instrument) {
  const std::vector<std::string> own = find_plan_instrument(instrument)->own_options();
  for (const PlanInstrument* other : plan_instruments()) {
    for (const std::string& option : other->own_options()) {
      if (app.count(option) == 0 || std::ranges::find(own, option) != own.end()) continue;
      refuse_plan(fmt::format("{} does not apply to a {}", option, instrument),
                  fmt::format("leave it out, or plan for --instrument {}", other->name()));
    }
  }
}

void read_bar(const PlanArguments& arguments, PlanSettings& settings) {
  settings.bar.length = arguments.bar_mm * kMetrePerMillimetre;
  if (arguments.bar_sigma_um >= 0.0) settings.bar.length_sigma = arguments.bar_sigma_um * kMicro;
}

void read_tools(const PlanArguments& arguments, PlanSettings& settings) {
  for (const std::string& name : arguments.tools) {
    const auto tool = settings.machine.tool_index(name);
    if (!tool) {
      std::string known;
      for (const Tool& each : settings.machine.tools) known += (known.empty() ? "" : ", ") + each.name;
      refuse_plan("--tools: the machine file has no tool " + name, "choose one of " + known);
    }
    settings.budget.tools.push_back(*tool);
  }
}

void read_pair(const std::string& option, const std::vector<double>& values, double unit, double& low,
               double& high) {
  if (!(values[0] < values[1]))
    refuse_plan(option + ": the first number is not the smaller one", "give MIN,MAX");
  low = values[0] * unit;
  high = values[1] * unit;
}

void read_region(const PlanArguments& arguments, PlanSettings& settings) {
  if (arguments.region_mm.empty()) return;
  const auto& r = arguments.region_mm;
  const Eigen::Vector3d low(r[0], r[2], r[4]), high(r[1], r[3], r[5]);
  if (!(low.array() <= high.array()).all()) {
    refuse_plan("--region-mm: a lower bound is above its upper one",
                "give X0,X1,Y0,Y1,Z0,Z1 in workpiece coordinates");
  }
  settings.surroundings.stations_w =
      Eigen::AlignedBox3d(low * kMetrePerMillimetre, high * kMetrePerMillimetre);
}

/// volumetric, worst, a symbol, or separate:EFFECT,EFFECT; effects are those that could act in the campaign
/// given with --with, else in the textbook's.
void read_target(const PlanArguments& arguments, const Campaign* with, PlanSettings& settings) {
  const std::string separate = "separate:";
  if (arguments.target == "volumetric") return;
  if (arguments.target == "worst") {
    settings.target = PlanTarget::Worst;
    return;
  }
  if (!arguments.target.starts_with(separate)) {
    settings.target = PlanTarget::Symbol;
    settings.symbol = MachineError::parse(arguments.target);
    return;
  }
  settings.target = PlanTarget::Separate;
  const std::string names = arguments.target.substr(separate.size());
  const std::size_t comma = names.find(',');
  if (comma == std::string::npos) {
    refuse_plan("--minimise " + arguments.target + ": one effect alone cannot be separated",
                "give separate:KIND:TARGET,KIND:TARGET; volcal diagnose --list prints kinds and targets");
  }
  const Campaign textbook =
      with != nullptr ? *with : campaign_of(textbook_layout(settings, LineOfSight(settings)), settings);
  settings.separate =
      named_effects("--minimise separate:", {names.substr(0, comma), names.substr(comma + 1)}, textbook);
}

PlanSettings settings_of(const PlanArguments& arguments, const Machine& machine,
                         const std::optional<Campaign>& with) {
  PlanSettings settings = arguments.settings;
  settings.machine = machine;
  if (!arguments.model.empty()) settings.model = read_model(arguments.model, settings.machine);
  settings.linear_axes_known =
      arguments.model.empty() && !arguments.extend && plan_instrument_of(settings).turns_rotary_axes();
  if (settings.linear_axes_known) settings.model = with_known_linear_axes(settings.model, settings.machine);
  read_tools(arguments, settings);
  if (arguments.readings > 0) settings.budget.readings = arguments.readings;
  if (arguments.time_h > 0.0) settings.budget.time = arguments.time_h * kSecondsPerHour;
  if (arguments.tool_count > 0) settings.budget.tool_count = arguments.tool_count;
  settings.noise = {arguments.noise[0] * kMicro, arguments.noise[1] * kMicro, arguments.noise[2] * kMicro,
                    arguments.angle_noise * kMicro};
  settings.roughness = {arguments.roughness[0] * kMicro, arguments.roughness[1] * kMicro,
                        arguments.roughness[2]};
  read_pair("--range-mm", arguments.range_mm, kMetrePerMillimetre, settings.limits.range_min,
            settings.limits.range_max);
  read_pair("--elevation-deg", arguments.elevation_deg, kRadianPerDegree, settings.limits.elevation_min,
            settings.limits.elevation_max);
  settings.surroundings.clearance = arguments.clearance_mm * kMetrePerMillimetre;
  settings.surroundings.spindle_radius = arguments.spindle_mm * kMetrePerMillimetre;
  read_region(arguments, settings);
  read_bar(arguments, settings);
  const double reading_s =
      arguments.reading_s > 0.0 ? arguments.reading_s : plan_instrument_of(settings).usual_reading_time();
  settings.costs = {arguments.station_min * kSecondsPerMinute, arguments.run_min * kSecondsPerMinute,
                    reading_s, arguments.feed_mm_min * kMetrePerMillimetre / kSecondsPerMinute,
                    arguments.turn_deg_s * kRadianPerDegree};
  check_plan_settings(settings);
  read_target(arguments, with ? &*with : nullptr, settings);
  if (arguments.extend) settings.existing = &*with;
  if (!arguments.verify.empty()) settings.apart_from = &*with;
  return settings;
}

/// study.toml and the campaign of a plan are there to be edited.
Replaceable replaceable(const PlanArguments& arguments) {
  return arguments.force ? Replaceable::Anything : Replaceable::Unedited;
}

void check_campaign_options(const PlanArguments& arguments) {
  if (arguments.extend && arguments.with.empty()) {
    refuse_plan("--extend has nothing to extend",
                "give the campaign that is measured with --with CAMPAIGN.toml");
  }
  if (arguments.extend && arguments.readings == 0) {
    refuse_plan("--extend: how many readings may be added is missing", "give --readings N");
  }
  if (!arguments.verify.empty() && !arguments.with.empty())
    refuse_plan("--verify and --with name two campaigns", "give one of them");
}

std::optional<Campaign> given_campaign(const PlanArguments& arguments, const Machine& machine) {
  const std::string& file = arguments.verify.empty() ? arguments.with : arguments.verify;
  if (file.empty()) return std::nullopt;
  return campaign_on_machine(read_campaign(file), machine);
}

void write_plan(const PlanArguments& arguments, const CampaignPlan& plan, const std::string& json) {
  AtomicFolder folder(arguments.output, replaceable(arguments));
  folder.write("plan.json", json);
  folder.write("plan.txt", plan_text(plan));
  write_plan_campaign(plan, folder);
  if (report_available()) {
    folder.write("report.html", report_html(plan, report_options()));
  }
  folder.commit();
}

/// Ctrl-C ends the program, but for the search for options: then the plan is there and is kept.
class PlanProgress {
 public:
  explicit PlanProgress(ProgressBar& bar) : bar_(bar) {}

  void update(const std::string& stage, double done) {
    if (stage != kLookingForOptions) {
      watch_.reset();
      return bar_.update(stage, done);
    }
    if (!watch_) {
      watch_.emplace("\nending with the plan that is found; Ctrl-C again ends at once\n");
      start_ = Clock::now();
      before_ = done;
    }
    if (watch_->was_asked_for()) throw OptionsNotWanted();
    bar_.update(stage + time_left(done), done);
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// ", 12 s left"; empty before anything is done.
  std::string time_left(double done) const {
    if (!(done > before_)) return "";
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    return fmt::format(", {:.0f} s left", seconds * (1.0 - done) / (done - before_));
  }

  ProgressBar& bar_;
  std::optional<InterruptWatch> watch_;
  Clock::time_point start_;
  double before_ = 0.0;
};

int run_plan(const PlanArguments& arguments, const CLI::App& app) {
  refuse_other_options(app, arguments.settings.instrument);
  if (!arguments.output.empty()) {
    require_output_folder(arguments.output,
                          {arguments.machine, arguments.model, arguments.with, arguments.verify},
                          replaceable(arguments));
  }
  check_campaign_options(arguments);
  const Machine machine = read_machine(arguments.machine);
  const std::optional<Campaign> with = given_campaign(arguments, machine);
  PlanSettings settings = settings_of(arguments, machine, with);
  ProgressBar bar("plan");
  PlanProgress progress(bar);
  settings.progress = [&progress](const std::string& stage, double done) { progress.update(stage, done); };
  CampaignPlan plan =
      arguments.extend ? extend_campaign(settings) : plan_campaign(settings, with ? &*with : nullptr);
  if (with) plan.notes = with->notes;
  bar.finish();
  const std::string json = plan_json(plan);
  if (!arguments.output.empty()) write_plan(arguments, plan, json);
  if (arguments.json) {
    fmt::print("{}", json);
  } else {
    fmt::print("{}", plan_text(plan));
    if (!arguments.output.empty()) {
      fmt::print("\nwritten: {0}\nnext: volcal simulate {0}/study.toml -o simulated\n", arguments.output);
    }
  }
  const bool identifies = settings.apart_from == nullptr;  // what verifies need not see every error
  return plan.plan.invisible().empty() || !identifies ? kDone : kIncomplete;
}

/// "4 of laser-tracer, laser-tracker; 0.1 of ball-bar": in the order of the registry.
std::string usual_reading_times() {
  std::vector<std::pair<double, std::string>> times;
  for (const PlanInstrument* each : plan_instruments()) {
    const auto same =
        std::ranges::find(times, each->usual_reading_time(), &std::pair<double, std::string>::first);
    if (same != times.end()) {
      same->second += ", " + each->name();
    } else {
      times.emplace_back(each->usual_reading_time(), each->name());
    }
  }
  std::string text;
  for (const auto& [seconds, names] : times)
    text += fmt::format("{}{:g} of {}", text.empty() ? "" : "; ", seconds, names);
  return text;
}

std::string instruments_that_turn_axes() {
  std::string names;
  for (const PlanInstrument* each : plan_instruments()) {
    if (each->turns_rotary_axes()) names += (names.empty() ? "" : ", ") + each->name();
  }
  return names;
}

void define_budget(CLI::App& app, PlanArguments& arguments) {
  app.add_option(
         "--stations", arguments.settings.budget.stations,
         "stations, or places of a ball-bar's centre ball, or spheres; with --extend: setups to be added")
      ->check(CLI::Range(1, 12))
      ->capture_default_str();
  app.add_option("--readings", arguments.readings,
                 "readings in all; every position is read from both directions")
      ->check(CLI::Range(16, 20000));
  app.add_option("--time", arguments.time_h, "hours in all")->check(positive());
  app.add_option("--tools", arguments.tools,
                 "tools that may be used, NAME,NAME; default: all of the machine file")
      ->delimiter(',');
  app.add_option("--tool-count", arguments.tool_count, "how many of them; the best are chosen")
      ->check(CLI::Range(1, 100));
  app.add_option("--station-min", arguments.station_min, "minutes to put up the instrument")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--run-min", arguments.run_min,
                 "minutes to change the tool, or the plane of a ball-bar, at a station")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--reading-s", arguments.reading_s,
                 "seconds that the machine stands for a reading; default: " + usual_reading_times())
      ->check(positive());
  app.add_option("--feed-mm-min", arguments.feed_mm_min, "between positions")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--turn-deg-s", arguments.turn_deg_s, "of rotary axes between positions")
      ->check(positive())
      ->capture_default_str();
}

void define_instrument(CLI::App& app, PlanArguments& arguments) {
  std::vector<std::string> instruments;
  for (const PlanInstrument* each : plan_instruments()) instruments.push_back(each->name());
  app.add_option("--instrument", arguments.settings.instrument,
                 instruments_that_turn_axes() + " move the rotary axes, others leave them at home")
      ->check(CLI::IsMember(instruments))
      ->capture_default_str();
  app.add_option("--bar-mm", arguments.bar_mm, "length of the ball-bar, between the ball centres")
      ->check(positive());
  app.add_option("--bar-sigma-um", arguments.bar_sigma_um,
                 "standard uncertainty of the ball-bar's calibrated length; 0 = exact, default: unknown")
      ->check(not_negative());
  app.add_option("--noise", arguments.noise,
                 "CONSTANT_um,PER_METRE_um,REPEATABILITY_um of readings to be taken (k = 1)")
      ->delimiter(',')
      ->expected(3)
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--angle-noise-urad", arguments.angle_noise, "of a tracker's angles")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--range-mm", arguments.range_mm, "MIN,MAX from station to reflector")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  app.add_option("--elevation-deg", arguments.elevation_deg, "MIN,MAX of the beam above the horizontal")
      ->delimiter(',')
      ->expected(2)
      ->capture_default_str();
  app.add_option("--region-mm", arguments.region_mm,
                 "X0,X1,Y0,Y1,Z0,Z1 where stations, centre balls or spheres may stand, workpiece "
                 "coordinates; default: "
                 "around the lower half of the volume, centre balls anywhere in it, spheres about the axis "
                 "of a rotary "
                 "table or in the lower half of the volume")
      ->delimiter(',')
      ->expected(6);
  app.add_option("--clearance-mm", arguments.clearance_mm, "of stations from what tools and spindle sweep")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--spindle-mm", arguments.spindle_mm,
                 "radius of the spindle, which beams and bars must pass by")
      ->check(not_negative())
      ->capture_default_str();
}

std::function<int()> define_plan(CLI::App& app) {
  auto arguments = std::make_shared<PlanArguments>();
  app.add_option("MACHINE", arguments->machine, "machine.toml")->required();
  app.add_option(
      "-m,--model", arguments->model,
      "model.toml; default: all 21 errors, cubic B-splines, automatic knots; of an instrument that turns "
      "rotary axes their errors alone, linear axes known");
  app.add_option("-o,--output", arguments->output,
                 "folder for plan.json, plan.txt, report.html, study.toml and campaign/ with the positions");
  app.add_option(
         "--minimise", arguments->target,
         "volumetric; worst: the largest table value, rotations by their lever; an error as EXX or EC0Y; "
         "separate:KIND:TARGET,KIND:TARGET: two effects to be separated")
      ->capture_default_str();
  app.add_option("--with", arguments->with, "campaign.toml to compare with");
  app.add_flag("--extend", arguments->extend,
               "keep the readings of --with and find the setups that help them most");
  app.add_option(
      "--verify", arguments->verify,
      "campaign.toml that a compensation was made from: plan one that verifies it, at other places and "
      "positions (ISO/TR 16907, 11.3)");
  define_budget(app, *arguments);
  define_instrument(app, *arguments);
  app.add_option(
         "--roughness", arguments->roughness,
         "UM,URAD,LENGTH of error functions with automatic knots: standard deviation from a straight line, "
         "correlation length as a share of the travel")
      ->delimiter(',')
      ->expected(3)
      ->check(positive())
      ->capture_default_str();
  app.add_option("--seed", arguments->settings.seed,
                 "of the positions between grid points; same seed, same bits")
      ->capture_default_str();
  app.add_option("--threads", arguments->settings.threads, "0 = all; results do not depend on it")
      ->check(number_of_threads());
  app.add_flag("--force", arguments->force, "overwrite files that were edited, and those of other origin");
  app.add_flag("--json", arguments->json, "print plan.json on standard output and nothing else");
  return [arguments, &app] { return run_plan(*arguments, app); };
}

}  // namespace

const Command& plan_command() {
  static const Command command = {
      "plan", "stations, tools and positions that make the errors as certain as a budget allows",
      "  volcal plan machine.toml --stations 4 --readings 960 -o plan\n"
      "  volcal plan machine.toml --stations 4 --time 4 --tools short,side_x --with mine/campaign.toml -o "
      "plan\n"
      "  volcal plan machine.toml --readings 480 --minimise EC0Y -o plan\n"
      "  volcal plan machine.toml --readings 480 --minimise \"separate:station-drift:station "
      "P1,dead-path:readings of "
      "P1_short\"\n"
      "  volcal plan machine.toml --with campaign.toml --extend --stations 1 --readings 200 -o more\n"
      "  volcal plan machine.toml --instrument ball-bar --bar-mm 100 --bar-sigma-um 0.5 --stations 3 "
      "--readings 1200 -o plan\n"
      "  volcal plan five-axis/machine.toml --instrument r-test --stations 3 --readings 720 -o spheres\n"
      "  volcal plan five-axis/machine.toml --instrument ball-bar-rotary --bar-mm 100 --bar-sigma-um 0.5 "
      "--stations 2 --readings 1500 -o bars\n",
      define_plan};
  return command;
}

}  // namespace volcal::cli
