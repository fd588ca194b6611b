#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "volcal/identify/cli/commands/studies/criticism_options.h"
#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/studies/criticism/rule_study.h"

namespace volcal::cli {
namespace {

struct RulesArguments {
  studies::RuleStudyOptions options;
  bool json = false;
};

std::string rules_text(const RulesArguments& arguments, const std::vector<studies::RuleCampaign>& campaigns) {
  TextTable table({{"without", Align::Left},
                   {"decided in"},
                   {"reported otherwise"},
                   {"right"},
                   {"wrong"},
                   {"false alarms"},
                   {"removed >= 0.9"},
                   {"processor [s]"}},
                  "Every rule of the search left out in turn");
  for (const studies::RuleRow& row : studies::rows_of(campaigns, arguments.options.rules)) {
    const bool all = row.rule.empty();
    table.add_row({all ? "none" : row.rule, all ? "-" : count_number(row.decided),
                   all ? "-" : count_number(row.changed), count_number(row.counts.right),
                   count_number(row.counts.wrong), count_number(row.counts.alarms),
                   fmt::format("{} of {}", row.counts.removed, row.counts.of_removed),
                   fixed_number(row.counts.seconds, 0)});
  }
  return fmt::format("rules of the search, {} campaigns of about {} readings, seeds from {}\n\n{}",
                     campaigns.size(), count_number(arguments.options.readings), arguments.options.seed,
                     table.text());
}

nlohmann::ordered_json rules_json(const RulesArguments& arguments,
                                  const std::vector<studies::RuleCampaign>& campaigns) {
  nlohmann::ordered_json json = {{"study", "rules"},
                                 {"seed", arguments.options.seed},
                                 {"readings", arguments.options.readings},
                                 {"campaigns", campaigns.size()},
                                 {"rows", nlohmann::ordered_json::array()}};
  for (const studies::RuleRow& row : studies::rows_of(campaigns, arguments.options.rules)) {
    json["rows"].push_back({{"without", row.rule},
                            {"decided", row.decided},
                            {"changed", row.changed},
                            {"right", row.counts.right},
                            {"wrong", row.counts.wrong},
                            {"false_alarms", row.counts.alarms},
                            {"removed", {{"count", row.counts.removed}, {"of", row.counts.of_removed}}},
                            {"processor_s", row.counts.seconds}});
  }
  return json;
}

int run_rules(RulesArguments arguments) {
  studies::RuleStudyOptions& options = arguments.options;
  complete_rows(options);
  if (options.rules.empty()) options.rules = names_of_rules();
  ProgressBar bar("rules");
  options.progress = counted_on(bar, "campaigns");
  const std::vector<studies::RuleCampaign> campaigns = studies::rule_study(options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return rules_json(arguments, campaigns); },
      [&] { return rules_text(arguments, campaigns); });
}

std::function<int()> define_rules(CLI::App& app) {
  auto arguments = std::make_shared<RulesArguments>();
  studies::RuleStudyOptions& options = arguments->options;
  options.campaigns = 5;
  add_campaign_options(app, options, "rules.jsonl");
  app.add_option("--without", options.rules, described_rules() + "; default: each in turn")
      ->delimiter(',')
      ->check(CLI::IsMember(names_of_rules()));
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
