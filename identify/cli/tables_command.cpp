#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "volcal/identify/cli/commands.h"
#include "volcal/identify/io/atomic_folder.h"
#include "volcal/identify/io/result_folder.h"
#include "volcal/identify/io/table_writer.h"
#include "volcal/identify/tables/error_tables.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {
namespace {

struct Arguments {
  std::string result;
  std::string output;
  std::string format = "csv";
  std::string zero = "mean";
  int positions = 0;
  int grid = 5;
  bool json = false;
};

int run(const Arguments& arguments) {
  const FitResult result = read_result(arguments.result);
  ErrorTableOptions options;
  options.positions = arguments.positions;
  options.zero_plus = arguments.zero == "plus";
  const auto table = error_table(result, options);
  const auto grid = volumetric_grid(result, arguments.grid);
  AtomicFolder folder(arguments.output);
  folder.write("error_tables.csv", error_tables_csv(table));
  folder.write("volumetric_grid.csv", volumetric_grid_csv(grid, result.machine));
  folder.commit();
  if (arguments.json) {
    const nlohmann::ordered_json json = {
        {"folder", arguments.output}, {"error_table_rows", table.size()}, {"grid_rows", grid.size()}};
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{}: error_tables.csv ({} rows), volumetric_grid.csv ({} rows)\n", arguments.output,
               table.size(), grid.size());
    for (const std::string& invisible : result.rank.invisible) fmt::print("! {}\n", invisible);
  }
  return result.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

std::function<int()> define(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  app.add_option("RESULT", arguments->result, "result folder of volcal fit")->required();
  app.add_option("-o,--output", arguments->output, "folder for the tables")->required();
  app.add_option("-f,--format", arguments->format, "table format")->check(CLI::IsMember({"csv"}));
  app.add_option("--positions", arguments->positions,
                 "rows per function; default: round steps, 21 to 51 rows")
      ->check(CLI::Range(2, 100000));
  app.add_option("--grid", arguments->grid, "points per axis of the volumetric grid")
      ->check(CLI::Range(1, 101));
  app.add_option(
         "--zero", arguments->zero,
         "with reversal: mean of both directions is zero at home, or the + direction (ISO/TR 16907, Table 1)")
      ->check(CLI::IsMember({"mean", "plus"}));
  app.add_flag("--json", arguments->json, "print one JSON document and nothing else");
  return [arguments] { return run(*arguments); };
}

}  // namespace

const Command& tables_command() {
  static const Command command = {"tables", "write the error tables of an identified machine",
                                  "  volcal tables result -o tables\n"
                                  "  volcal tables result --positions 101 --grid 9 -o tables\n"
                                  "  volcal tables result --zero plus -o tables\n",
                                  define};
  return command;
}

}  // namespace volcal::cli
