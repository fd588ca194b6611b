#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "volcal/identify/cli/commands/studies/studies.h"
#include "volcal/identify/cli/commands/studies/study_run.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"
#include "volcal/studies/tables/compensation.h"

namespace volcal::cli {
namespace {

using CompensationRows = std::vector<studies::CompensationStudyRow>;

struct CompensationArguments {
  studies::CompensationStudyOptions options;
  bool json = false;
};

/// Worst of the rows without a variant.
struct CompensationSummary {
  double least_before = 1e9;  ///< m
  double ratio = 0.0;         ///< applied / ideal, formats that tell directions apart, but for L-VOL
  double ratio_format = 0.0;  ///< applied / ideal within the format's limits, but for L-VOL
  double volumetric = 0.0;    ///< L-VOL left, formats that tell directions apart, m
};

bool tells_directions(const studies::CompensationStudyRow& row) {
  return find_table_format(row.format)->limits.both_directions;
}

CompensationSummary summary_of(const CompensationRows& rows) {
  CompensationSummary summary;
  for (const studies::CompensationStudyRow& row : rows) {
    summary.least_before = std::min(summary.least_before, row.before);
    if (!row.variant.empty()) continue;
    const bool volumetric = row.type == CompensationType::volumetric().name();
    if (volumetric && tells_directions(row)) {
      summary.volumetric = std::max(summary.volumetric, row.applied);
      continue;
    }
    summary.ratio_format = std::max(summary.ratio_format, row.applied / row.ideal_format);
    if (row.ideal_format == row.ideal) summary.ratio = std::max(summary.ratio, row.applied / row.ideal);
  }
  return summary;
}

/// "-" where the ideal compensation leaves nothing to compare with.
std::string ratio_to(double ideal, double applied) {
  constexpr double kNoDisplacement = 0.05e-6;  // m
  return ideal < kNoDisplacement ? "-" : fixed_number(applied / ideal, 2);
}

std::string compensation_rows_text(const CompensationArguments& arguments, const CompensationRows& rows) {
  TextTable table(
      {{"structure", Align::Left},
       {"format", Align::Left},
       {"type", Align::Left},
       {"before [um]"},
       {"ideal [um]"},
       {"of format [um]"},
       {"applied [um]"},
       {"ratio"},
       {"of format"},
       {"read before [um]"},
       {"read after [um]"},
       {"", Align::Left}},
      fmt::format("Volumetric error of tool {} at fresh points from both sides; read: other setups "
                  "against the nominal machine",
                  studies::kCompensatedTool));
  std::string structure;
  for (const studies::CompensationStudyRow& row : rows) {
    table.add_row({row.structure == structure ? "" : row.structure, row.format, row.type,
                   fixed_number(row.before / kMicro, 2), fixed_number(row.ideal / kMicro, 2),
                   fixed_number(row.ideal_format / kMicro, 2), fixed_number(row.applied / kMicro, 2),
                   ratio_to(row.ideal, row.applied), ratio_to(row.ideal_format, row.applied),
                   fixed_number(row.read_before / kMicro, 2), fixed_number(row.read_after / kMicro, 2),
                   row.variant});
    structure = row.structure;
  }
  const CompensationSummary summary = summary_of(rows);
  return fmt::format(
      "compensation, {} machines, seeds from {}\n\n{}\nleast before {:.2f} um; worst ratio to the ideal of a "
      "format that tells directions apart or needs not to {:.3f}, to what a format can hold {:.3f}; L-VOL by "
      "direction leaves at most {:.2f} um\n",
      arguments.options.machines, arguments.options.seed, table.text(), summary.least_before / kMicro,
      summary.ratio, summary.ratio_format, summary.volumetric / kMicro);
}

nlohmann::ordered_json compensation_rows_json(const CompensationArguments& arguments,
                                              const CompensationRows& rows) {
  nlohmann::ordered_json json = {{"study", "compensation"},
                                 {"seed", arguments.options.seed},
                                 {"tool", studies::kCompensatedTool},
                                 {"rows", nlohmann::ordered_json::array()}};
  for (const studies::CompensationStudyRow& row : rows) {
    nlohmann::ordered_json entry = {{"structure", row.structure},
                                    {"format", row.format},
                                    {"type", row.type},
                                    {"variant", row.variant},
                                    {"before_um", row.before / kMicro},
                                    {"ideal_um", row.ideal / kMicro},
                                    {"ideal_of_format_um", row.ideal_format / kMicro},
                                    {"applied_um", row.applied / kMicro}};
    if (!std::isnan(row.read_after)) {
      entry["read_before_um"] = row.read_before / kMicro;
      entry["read_after_um"] = row.read_after / kMicro;
    }
    json["rows"].push_back(entry);
  }
  const CompensationSummary summary = summary_of(rows);
  json["summary"] = {{"least_before_um", summary.least_before / kMicro},
                     {"worst_ratio", summary.ratio},
                     {"worst_ratio_of_format", summary.ratio_format},
                     {"volumetric_left_um", summary.volumetric / kMicro}};
  return json;
}

int run_compensation_study(CompensationArguments arguments) {
  ProgressBar bar("compensation");
  arguments.options.progress = counted_on(bar, "machines");
  const CompensationRows rows = studies::compensation_study(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return compensation_rows_json(arguments, rows); },
      [&] { return compensation_rows_text(arguments, rows); });
}

std::function<int()> define_compensation_study(CLI::App& app) {
  auto arguments = std::make_shared<CompensationArguments>();
  studies::CompensationStudyOptions& options = arguments->options;
  app.add_option("-n,--machines", options.machines, "structures take turns")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the first machine, the others follow")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("-f,--format", options.formats, "table formats; default: all")
      ->check(CLI::IsMember(table_format_names()));
  app.add_flag("--small", options.small, "1,920 readings a campaign instead of 6,048, fewer fresh points");
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_compensation_study(*arguments); };
}

}  // namespace

const Command& compensation_study_command() {
  static const Command command = {
      "compensation",
      "simulated machines measured, identified, compensated with the files of every format, measured again",
      "  volcal study compensation\n"
      "  volcal study compensation -n 2 --small --format linuxcnc --format neutral-csv\n",
      define_compensation_study};
  return command;
}

}  // namespace volcal::cli
