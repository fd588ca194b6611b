#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/studies/criticism/criticism_plan.h"
#include "volcal/studies/criticism/previews.h"

namespace volcal::cli {
namespace {

struct PreviewsArguments {
  studies::PreviewsOptions options;
  bool json = false;
};

std::string previews_text(const std::vector<studies::PreviewedCampaign>& campaigns) {
  TextTable table({{"campaign", Align::Left},
                   {"effect", Align::Left},
                   {"preview off by, of U95"},
                   {"refit"},
                   {"reported", Align::Left}},
                  "Previews or refits that did not hold");
  int failed = 0;
  for (const studies::PreviewedCampaign& campaign : campaigns) {
    failed += campaign.failure.empty() ? 0 : 1;
    for (const studies::PreviewRecord& preview : campaign.previews) {
      if (std::max(preview.miss, preview.refit_miss) >= 0.25)
        table.add_row({campaign.campaign, preview.effect, fixed_number(preview.miss, 2),
                       fixed_number(preview.refit_miss, 2), preview.said ? "yes" : "no"});
    }
  }
  return fmt::format(
      "linear previews of a session and refits against their full fits, {} campaigns ({} without any); "
      "intervals after Wilson\n\npreviews less than U95/4 from the full fit: {}\nrefits:  "
      "                                   {}\nof the other refits, reported as such:     {}\n\n{}",
      campaigns.size(), failed, studies::previews_that_held(campaigns).text(),
      studies::refits_that_held(campaigns).text(), studies::misses_said(campaigns).text(),
      table.empty() ? "" : table.text());
}

nlohmann::ordered_json share_json(const studies::Share& share) {
  const auto [low, high] = share.interval();
  return {
      {"count", share.count}, {"of", share.of}, {"share", share.value()}, {"low95", low}, {"high95", high}};
}

nlohmann::ordered_json previews_json(const PreviewsArguments& arguments,
                                     const std::vector<studies::PreviewedCampaign>& campaigns) {
  nlohmann::ordered_json json = {{"study", "previews"},
                                 {"seed", arguments.options.seed},
                                 {"readings", arguments.options.readings},
                                 {"held", share_json(studies::previews_that_held(campaigns))},
                                 {"refits_held", share_json(studies::refits_that_held(campaigns))},
                                 {"misses_said", share_json(studies::misses_said(campaigns))}};
  for (const studies::PreviewedCampaign& campaign : campaigns) {
    nlohmann::ordered_json entry = {{"campaign", campaign.campaign}, {"failure", campaign.failure}};
    for (const studies::PreviewRecord& preview : campaign.previews)
      entry["previews"].push_back({{"effect", preview.effect},
                                   {"miss", preview.miss},
                                   {"refit_miss", preview.refit_miss},
                                   {"said", preview.said}});
    json["campaigns"].push_back(entry);
  }
  return json;
}

int run_previews_study(PreviewsArguments arguments) {
  ProgressBar bar("previews");
  arguments.options.progress = counted_on(bar, "campaigns");
  const std::vector<studies::PreviewedCampaign> campaigns = studies::previews(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return previews_json(arguments, campaigns); },
      [&] { return previews_text(campaigns); }, 1);
}

std::function<int()> define_previews_study(CLI::App& app) {
  auto arguments = std::make_shared<PreviewsArguments>();
  studies::PreviewsOptions& options = arguments->options;
  const std::vector<std::string> rows(studies::criticism_rows().begin(), studies::criticism_rows().end());
  app.add_option("--rows", options.rows, "null, listed, unlisted, pairs, left-out, partial, mdb")
      ->delimiter(',')
      ->check(CLI::IsMember(rows))
      ->capture_default_str();
  app.add_option("-n,--campaigns", options.campaigns, "per row; 0: those of --campaign alone")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--campaign", options.files,
                 "campaign.toml, besides the simulated ones; may stand several times")
      ->check(CLI::ExistingFile);
  app.add_option("--seed", options.seed, "of the first campaign, the others follow")->capture_default_str();
  app.add_option("--readings", options.readings, "of a simulated campaign, about")
      ->check(CLI::Range(400, 100'000))
      ->capture_default_str();
  app.add_option("--most", options.most, "effects that are added to a campaign, one after another")
      ->check(positive())
      ->capture_default_str();
  add_archive_options(app, options.output, options.resume, "previews.jsonl");
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_previews_study(*arguments); };
}

}  // namespace

const Command& previews_study() {
  static const Command command = {
      "previews", "linear previews of the workbench against the full fits that confirm them, counted",
      "  volcal study previews -n 40 -o counted\n"
      "  volcal study previews -n 200 -o counted --resume\n"
      "  volcal study previews -n 0 --campaign campaign.toml\n",
      define_previews_study};
  return command;
}

}  // namespace volcal::cli
