#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "volcal/identify/cli/commands/studies/criticism_options.h"
#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/studies/criticism/mills.h"

namespace volcal::cli {
namespace {

struct MillArguments {
  studies::MillStudyOptions options;
  std::vector<std::string> without;  ///< names of rules
  bool json = false;
};

using Mills = std::vector<studies::DiagnosedMill>;
using MillList = std::vector<std::string> studies::DiagnosedMill::*;

std::size_t total(const Mills& mills, MillList list) {
  std::size_t count = 0;
  for (const studies::DiagnosedMill& mill : mills) count += (mill.*list).size();
  return count;
}

std::ptrdiff_t mills_with(const Mills& mills, MillList list) {
  return std::ranges::count_if(mills,
                               [list](const studies::DiagnosedMill& mill) { return !(mill.*list).empty(); });
}

std::string mills_text(const studies::MillStudyOptions& options, const Mills& mills) {
  TextTable table({{"seed"},
                   {"errors"},
                   {"found"},
                   {"given [um]"},
                   {"offered [um]"},
                   {"other error functions", Align::Left},
                   {"effects that are not there", Align::Left}},
                  "What diagnoses accept");
  for (const studies::DiagnosedMill& mill : mills) {
    table.add_row({count_number(static_cast<long long>(mill.seed)),
                   count_number(static_cast<long long>(mill.hidden.size())),
                   count_number(static_cast<long long>(mill.found.size())), fixed_number(mill.given_um, 1),
                   mill.offered_um > 0.0 ? fixed_number(mill.offered_um, 1) : "-",
                   fmt::format("{}", fmt::join(mill.other_functions, ", ")),
                   fmt::format("{}", fmt::join(mill.wrong_effects, ", "))});
  }
  return fmt::format(
      "mills, {} campaigns, seeds from {}, 72 poses at a sphere, 8 um of noise; given and offered: RMS of "
      "the "
      "prediction at other poses\n\n{}\neffects that are not there: {}, in {} of {} mills\nerror functions "
      "that are not there: {}, in {}\nerrors found: {} of {}\n",
      mills.size(), options.seed, table.text(), total(mills, &studies::DiagnosedMill::wrong_effects),
      mills_with(mills, &studies::DiagnosedMill::wrong_effects), mills.size(),
      total(mills, &studies::DiagnosedMill::other_functions),
      mills_with(mills, &studies::DiagnosedMill::other_functions),
      total(mills, &studies::DiagnosedMill::found), total(mills, &studies::DiagnosedMill::hidden));
}

nlohmann::ordered_json mills_json(const Mills& mills) {
  nlohmann::ordered_json json = {{"study", "mills"}, {"campaigns", nlohmann::ordered_json::array()}};
  for (const studies::DiagnosedMill& mill : mills) {
    json["campaigns"].push_back({{"seed", mill.seed},
                                 {"hidden", mill.hidden},
                                 {"found", mill.found},
                                 {"other_functions", mill.other_functions},
                                 {"wrong_effects", mill.wrong_effects},
                                 {"given_um", mill.given_um},
                                 {"offered_um", mill.offered_um},
                                 {"seconds", mill.seconds}});
  }
  return json;
}

int run_mill_study(MillArguments arguments) {
  for (const std::string& name : arguments.without) {
    if (const auto rule = search_rule_of(name)) arguments.options.without.insert(*rule);
  }
  ProgressBar bar("mills");
  arguments.options.progress = counted_on(bar, "campaigns");
  const Mills mills = studies::mill_study(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return mills_json(mills); },
      [&] { return mills_text(arguments.options, mills); });
}

std::function<int()> define_mill_study(CLI::App& app) {
  auto arguments = std::make_shared<MillArguments>();
  studies::MillStudyOptions& options = arguments->options;
  app.add_option("-n,--campaigns", options.campaigns)->check(positive())->capture_default_str();
  app.add_option("--seed", options.seed, "of the first campaign, the others follow")
      ->check(not_negative())
      ->capture_default_str();
  add_archive_options(app, options.output, options.resume, "mills.jsonl");
  app.add_option("--without", arguments->without, "rules that are left out, names of volcal study rules")
      ->delimiter(',')
      ->check(CLI::IsMember(names_of_rules()));
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_mill_study(*arguments); };
}

}  // namespace

const Command& mill_study_command() {
  static const Command command = {
      "mills",
      "mills whose error functions are all missing from the model: what comes back, what is named wrongly",
      "  volcal study mills -n 8\n"
      "  volcal study mills -n 32 -o mills --resume\n",
      define_mill_study};
  return command;
}

}  // namespace volcal::cli
