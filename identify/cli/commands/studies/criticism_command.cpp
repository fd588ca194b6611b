#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <nlohmann/json.hpp>

#include "volcal/identify/cli/commands/studies/criticism_options.h"
#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/model/description/errors.h"
#include "volcal/studies/criticism/criticism.h"
#include "volcal/studies/criticism/criticism_campaign.h"
#include "volcal/studies/criticism/criticism_detection.h"
#include "volcal/studies/criticism/criticism_figures.h"
#include "volcal/studies/criticism/criticism_plan.h"
#include "volcal/studies/files/simulation_writer.h"

namespace volcal::cli {
namespace {

struct CriticismArguments {
  studies::CriticismOptions options;
  std::string one;                   ///< ROW:INDEX
  std::vector<std::string> without;  ///< names of rules
  bool json = false;
};

std::string criticism_text(const CriticismArguments& arguments, const studies::Campaigns& campaigns) {
  TextTable figures({{"", Align::Left}, {"share (95 % interval), count", Align::Left}, {"goal", Align::Left}},
                    "Figures; s is the visible signal to noise |g~ a|");
  for (const studies::Figure& figure : studies::figures_of(campaigns))
    figures.add_row({figure.what, figure.share.text(), figure.goal});
  TextTable detections(
      {{"effect", Align::Left}, {"campaigns"}, {"ratio"}, {"95 % interval"}},
      "Amplitude found in 80 % of campaigns over the stated detectable one (goal 0.9 to 1.1)");
  for (const studies::Detection& detection : studies::detections_of(campaigns)) {
    detections.add_row({detection.effect, count_number(detection.campaigns), fixed_number(detection.ratio, 3),
                        fixed_number(detection.low, 3) + " to " + fixed_number(detection.high, 3)});
  }
  TextTable confusion({{"row | hidden", Align::Left}, {"reported", Align::Left}, {"campaigns"}},
                      "Hidden effects, and what the diagnosis reported");
  for (const auto& [hidden, answers] : studies::confusion_of(campaigns)) {
    for (const auto& [reported, count] : answers) confusion.add_row({hidden, reported, count_number(count)});
  }
  const studies::CriticismOptions& options = arguments.options;
  return fmt::format(
      "model criticism, {} campaigns a row (nothing hidden: a kind of noise) of about {} readings, seeds "
      "from "
      "{}{}; intervals after Wilson\n\n{}\n{}{}{}",
      options.campaigns, count_number(options.readings), options.seed,
      arguments.without.empty() ? "" : fmt::format("; without {}", fmt::join(arguments.without, ", ")),
      figures.text(), detections.text(), detections.empty() ? "" : "\n", confusion.text());
}

nlohmann::ordered_json criticism_json(const CriticismArguments& arguments,
                                      const studies::Campaigns& campaigns) {
  nlohmann::ordered_json json = {
      {"study", "criticism"}, {"seed", arguments.options.seed}, {"readings", arguments.options.readings}};
  for (const studies::Figure& figure : studies::figures_of(campaigns)) {
    const auto [low, high] = figure.share.interval();
    json["figures"].push_back({{"figure", figure.what},
                               {"count", figure.share.count},
                               {"of", figure.share.of},
                               {"share", figure.share.value()},
                               {"low95", low},
                               {"high95", high},
                               {"goal", figure.goal}});
  }
  for (const studies::Detection& detection : studies::detections_of(campaigns)) {
    json["detection"].push_back({{"effect", detection.effect},
                                 {"campaigns", detection.campaigns},
                                 {"ratio", detection.ratio},
                                 {"low95", detection.low},
                                 {"high95", detection.high}});
  }
  json["confusion"] = studies::confusion_of(campaigns);
  for (const studies::CampaignRecord& record : campaigns) {
    nlohmann::json entry = record;
    entry["outcome"] = studies::to_string(studies::outcome_of(record));
    json["campaigns"].push_back(nlohmann::ordered_json(entry));
  }
  return json;
}

/// One campaign as files, for a closer look.
int write_one(const CriticismArguments& arguments) {
  const studies::CriticismOptions& options = arguments.options;
  const std::size_t colon = arguments.one.find(':');
  const std::string row = arguments.one.substr(0, colon), number = arguments.one.substr(colon + 1);
  int index = -1;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
  const bool is_number = error == std::errc() && end == number.data() + number.size() && index >= 0;
  if (colon == std::string::npos || !is_number ||
      std::ranges::find(studies::criticism_rows(), row) == studies::criticism_rows().end()) {
    throw InputError({"--one " + arguments.one, 0}, "it is not a row and an index", "write listed:11");
  }
  if (options.output.empty()) throw InputError({"--one", 0}, "it needs a folder", "add -o FOLDER");
  const auto study = studies::study_of_campaign(row, index, options.seed, options.readings);
  if (!study) {
    throw InputError({"--one " + arguments.one, 0}, "no effect drawn is visible in this layout",
                     "choose another index");
  }
  AtomicFolder folder(options.output);
  write_simulation(sim::simulate(*study), folder);
  folder.commit();
  fmt::print("campaign {} of row {} written to {}\nnext: volcal diagnose {}/campaign.toml --auto\n", index,
             row, options.output, options.output);
  return kDone;
}

int run_criticism_study(CriticismArguments arguments) {
  if (!arguments.one.empty()) return write_one(arguments);
  studies::CriticismOptions& options = arguments.options;
  complete_rows(options);
  for (const std::string& name : arguments.without) {
    if (const auto rule = search_rule_of(name)) options.without.insert(*rule);
  }
  ProgressBar bar("criticism");
  options.progress = counted_on(bar, "campaigns");
  const studies::Campaigns campaigns = studies::criticism(options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return criticism_json(arguments, campaigns); },
      [&] { return criticism_text(arguments, campaigns); }, 1);
}

std::function<int()> define_criticism_study(CLI::App& app) {
  auto arguments = std::make_shared<CriticismArguments>();
  studies::CriticismOptions& options = arguments->options;
  add_campaign_options(app, options, "campaigns.jsonl");
  app.add_option("--one", arguments->one,
                 "ROW:INDEX: write this campaign to the output folder, and what is hidden in it, and stop");
  app.add_option("--without", arguments->without, "rules that are left out, names of volcal study rules")
      ->delimiter(',')
      ->check(CLI::IsMember(names_of_rules()));
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_criticism_study(*arguments); };
}

}  // namespace

const Command& criticism_study() {
  static const Command command = {
      "criticism", "effects hidden in simulated campaigns: what diagnose says of them, counted",
      "  volcal study criticism --rows null,listed -n 40 -o counted\n"
      "  volcal study criticism --rows null,listed -n 200 -o counted --resume\n"
      "  volcal study criticism --rows unlisted -n 20 --json\n"
      "  volcal study criticism --one listed:11 -o campaign\n",
      define_criticism_study};
  return command;
}

}  // namespace volcal::cli
