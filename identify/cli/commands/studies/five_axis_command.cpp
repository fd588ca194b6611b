#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/description/units.h"
#include "volcal/studies/files/five_axis_machines.h"
#include "volcal/studies/five_axis.h"

namespace volcal::cli {
namespace {

struct FiveAxisArguments {
  studies::FiveAxisStudyOptions options;
  bool json = false;
};

using FiveAxisCampaigns = std::vector<studies::FiveAxisCampaign>;
using FiveAxisFigure = double studies::FiveAxisCampaign::*;

/// Mean and its 95 % interval, half of it.
struct MeanInterval {
  double mean = 0.0;
  double half = 0.0;
};

MeanInterval interval_of(const FiveAxisCampaigns& campaigns, FiveAxisFigure figure) {
  const auto n = static_cast<double>(campaigns.size());
  double mean = 0.0, squares = 0.0;
  for (const studies::FiveAxisCampaign& each : campaigns) mean += each.*figure / n;
  for (const studies::FiveAxisCampaign& each : campaigns)
    squares += (each.*figure - mean) * (each.*figure - mean);
  return {mean, n > 1.0 ? kCoverageFactor * std::sqrt(squares / (n - 1.0) / n) : std::nan("")};
}

FiveAxisCampaigns of_structure(const FiveAxisCampaigns& campaigns, const std::string& structure) {
  FiveAxisCampaigns own;
  std::ranges::copy_if(campaigns, std::back_inserter(own),
                       [&](const studies::FiveAxisCampaign& each) { return each.structure == structure; });
  return own;
}

std::string cell(const FiveAxisCampaigns& campaigns, FiveAxisFigure figure, double unit, int decimals) {
  const MeanInterval interval = interval_of(campaigns, figure);
  return fmt::format("{:.{}f} +- {:.{}f}", interval.mean / unit, decimals, interval.half / unit, decimals);
}

std::string five_axis_text(const studies::FiveAxisStudyOptions& options, const FiveAxisCampaigns& campaigns) {
  constexpr double kPercent = 0.01;
  TextTable exact({{"structure", Align::Left},
                   {"campaigns"},
                   {"before [um]"},
                   {"after [um]"},
                   {"chi2/dof"},
                   {"coverage of 95 % [%]"}},
                  "Rotary errors alone");
  TextTable beside({{"structure", Align::Left},
                    {"before [um]"},
                    {"after [um]"},
                    {"location errors alone [um]"},
                    {"one sphere, axes singly [um]"},
                    {"worse than before"},
                    {"coverage of 95 % [%]"}},
                   "With 1 um and 2 urad of linear axes' errors that the model does not have");
  const auto add = [&](const std::string& name, const FiveAxisCampaigns& own) {
    if (own.empty()) return;
    exact.add_row({name, count_number(static_cast<long long>(own.size())),
                   cell(own, &studies::FiveAxisCampaign::before, kMicro, 2),
                   cell(own, &studies::FiveAxisCampaign::after, kMicro, 3),
                   cell(own, &studies::FiveAxisCampaign::chi2, 1.0, 3),
                   cell(own, &studies::FiveAxisCampaign::coverage, kPercent, 1)});
    const auto worse = std::ranges::count_if(own, [](const studies::FiveAxisCampaign& each) {
      return each.one_sphere_singly > each.before_beside;
    });
    beside.add_row({name, cell(own, &studies::FiveAxisCampaign::before_beside, kMicro, 2),
                    cell(own, &studies::FiveAxisCampaign::after_beside, kMicro, 3),
                    cell(own, &studies::FiveAxisCampaign::locations_only, kMicro, 2),
                    cell(own, &studies::FiveAxisCampaign::one_sphere_singly, kMicro, 2), count_number(worse),
                    cell(own, &studies::FiveAxisCampaign::coverage_beside, kPercent, 1)});
  };
  for (const std::string& structure : studies::five_axis_structures())
    add(structure, of_structure(campaigns, structure));
  add("all", campaigns);
  return fmt::format(
      "five-axis, {} campaigns, seeds from {}, {} x {} poses with three spheres and three tools; +- is the "
      "95 % "
      "interval of the mean\n\nRMS of the displacement at 300 fresh poses of all axes, after the datums of a "
      "set-up\n\n{}\n{}",
      campaigns.size(), options.seed, options.turns, options.tilts, exact.text(), beside.text());
}

nlohmann::ordered_json five_axis_json(const FiveAxisCampaigns& campaigns) {
  nlohmann::ordered_json json = {{"study", "five-axis"}, {"campaigns", nlohmann::ordered_json::array()}};
  for (const studies::FiveAxisCampaign& each : campaigns) {
    json["campaigns"].push_back({{"structure", each.structure},
                                 {"seed", each.seed},
                                 {"before_um", each.before / kMicro},
                                 {"after_um", each.after / kMicro},
                                 {"chi2", each.chi2},
                                 {"coverage", each.coverage},
                                 {"before_beside_um", each.before_beside / kMicro},
                                 {"after_beside_um", each.after_beside / kMicro},
                                 {"coverage_beside", each.coverage_beside},
                                 {"locations_only_um", each.locations_only / kMicro},
                                 {"one_sphere_singly_um", each.one_sphere_singly / kMicro}});
  }
  return json;
}

int run_five_axis_study(FiveAxisArguments arguments) {
  ProgressBar bar("five-axis");
  arguments.options.progress = counted_on(bar, "campaigns");
  const FiveAxisCampaigns campaigns = studies::five_axis_study(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return five_axis_json(campaigns); },
      [&] { return five_axis_text(arguments.options, campaigns); });
}

std::function<int()> define_five_axis_study(CLI::App& app) {
  auto arguments = std::make_shared<FiveAxisArguments>();
  studies::FiveAxisStudyOptions& options = arguments->options;
  app.add_option("-n,--campaigns", options.campaigns, "of the four structures in turn")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the first campaign, the others follow")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--turns", options.turns, "positions of C")->check(CLI::Range(4, 72))->capture_default_str();
  app.add_option("--tilts", options.tilts, "positions of the other rotary axis")
      ->check(CLI::Range(4, 72))
      ->capture_default_str();
  app.add_option("-o,--output", options.output, "folder that keeps every campaign that is finished");
  app.add_flag("--resume", options.resume, "do not run again what the output folder holds");
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_five_axis_study(*arguments); };
}

}  // namespace

const Command& five_axis_study_command() {
  static const Command command = {
      "five-axis",
      "rotary axes identified on machines of four structures, at poses where no reading was taken",
      "  volcal study five-axis -n 8 --turns 12 --tilts 9\n"
      "  volcal study five-axis -n 100 -o five-axis --resume\n",
      define_five_axis_study};
  return command;
}

}  // namespace volcal::cli
