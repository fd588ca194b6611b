#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/studies/agreement.h"

namespace volcal::cli {
namespace {

struct AgreementArguments {
  studies::AgreementOptions options;
  bool json = false;
};

/// Ratios of one symbol's values, or of all.
struct RatioRange {
  std::size_t values = 0;
  double least[2] = {INFINITY, INFINITY};
  double largest[2] = {0.0, 0.0};

  void add(const studies::AgreedValue& value) {
    const double ratio[2] = {value.u_montecarlo / value.u_linear, value.u_scatter / value.u_linear};
    ++values;
    for (int k = 0; k < 2; ++k) {
      least[k] = std::min(least[k], ratio[k]);
      largest[k] = std::max(largest[k], ratio[k]);
    }
  }
};

std::map<std::string, RatioRange> by_symbol(const std::vector<studies::AgreedValue>& values) {
  std::map<std::string, RatioRange> ranges;
  for (const studies::AgreedValue& value : values) {
    ranges[value.symbol.name()].add(value);
    ranges["all"].add(value);
  }
  return ranges;
}

std::string agreement_text(const studies::AgreementOptions& options,
                           const std::vector<studies::AgreedValue>& values) {
  TextTable table({{"symbol", Align::Left}, {"values"}, {"Monte Carlo / linear"}, {"scatter / linear"}},
                  "Standard uncertainties of the table values, least to largest ratio");
  const auto range = [](const RatioRange& of, int k) {
    return fmt::format("{:.3f} to {:.3f}", of.least[k], of.largest[k]);
  };
  const auto ranges = by_symbol(values);
  for (const auto& [symbol, of] : ranges) {
    if (symbol != "all") table.add_row({symbol, count_number(of.values), range(of, 0), range(of, 1)});
  }
  const RatioRange& all = ranges.at("all");
  table.add_row({"all", count_number(all.values), range(all, 0), range(all, 1)});
  return fmt::format(
      "agreement, {} simulated campaigns and {} draws, structure {}, seed {}; by chance a ratio scatters by "
      "{:.2f} % (scatter) and {:.2f} % (Monte Carlo)\n\n{}",
      options.campaigns, options.draws,
      sim::reference_machines().at(static_cast<std::size_t>(options.structure)).structure.code, options.seed,
      100.0 / std::sqrt(2.0 * (options.campaigns - 1)),
      100.0 / std::sqrt(2.0 * (static_cast<double>(options.draws) - 1.0)), table.text());
}

nlohmann::ordered_json agreement_json(const studies::AgreementOptions& options,
                                      const std::vector<studies::AgreedValue>& values) {
  nlohmann::ordered_json json = {
      {"study", "agreement"}, {"campaigns", options.campaigns}, {"draws", options.draws}};
  for (const studies::AgreedValue& value : values) {
    json["values"].push_back({{"symbol", value.symbol.name()},
                              {"montecarlo_over_linear", value.u_montecarlo / value.u_linear},
                              {"scatter_over_linear", value.u_scatter / value.u_linear}});
  }
  return json;
}

int run_agreement(AgreementArguments arguments) {
  ProgressBar bar("agreement");
  arguments.options.progress = counted_on(bar, "campaigns");
  const std::vector<studies::AgreedValue> values = studies::agreement(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return agreement_json(arguments.options, values); },
      [&] { return agreement_text(arguments.options, values); });
}

std::function<int()> define_agreement(CLI::App& app) {
  auto arguments = std::make_shared<AgreementArguments>();
  studies::AgreementOptions& options = arguments->options;
  app.add_option("-n,--campaigns", options.campaigns)->check(CLI::Range(2, 1000000))->capture_default_str();
  app.add_option("--draws", options.draws, "of Monte Carlo")
      ->check(CLI::Range(2, 100000000))
      ->capture_default_str();
  app.add_option("--structure", options.structure, "of the four reference machines, from 0")
      ->check(CLI::Range(0, 3))
      ->capture_default_str();
  app.add_option("--seed", options.seed)->check(not_negative())->capture_default_str();
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_agreement(*arguments); };
}

}  // namespace

const Command& agreement_study() {
  static const Command command = {
      "agreement",
      "uncertainties by linear propagation, Monte Carlo and the scatter of repeated simulated campaigns",
      "  volcal study agreement -n 1000 --draws 1000\n"
      "  volcal study agreement -n 10000 --draws 10000\n",
      define_agreement};
  return command;
}

}  // namespace volcal::cli
