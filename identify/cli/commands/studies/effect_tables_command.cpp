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
#include "volcal/studies/tables/effect_tables.h"

namespace volcal::cli {
namespace {

constexpr double kNothing = 0.05e-6;        // m, what two figures may differ by
constexpr double kAgreement = 0.05;         // of the printed error left
constexpr double kOfIdeal = 1.05;           // times the ideal of the format
constexpr double kVolumetricGoal = 1.0e-6;  // m, with a format that holds every error

struct EffectTablesArguments {
  studies::EffectTablesOptions options;
  bool json = false;
};

bool is_worse_than_rigid(const studies::EffectTablesRow& row) { return row.extended > row.rigid + kNothing; }

bool misses_ideal(const studies::EffectTablesRow& row) {
  if (row.volumetric) return row.extended > kVolumetricGoal;
  const double ideal = std::hypot(row.ideal, row.uncertainty);
  return row.extended > std::max(kOfIdeal * ideal, ideal + kNothing);
}

bool is_printed_wrong(const studies::EffectTablesRow& row) {
  return std::abs(row.printed - row.extended) > std::max(kAgreement * row.extended, kNothing);
}

std::string verdict_of(const studies::EffectTablesRow& row) {
  std::string text;
  const auto add = [&text](bool holds, const char* words) {
    if (holds) text += (text.empty() ? "" : ", ") + std::string(words);
  };
  add(is_worse_than_rigid(row), "above rigid");
  add(misses_ideal(row), row.volumetric ? "above 1 um" : "above ideal");
  add(is_printed_wrong(row), "printed otherwise");
  return text;
}

template <class Test>
int count_rows(const std::vector<studies::EffectTablesRow>& rows, Test test) {
  return static_cast<int>(std::ranges::count_if(rows, test));
}

std::string effect_rows_text(const EffectTablesArguments& arguments,
                             const std::vector<studies::EffectTablesRow>& rows) {
  TextTable table({{"structure", Align::Left},
                   {"effect", Align::Left},
                   {"format", Align::Left},
                   {"before [um]"},
                   {"rigid model [um]"},
                   {"with effect [um]"},
                   {"ideal of format [um]"},
                   {"u [um]"},
                   {"printed [um]"},
                   {"", Align::Left}},
                  "Volumetric error of the exact machine that applies the tables");
  std::string place;
  for (const studies::EffectTablesRow& row : rows) {
    const bool same = place == row.structure + row.effect;
    table.add_row({same ? "" : row.structure, same ? "" : row.effect, row.format,
                   fixed_number(row.before / kMicro, 2), fixed_number(row.rigid / kMicro, 2),
                   fixed_number(row.extended / kMicro, 2), fixed_number(row.ideal / kMicro, 2),
                   fixed_number(row.uncertainty / kMicro, 2), fixed_number(row.printed / kMicro, 2),
                   verdict_of(row)});
    place = row.structure + row.effect;
  }
  return fmt::format(
      "effects in tables, {} structures, seeds from {}\n\n{}\n{} rows: {} above the rigid model's, {} above "
      "the ideal of the format with the uncertainty u of the identified errors (1.05 times or 0.05 um; 1 um "
      "where the format holds every error), {} printed otherwise than by 5 % or 0.05 um\n",
      arguments.options.structures, arguments.options.seed, table.text(), rows.size(),
      count_rows(rows, is_worse_than_rigid), count_rows(rows, misses_ideal),
      count_rows(rows, is_printed_wrong));
}

nlohmann::ordered_json effect_rows_json(const EffectTablesArguments& arguments,
                                        const std::vector<studies::EffectTablesRow>& rows) {
  nlohmann::ordered_json json = {{"study", "effect-tables"},
                                 {"seed", arguments.options.seed},
                                 {"rows", nlohmann::ordered_json::array()}};
  for (const studies::EffectTablesRow& row : rows) {
    json["rows"].push_back({{"structure", row.structure},
                            {"effect", row.effect},
                            {"format", row.format},
                            {"type", row.type},
                            {"before_um", row.before / kMicro},
                            {"rigid_um", row.rigid / kMicro},
                            {"extended_um", row.extended / kMicro},
                            {"ideal_of_format_um", row.ideal / kMicro},
                            {"u_um", row.uncertainty / kMicro},
                            {"printed_um", row.printed / kMicro}});
  }
  json["summary"] = {{"above_rigid", count_rows(rows, is_worse_than_rigid)},
                     {"above_ideal", count_rows(rows, misses_ideal)},
                     {"printed_otherwise", count_rows(rows, is_printed_wrong)}};
  return json;
}

int run_effect_tables(EffectTablesArguments arguments) {
  ProgressBar bar("effect-tables");
  arguments.options.progress = counted_on(bar, "machines");
  const std::vector<studies::EffectTablesRow> rows = studies::effect_tables_study(arguments.options);
  bar.finish();
  return print_outcome(
      arguments.json, [&] { return effect_rows_json(arguments, rows); },
      [&] { return effect_rows_text(arguments, rows); });
}

std::function<int()> define_effect_tables(CLI::App& app) {
  auto arguments = std::make_shared<EffectTablesArguments>();
  studies::EffectTablesOptions& options = arguments->options;
  app.add_option("-n,--structures", options.structures, "how many of the four reference machines")
      ->check(CLI::Range(1, 4))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the first machine, the others follow")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--noise", options.noise, "of the readings, times the usual")
      ->check(positive())
      ->capture_default_str();
  app.add_option("--case", options.cases, "effects; default: all")
      ->check(CLI::IsMember(studies::effect_table_cases()));
  app.add_option("-f,--format", options.formats, "table formats; default: all")
      ->check(CLI::IsMember(table_format_names()));
  add_run_options(app, options.threads, arguments->json);
  return [arguments] { return run_effect_tables(*arguments); };
}

}  // namespace

const Command& effect_tables_command() {
  static const Command command = {
      "effect-tables",
      "simulated machines with effects that no rigid body has, compensated by tables with and without them",
      "  volcal study effect-tables\n"
      "  volcal study effect-tables -n 1 --case product --format csv --format neutral-csv\n",
      define_effect_tables};
  return command;
}

}  // namespace volcal::cli
