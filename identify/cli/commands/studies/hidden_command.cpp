#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/studies/criticism/hidden_datasets.h"

namespace volcal::cli {
namespace {

constexpr double kStrong = 12.0;       // signal to noise from which the goal holds
constexpr double kRemoved = 0.9;       // share of the systematic error
constexpr std::size_t kMostWords = 3;  // of what is offered

struct HiddenArguments {
  studies::HiddenDatasetOptions options;
  bool json = false;
};

using HiddenRows = std::vector<studies::HiddenDatasetRow>;

bool is_strong(const studies::HiddenDatasetRow& row) { return !row.hidden.empty() && row.signal >= kStrong; }
bool is_removed(const studies::HiddenDatasetRow& row) { return row.share >= kRemoved; }

struct StrongRows {
  std::size_t all = 0;
  std::size_t removed = 0;
};

StrongRows count_strong(const HiddenRows& rows) {
  StrongRows count;
  for (const studies::HiddenDatasetRow& row : rows) {
    if (!is_strong(row)) continue;
    ++count.all;
    count.removed += is_removed(row) ? 1 : 0;
  }
  return count;
}

/// The first few, and how many more.
std::string listed(const std::vector<std::string>& labels) {
  const std::size_t shown = std::min(labels.size(), kMostWords);
  const std::vector<std::string> first(labels.begin(), labels.begin() + static_cast<std::ptrdiff_t>(shown));
  const std::string text = fmt::format("{}", fmt::join(first, ", "));
  return labels.size() > shown ? text + fmt::format(" and {} more", labels.size() - shown) : text;
}

/// "exchange 3", of every rule.
std::vector<std::string> rules_with_counts(const HiddenRows& rows) {
  std::vector<std::string> counts;
  for (const SearchRule rule : search_rules()) {
    const auto count =
        std::ranges::count_if(rows, [name = name_of(rule)](const studies::HiddenDatasetRow& row) {
          return std::ranges::find(row.decided, name) != row.decided.end();
        });
    counts.push_back(fmt::format("{} {}", name_of(rule), count));
  }
  return counts;
}

std::string hidden_rows_text(const HiddenRows& rows) {
  TextTable table({{"campaign", Align::Left},
                   {"hidden", Align::Left},
                   {"s"},
                   {"verdict", Align::Left},
                   {"given [um]"},
                   {"offered [um]"},
                   {"nothing hidden [um]"},
                   {"removed"},
                   {"the offered model adds", Align::Left}},
                  "Error of predictions at unseen positions without noise, root mean square");
  for (const studies::HiddenDatasetRow& row : rows) {
    const std::string share = std::isnan(row.share) ? "-" : fixed_number(row.share, 2);
    table.add_row({row.name, row.hidden.empty() ? "nothing" : fmt::format("{}", fmt::join(row.hidden, ", ")),
                   fixed_number(row.signal, 1), row.verdict, fixed_number(row.given_um, 3),
                   fixed_number(row.offered_um, 3), fixed_number(row.clean_um, 3), share,
                   listed(row.offered)});
  }
  const StrongRows strong = count_strong(rows);
  return fmt::format(
      "{}\n{} of {} campaigns with s >= {:g} lose {:g} of their systematic error or more\n"
      "Campaigns in which a rule of the search decided something: {}\n",
      table.text(), strong.removed, strong.all, kStrong, kRemoved, fmt::join(rules_with_counts(rows), ", "));
}

nlohmann::ordered_json hidden_rows_json(const HiddenRows& rows) {
  nlohmann::ordered_json json = {{"study", "hidden"}, {"campaigns", nlohmann::ordered_json::array()}};
  for (const studies::HiddenDatasetRow& row : rows) {
    nlohmann::ordered_json share = nullptr;
    if (!std::isnan(row.share)) share = row.share;
    json["campaigns"].push_back({{"campaign", row.name},
                                 {"hidden", row.hidden},
                                 {"signal", row.signal},
                                 {"verdict", row.verdict},
                                 {"offered", row.offered},
                                 {"given_um", row.given_um},
                                 {"offered_um", row.offered_um},
                                 {"nothing_hidden_um", row.clean_um},
                                 {"removed", share},
                                 {"rules_decided", row.decided}});
  }
  const StrongRows strong = count_strong(rows);
  json["strong"] = {{"signal", kStrong}, {"share", kRemoved}, {"count", strong.removed}, {"of", strong.all}};
  return json;
}

int run_hidden(HiddenArguments arguments) {
  ProgressBar bar("hidden");
  arguments.options.progress = counted_on(bar, "campaigns");
  const HiddenRows rows = studies::hidden_datasets(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return hidden_rows_json(rows); }, [&] { return hidden_rows_text(rows); });
}

std::function<int()> define_hidden(CLI::App& app) {
  auto arguments = std::make_shared<HiddenArguments>();
  studies::HiddenDatasetOptions& options = arguments->options;
  app.add_option("FOLDER", options.folder, "of study files (volcal simulate) with [[hidden]] effects")
      ->required();
  app.add_option("--campaign", options.names, "names of study files, without .toml; default: all")
      ->delimiter(',');
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_hidden(*arguments); };
}

}  // namespace

const Command& hidden_study() {
  static const Command command = {
      "hidden", "campaigns with something hidden: the systematic error that the offered model removes",
      "  volcal study hidden datasets/hidden/sealed\n"
      "  volcal study hidden datasets/hidden/sealed --campaign 04,23 --json\n",
      define_hidden};
  return command;
}

}  // namespace volcal::cli
