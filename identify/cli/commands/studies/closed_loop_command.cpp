#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"
#include "volcal/studies/closed_loop.h"

namespace volcal::cli {
namespace {

struct ClosedLoopArguments {
  studies::ClosedLoopOptions options;
  std::string noise = "white";
  bool small = false;
  bool json = false;
};

using ClosedLoopCampaigns = std::vector<studies::ClosedLoopCampaign>;

double quantile(std::vector<double> values, double p) {
  std::ranges::sort(values);
  const double place = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

struct MeanWithError {
  double mean = 0.0;
  double standard_error = 0.0;
};

MeanWithError mean_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, n > 1.0 ? std::sqrt(squares / (n - 1.0) / n) : std::nan("")};
}

template <class Figure>
std::vector<double> collect(const ClosedLoopCampaigns& campaigns, const Figure& figure) {
  std::vector<double> values;
  for (const studies::ClosedLoopCampaign& campaign : campaigns) values.push_back(figure(campaign));
  return values;
}

struct Row {
  std::string structure;
  int campaigns = 0;
  double before = 0.0;
  double median = 0.0;
  double worst = 0.0;
  double median_fixed = 0.0;
  double worst_ratio = 0.0;
  MeanWithError chi2;
  MeanWithError coverage;
  double coverage_5th = 0.0;
  double median_white = 0.0;
  MeanWithError white_coverage;
};

Row row_of(const std::string& name, const ClosedLoopCampaigns& campaigns) {
  const auto after = collect(campaigns, [](const auto& c) { return c.rms_after; });
  const auto coverage = collect(campaigns, [](const auto& c) { return studies::mean_coverage(c.coverage); });
  const auto white =
      collect(campaigns, [](const auto& c) { return studies::mean_coverage(c.white_coverage); });
  const auto ratio = collect(campaigns, [](const auto& c) { return c.rms_after / c.best_fixed(); });
  return {name,
          static_cast<int>(campaigns.size()),
          quantile(collect(campaigns, [](const auto& c) { return c.rms_before; }), 0.5),
          quantile(after, 0.5),
          std::ranges::max(after),
          quantile(collect(campaigns, [](const auto& c) { return c.best_fixed(); }), 0.5),
          std::ranges::max(ratio),
          mean_of(collect(campaigns, [](const auto& c) { return c.reduced_chi2; })),
          mean_of(coverage),
          quantile(coverage, 0.05),
          quantile(collect(campaigns, [](const auto& c) { return c.white_rms_after; }), 0.5),
          mean_of(white)};
}

std::vector<Row> rows_of(const ClosedLoopCampaigns& campaigns) {
  std::map<std::string, ClosedLoopCampaigns> by_structure;
  std::vector<std::string> order;
  for (const studies::ClosedLoopCampaign& campaign : campaigns) {
    if (!by_structure.contains(campaign.structure)) order.push_back(campaign.structure);
    by_structure[campaign.structure].push_back(campaign);
  }
  std::vector<Row> rows;
  rows.reserve(order.size() + 1);
  for (const std::string& structure : order) rows.push_back(row_of(structure, by_structure[structure]));
  rows.push_back(row_of("all", campaigns));
  return rows;
}

/// Share per symbol over the campaigns: mean and 5th percentile.
std::map<std::string, std::vector<double>> coverage_by_symbol(const ClosedLoopCampaigns& campaigns) {
  std::map<std::string, std::vector<double>> shares;
  for (const studies::ClosedLoopCampaign& campaign : campaigns) {
    for (const auto& [symbol, share] : campaign.coverage) shares[symbol].push_back(share);
  }
  return shares;
}

std::string closed_loop_text(const ClosedLoopArguments& arguments, const ClosedLoopCampaigns& campaigns) {
  const bool fixed = arguments.options.fixed_knots;
  const bool correlated = arguments.options.correlated_noise;
  const auto percent = [](const MeanWithError& share) {
    return fmt::format("{:.1f} +- {:.1f}", 100.0 * share.mean, 100.0 * share.standard_error);
  };
  std::vector<TextColumn> columns = {
      {"structure", Align::Left}, {"campaigns"},   {"before [um]"}, {"median [um]"},  {"worst [um]"},
      {"best fixed [um]"},        {"worst ratio"}, {"chi2/dof"},    {"coverage [%]"}, {"5th [%]"}};
  if (correlated) columns.insert(columns.end(), {{"white: median [um]"}, {"white: coverage [%]"}});
  TextTable table(columns,
                  "Volumetric error at fresh points before and after, best of five fixed knot sets with "
                  "hindsight, coverage of U95 in the tables");
  for (const Row& row : rows_of(campaigns)) {
    std::vector<std::string> cells = {row.structure,
                                      count_number(row.campaigns),
                                      fixed_number(row.before * kPerMicro, 2),
                                      fixed_number(row.median * kPerMicro, 3),
                                      fixed_number(row.worst * kPerMicro, 3),
                                      fixed ? fixed_number(row.median_fixed * kPerMicro, 3) : "-",
                                      fixed ? fixed_number(row.worst_ratio, 2) : "-",
                                      fmt::format("{:.3f} +- {:.3f}", row.chi2.mean, row.chi2.standard_error),
                                      percent(row.coverage),
                                      fixed_number(100.0 * row.coverage_5th, 1)};
    if (correlated) {
      cells.push_back(fixed_number(row.median_white * kPerMicro, 3));
      cells.push_back(percent(row.white_coverage));
    }
    table.add_row(cells);
  }
  TextTable symbols({{"symbol", Align::Left}, {"coverage [%]"}, {"5th percentile [%]"}},
                    "Coverage per symbol over the campaigns");
  for (const auto& [symbol, shares] : coverage_by_symbol(campaigns)) {
    const MeanWithError share = mean_of(shares);
    symbols.add_row({symbol, percent(share), fixed_number(100.0 * quantile(shares, 0.05), 1)});
  }
  return fmt::format(
      "closed loop, {} campaigns, seeds from {}; +- is one standard error of the mean\n\n{}\n{}",
      arguments.options.campaigns, arguments.options.seed, table.text(), symbols.text());
}

nlohmann::ordered_json closed_loop_json(const ClosedLoopArguments& arguments,
                                        const ClosedLoopCampaigns& campaigns) {
  nlohmann::ordered_json json = {{"study", "closed-loop"},
                                 {"seed", arguments.options.seed},
                                 {"shared_sources", arguments.options.shared_sources}};
  for (const studies::ClosedLoopCampaign& campaign : campaigns) {
    nlohmann::ordered_json entry = {{"structure", campaign.structure},
                                    {"seed", campaign.seed},
                                    {"rms_before_um", campaign.rms_before * kPerMicro},
                                    {"rms_after_um", campaign.rms_after * kPerMicro},
                                    {"reduced_chi2", campaign.reduced_chi2},
                                    {"coverage95", studies::mean_coverage(campaign.coverage)},
                                    {"coverage95_of", campaign.coverage}};
    if (arguments.options.fixed_knots) {
      for (const double rms : campaign.rms_fixed) entry["rms_fixed_um"].push_back(rms * kPerMicro);
    }
    if (arguments.options.correlated_noise) {
      entry["white_rms_after_um"] = campaign.white_rms_after * kPerMicro;
      entry["white_coverage95"] = studies::mean_coverage(campaign.white_coverage);
    }
    json["campaigns"].push_back(entry);
  }
  for (const Row& row : rows_of(campaigns)) {
    nlohmann::ordered_json entry = {{"structure", row.structure},
                                    {"campaigns", row.campaigns},
                                    {"median_rms_before_um", row.before * kPerMicro},
                                    {"median_rms_after_um", row.median * kPerMicro},
                                    {"worst_rms_after_um", row.worst * kPerMicro},
                                    {"mean_reduced_chi2", row.chi2.mean},
                                    {"mean_coverage95", row.coverage.mean},
                                    {"coverage95_5th_percentile", row.coverage_5th}};
    if (arguments.options.fixed_knots) {
      entry["median_best_fixed_um"] = row.median_fixed * kPerMicro;
      entry["worst_ratio_to_best_fixed"] = row.worst_ratio;
    }
    if (arguments.options.correlated_noise) {
      entry["white_median_rms_after_um"] = row.median_white * kPerMicro;
      entry["white_mean_coverage95"] = row.white_coverage.mean;
    }
    json["summary"].push_back(entry);
  }
  return json;
}

int run_closed_loop_study(ClosedLoopArguments arguments) {
  if (arguments.small) arguments.options.grid = {6, 5, 4};
  arguments.options.correlated_noise = arguments.noise == "correlated";
  ProgressBar bar("closed loop");
  arguments.options.progress = counted_on(bar, "campaigns");
  const ClosedLoopCampaigns campaigns = studies::closed_loop(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return closed_loop_json(arguments, campaigns); },
      [&] { return closed_loop_text(arguments, campaigns); });
}

std::function<int()> define_closed_loop_study(CLI::App& app) {
  auto arguments = std::make_shared<ClosedLoopArguments>();
  studies::ClosedLoopOptions& options = arguments->options;
  app.add_option("-n,--campaigns", options.campaigns, "structures take turns")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the first campaign, the others follow")
      ->check(not_negative())
      ->capture_default_str();
  app.add_flag("--fixed", options.fixed_knots,
               "fit five fixed sets of knot intervals too and compare with the best of them");
  app.add_option(
         "--noise", arguments->noise,
         "of the readings: white, or correlated: with correlated drift (0.4 um, 10 min) and offsets of lines "
         "(0.2 um), fitted with white weights too")
      ->check(CLI::IsMember({"white", "correlated"}))
      ->capture_default_str();
  app.add_flag(
      "--shared", options.shared_sources,
      "with a scale of the laser (0.3 um/m) and offsets of the tools (3 um) that are wrong by what the "
      "campaign states, drawn anew for every campaign");
  app.add_flag("--small", arguments->small, "1,920 readings a campaign instead of 6,048");
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_closed_loop_study(*arguments); };
}

}  // namespace

const Command& closed_loop_study() {
  static const Command command = {
      "closed-loop", "simulated machines identified: error left, resolution and coverage of U95, counted",
      "  volcal study closed-loop -n 80 --fixed\n"
      "  volcal study closed-loop -n 20 --noise correlated\n"
      "  volcal study closed-loop -n 200 --shared\n"
      "  volcal study closed-loop -n 4 --small --json\n",
      define_closed_loop_study};
  return command;
}

}  // namespace volcal::cli
