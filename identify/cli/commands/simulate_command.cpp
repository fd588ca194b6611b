#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/units.h"
#include "volcal/studies/files/simulation_writer.h"
#include "volcal/studies/files/study_reader.h"

namespace volcal::cli {
namespace {

struct SimulateArguments {
  std::string study;
  std::string output;
  std::string errors;
  std::optional<std::uint64_t> seed;
  std::string compensation;
  double least_increment_um = 0.0;
  double wrong_tool_length_mm = 0.0;
  bool force = false;
  bool json = false;
};

void compensate(const SimulateArguments& arguments, sim::Study& study) {
  if (!arguments.compensation.empty())
    study.compensation =
        active_compensation(arguments.compensation, arguments.least_increment_um * kMetrePerMicrometre);
  if (arguments.wrong_tool_length_mm != 0.0)
    study.wrong_tool_length = arguments.wrong_tool_length_mm * kMetrePerMillimetre;
}

nlohmann::ordered_json left_out_json(const sim::SimulatedCampaign& simulated) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const sim::SetupPlan& plan : simulated.plans) {
    if (plan.poses_left_out == 0) continue;
    list.push_back(
        {{"setup", plan.name}, {"poses", plan.poses_left_out}, {"beyond_travel_of", plan.left_out_by}});
  }
  return list;
}

void print_left_out(const sim::SimulatedCampaign& simulated) {
  for (const sim::SetupPlan& plan : simulated.plans) {
    if (plan.poses_left_out == 0) continue;
    fmt::print("{}: {} of {} poses left out, beyond the travel of {}\n", plan.name, plan.poses_left_out,
               plan.poses_left_out + plan.points.size(), plan.left_out_by);
  }
}

int run_simulate(const SimulateArguments& arguments) {
  const Replaceable replaceable = arguments.force ? Replaceable::Anything : Replaceable::Unedited;
  require_output_folder(arguments.output, {arguments.study, arguments.errors, arguments.compensation},
                        replaceable);
  sim::Study study = read_study(arguments.study);
  if (arguments.seed) study.seed = *arguments.seed;
  if (!arguments.errors.empty()) study.truth = known_truth(arguments.errors, study.machine);
  compensate(arguments, study);
  AtomicFolder folder(arguments.output, replaceable);
  const sim::SimulatedCampaign simulated = sim::simulate(study);
  write_simulation(simulated, folder);
  folder.commit();
  if (arguments.json) {
    nlohmann::ordered_json json = {{"folder", arguments.output},
                                   {"seed", study.seed},
                                   {"setups", simulated.campaign.setups.size()},
                                   {"readings", simulated.campaign.reading_count()},
                                   {"poses_left_out", left_out_json(simulated)},
                                   {"known_errors", study.truth.errors_file},
                                   {"active_compensations", study.compensation.description}};
    add_findings("of_tables", study.truth.notes, json);
    fmt::print("{}\n", json_text(json, 2));
  } else {
    fmt::print("{} readings in {} setups (seed {}) written to {}\n", simulated.campaign.reading_count(),
               simulated.campaign.setups.size(), study.seed, arguments.output);
    print_left_out(simulated);
    if (!study.truth.errors_file.empty()) fmt::print("errors as stated in {}\n", study.truth.errors_file);
    fmt::print("{}", findings_text(study.truth.notes));
    if (!study.compensation.description.empty())
      fmt::print("active while it was measured: {}\n", study.compensation.description);
    fmt::print("next: volcal fit {0}/campaign.toml --model {0}/model.toml -o result\n", arguments.output);
  }
  return kDone;
}

std::function<int()> define_simulate(CLI::App& app) {
  auto arguments = std::make_shared<SimulateArguments>();
  app.add_option("STUDY", arguments->study, "study.toml: machine, hidden truth, measurements")->required();
  app.add_option("-o,--output", arguments->output, "folder for campaign.toml, its CSV files and truth/")
      ->required();
  app.add_option(
      "--errors", arguments->errors,
      "known errors in place of the study's truth: model.toml with values, folder of tables --format "
      "csv, or result folder");
  app.add_option("--seed", arguments->seed,
                 "instead of the study's seed; same seed, same readings to the bit")
      ->check(not_negative());
  auto* compensation =
      app.add_option("--compensation", arguments->compensation,
                     "folder of tables that the control applies while everything is measured");
  app.add_option("--least-increment", arguments->least_increment_um,
                 "corrections come in whole steps of it, um (ISO/TR 16907, 11.2 c)")
      ->check(positive())
      ->needs(compensation);
  app.add_option("--wrong-tool-length", arguments->wrong_tool_length_mm,
                 "every tool is longer by this than the control and the campaign file say, mm (11.2 d)")
      ->check(CLI::Range(-90.0, 90.0));
  app.add_flag("--force", arguments->force, "overwrite files that were edited, and those of other origin");
  app.add_flag("--json", arguments->json, "print one JSON document and nothing else");
  return [arguments] { return run_simulate(*arguments); };
}

}  // namespace

const Command& simulate_command() {
  static const Command command = {"simulate", "make a campaign from a machine with known errors",
                                  "  volcal simulate datasets/demo/study.toml -o campaign\n"
                                  "  volcal simulate study.toml --seed 7 -o campaign-7\n"
                                  "  volcal simulate study.toml --errors result/identified.toml -o again\n"
                                  "  volcal simulate other-setups.toml --compensation tables -o after\n",
                                  define_simulate};
  return command;
}

}  // namespace volcal::cli
