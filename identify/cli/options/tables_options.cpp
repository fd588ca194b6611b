#include "volcal/identify/cli/options/tables_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {
namespace {

std::string format_help() {
  std::string text = "table format:";
  for (const TableFormat* format : table_formats())
    text += fmt::format(" {} = {};", format->name, format->summary);
  text.back() = '.';
  return text;
}

/// A format that is known; of one that is not written, the reason.
std::string check_format_name(const std::string& name) {
  if (find_table_format(name) != nullptr) return {};
  for (const RefusedFormat& refused : refused_table_formats()) {
    if (refused.name == name) return fmt::format("{} is not written: {}", name, refused.reason);
  }
  return fmt::format("{} is not a table format; there are {}", name, fmt::join(table_format_names(), ", "));
}

CLI::Option& add_compensation_options(CLI::App& app, TablesArguments& arguments) {
  app.add_option("-f,--format", arguments.format, format_help())
      ->check(CLI::Validator(check_format_name, fmt::format("{{{}}}", fmt::join(table_format_names(), ","))));
  app.add_option(
      "--type", arguments.type,
      "what to compensate (ISO/TR 16907, 8.2): L-POS, L-STR, L-SQU, L-ANG, or L-VOL; of rotary axes "
      "R-POS, R-RAX, R-POR, R-ANG, or R-VOL; joined by +; default: all that the format can do");
  app.add_option("--tool", arguments.tool,
                 "tool that the compensation is for, default the first; with --at, default every tool");
  auto* step =
      app.add_option("--step", arguments.step_mm, "between the positions of a table, mm; default: chosen")
          ->check(positive());
  app.add_option(
         "--rotary-step", arguments.rotary_step_deg,
         "at most, between positions of rotary axes, deg; default 10 on grids and 5 in tables of one axis, "
         "or what the tolerance needs below that")
      ->check(CLI::Range(kFinestRotaryStep_deg, kCoarsestRotaryStep_deg));
  app.add_option(
         "--tolerance", arguments.tolerance_um,
         "choose the largest round steps at which the tables, read back, follow the ideal compensation "
         "this closely, um; default 0.2")
      ->check(positive())
      ->excludes(step);
  app.add_option(
      "--lines", arguments.lines,
      "where the specific lines of L-POS, L-STR and L-SQU cross, X=500,Y=300,Z=200 in mm, axes not "
      "named at home; default: the middle of the travel");
  app.add_option("--set", arguments.settings, "NAME=VALUE, a setting of the format (--list)");
  app.add_option("--superimpose", arguments.superimpose,
                 "folder of the tables that were active while the machine was measured: the new ones replace "
                 "them and correct both (ISO/TR 16907, 10.5)");
  app.add_option("--record", arguments.records,
                 fmt::format("NAME=TEXT into the metadata of the csv tables: {}",
                             fmt::join(recordable_conditions(), ", ")));
  app.add_option(
      "--picture", arguments.picture,
      "draw the tables of rotary axes as a PNG file: what they add to the commands, the error with and "
      "without them; by a headless Chromium");
  add_certificate_options(app, arguments.certificate);
  app.add_flag("--dry-run", arguments.dry_run, "write nothing: say what the tables would leave");
  app.add_flag("--list", arguments.list, "list formats, types and limits");
  return *step;
}

}  // namespace

void add_tables_options(CLI::App& app, TablesArguments& arguments) {
  app.add_option("RESULT", arguments.result,
                 "result folder of volcal fit, model.toml with values, or folder of tables --format csv");
  app.add_option("-o,--output", arguments.output, "folder for the tables");
  CLI::Option& step = add_compensation_options(app, arguments);
  add_alignment_options(app, arguments.alignment);
  app.add_option("--positions", arguments.positions,
                 "rows per function of the csv tables; default: round steps, 21 to 51 rows")
      ->check(CLI::Range(kFewestTableRows, kMostTableRows))
      ->excludes(&step);
  app.add_option("--grid", arguments.grid, "points per axis of the volumetric grid of the csv tables")
      ->check(CLI::Range(1, kMostGridPerAxis));
  app.add_option("--zero", arguments.zero,
                 "csv tables with reversal: mean of both directions is zero at home, or the + direction "
                 "(ISO/TR 16907, Table 1)")
      ->check(CLI::IsMember({"mean", "plus"}));
  app.add_option(
      "--at", arguments.at,
      "print the volumetric error at a point, X=100,Y=50 in mm and deg, axes not named at home, and with "
      "-o or --dry-run what the tables add to the command there; may be given several times");
  app.add_option("--approach", arguments.approach,
                 "X+,Y-: direction in which --at is approached; axes not named: mean of both");
  add_conditions_options(app, arguments.conditions);
  app.add_flag("--json", arguments.json, "print one JSON document and nothing else");
}

void require_options_that_say_something(const TablesArguments& arguments) {
  const bool makes_tables = !arguments.output.empty() || arguments.dry_run;
  if (arguments.result.empty())
    throw InputError({}, "no result is given", "give the folder that volcal fit wrote, or --list");
  if (arguments.at.empty() && !makes_tables)
    throw InputError({}, "neither a folder nor a point is given",
                     "give -o FOLDER, --dry-run, or --at X=100,Y=50");
  if (!arguments.approach.empty() && arguments.at.empty())
    throw InputError({}, "--approach says how points of --at are approached, and there is none",
                     "give --at X=100,Y=50, or leave --approach out");
  if (arguments.format == "csv") return;
  const auto refuse = [&](bool is_given, const char* option) {
    if (is_given)
      throw InputError(
          {}, fmt::format("{} shapes the tables of csv, and these are of {}", option, arguments.format),
          "leave it out, or give --format csv");
  };
  refuse(arguments.positions.has_value(), "--positions");
  refuse(arguments.grid.has_value(), "--grid");
  refuse(arguments.zero.has_value(), "--zero");
}

}  // namespace volcal::cli
