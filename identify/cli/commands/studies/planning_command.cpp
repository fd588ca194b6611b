#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"
#include "volcal/studies/planning.h"

namespace volcal::cli {
namespace {

struct PlanningStudyArguments {
  studies::PlanningStudyOptions options;
  bool json = false;
};

std::string planning_text(const studies::PlanningStudyOptions& options,
                          const std::vector<studies::PlannedMachine>& machines) {
  TextTable table(
      {{"structure", Align::Left},
       {"layout", Align::Left},
       {"predicted u [um]"},
       {"u of the fits [um]"},
       {"Monte Carlo u [um]"},
       {"true error [um]"},
       {"fits with an invisible error"}},
      "Volumetric, RMS of the vector over the volume and three tools; true error after rigid alignment");
  const auto um = [](double value) { return fixed_number(value * kPerMicro, 3); };
  const auto less = [](double plan, double textbook) {
    return fmt::format("-{:.1f} %", 100.0 * (1.0 - plan / textbook));
  };
  for (const studies::PlannedMachine& machine : machines) {
    for (const studies::LayoutFigures* each : {&machine.textbook, &machine.plan}) {
      table.add_row({machine.structure, each->name, um(each->predicted_u), um(each->fitted_u),
                     um(each->montecarlo_u), um(each->true_error), count_number(each->invisible)});
    }
    table.add_row({"", "difference", less(machine.plan.predicted_u, machine.textbook.predicted_u),
                   less(machine.plan.fitted_u, machine.textbook.fitted_u),
                   less(machine.plan.montecarlo_u, machine.textbook.montecarlo_u),
                   less(machine.plan.true_error, machine.textbook.true_error), ""});
  }
  return fmt::format("planning, {} campaigns of each layout, {} readings, seed {}\n\n{}", options.campaigns,
                     options.readings, options.seed, table.text());
}

nlohmann::ordered_json planning_json(const std::vector<studies::PlannedMachine>& machines) {
  nlohmann::ordered_json json = {{"study", "planning"}};
  for (const studies::PlannedMachine& machine : machines) {
    for (const studies::LayoutFigures* each : {&machine.textbook, &machine.plan}) {
      json["layouts"].push_back({{"structure", machine.structure},
                                 {"layout", each->name},
                                 {"predicted_u_um", each->predicted_u * kPerMicro},
                                 {"fitted_u_um", each->fitted_u * kPerMicro},
                                 {"montecarlo_u_um", each->montecarlo_u * kPerMicro},
                                 {"true_error_um", each->true_error * kPerMicro},
                                 {"fits_with_invisible_error", each->invisible}});
    }
  }
  return json;
}

int run_planning_study(PlanningStudyArguments arguments) {
  ProgressBar bar("planning");
  arguments.options.progress = [&bar](const std::string& stage, double done) { bar.update(stage, done); };
  const std::vector<studies::PlannedMachine> machines = studies::planning_study(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return planning_json(machines); },
      [&] { return planning_text(arguments.options, machines); });
}

std::function<int()> define_planning_study(CLI::App& app) {
  auto arguments = std::make_shared<PlanningStudyArguments>();
  studies::PlanningStudyOptions& options = arguments->options;
  app.add_option("-n,--campaigns", options.campaigns, "of each layout and machine")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--readings", options.readings, "of each campaign")
      ->check(CLI::Range(96, 20000))
      ->capture_default_str();
  app.add_option("--draws", options.draws, "of Monte Carlo")->check(positive())->capture_default_str();
  app.add_option("--seed", options.seed, "of the first campaign, the others follow")
      ->check(not_negative())
      ->capture_default_str();
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_planning_study(*arguments); };
}

}  // namespace

const Command& planning_study_command() {
  static const Command command = {
      "planning",
      "plans against the textbook's layout on three machines, confirmed by Monte Carlo and the truth",
      "  volcal study planning -n 3\n"
      "  volcal study planning -n 10 --readings 1920 --json\n",
      define_planning_study};
  return command;
}

}  // namespace volcal::cli
