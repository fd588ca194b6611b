#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "volcal/identify/cli/commands/studies/rule_names.h"
#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/studies/criticism/criticism_plan.h"
#include "volcal/studies/criticism/rule_study.h"

namespace volcal::cli {
namespace {

struct RulesArguments {
  RuleStudyOptions options;
  bool json = false;
};

std::string rules_text(const RulesArguments& arguments, const std::vector<RuleCampaign>& campaigns) {
  TextTable table({{"without", Align::Left},
                   {"decided in"},
                   {"reported otherwise"},
                   {"right"},
                   {"wrong"},
                   {"false alarms"},
                   {"removed >= 0.9"},
                   {"processor [s]"}},
                  "Every rule of the search left out in turn");
  for (const RuleRow& row : rows_of(campaigns, arguments.options.rules)) {
    const bool all = row.rule.empty();
    table.add_row({all ? "none" : row.rule, all ? "-" : count_number(row.decided),
                   all ? "-" : count_number(row.changed), count_number(row.told.right),
                   count_number(row.told.wrong), count_number(row.told.alarms),
                   fmt::format("{} of {}", row.told.removed, row.told.of_removed),
                   fixed_number(row.told.seconds, 0)});
  }
  return fmt::format("rules of the search, {} campaigns of about {} readings, seeds from {}\n\n{}",
                     campaigns.size(), count_number(arguments.options.readings), arguments.options.seed,
                     table.text());
}

nlohmann::ordered_json rules_json(const RulesArguments& arguments,
                                  const std::vector<RuleCampaign>& campaigns) {
  nlohmann::ordered_json json = {{"study", "rules"},
                                 {"seed", arguments.options.seed},
                                 {"readings", arguments.options.readings},
                                 {"campaigns", campaigns.size()},
                                 {"rows", nlohmann::ordered_json::array()}};
  for (const RuleRow& row : rows_of(campaigns, arguments.options.rules)) {
    json["rows"].push_back({{"without", row.rule},
                            {"decided", row.decided},
                            {"changed", row.changed},
                            {"right", row.told.right},
                            {"wrong", row.told.wrong},
                            {"false_alarms", row.told.alarms},
                            {"removed", {{"count", row.told.removed}, {"of", row.told.of_removed}}},
                            {"processor_s", row.told.seconds}});
  }
  return json;
}

int run_rules(RulesArguments arguments) {
  RuleStudyOptions& options = arguments.options;
  if (options.rows.empty()) options.rows.assign(criticism_rows().begin(), criticism_rows().end());
  if (options.rules.empty()) options.rules = names_of_rules();
  ProgressBar bar("rules");
  options.progress = counted_on(bar, "campaigns");
  const std::vector<RuleCampaign> campaigns = rule_study(options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return rules_json(arguments, campaigns); },
      [&] { return rules_text(arguments, campaigns); });
}

std::function<int()> define_rules(CLI::App& app) {
  auto arguments = std::make_shared<RulesArguments>();
  RuleStudyOptions& options = arguments->options;
  const std::vector<std::string> rows(criticism_rows().begin(), criticism_rows().end());
  app.add_option("--rows", options.rows, fmt::format("{}; default: all", fmt::join(rows, ", ")))
      ->delimiter(',')
      ->check(CLI::IsMember(rows));
  app.add_option("--without", options.rules, described_rules() + "; default: each in turn")
      ->delimiter(',')
      ->check(CLI::IsMember(names_of_rules()));
  app.add_option("-n,--campaigns", options.campaigns, "per row; row null: per kind of noise")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the first campaign, the others follow")->capture_default_str();
  app.add_option("--readings", options.readings, "of a campaign, about")
      ->check(CLI::Range(400, 100'000))
      ->capture_default_str();
  app.add_option("-o,--output", options.output, "folder that keeps every finished campaign (rules.jsonl)");
  app.add_flag("--resume", options.resume, "do not run again what the output folder holds");
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_rules(*arguments); };
}

}  // namespace

const Command& rules_study() {
  static const Command command = {
      "rules", "what each rule of the search for missing effects is worth: diagnoses without it, counted",
      "  volcal study rules -n 5 --seed 2001 -o counted\n"
      "  volcal study rules --without one-cause,recheck -n 40 -o others --resume\n",
      define_rules};
  return command;
}

}  // namespace volcal::cli
