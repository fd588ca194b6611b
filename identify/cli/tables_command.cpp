#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/io/atomic_folder.h"
#include "volcal/identify/io/result_folder.h"
#include "volcal/identify/tables/table_format.h"

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

std::string format_help() {
  std::string text = "table format:";
  for (const TableFormat* format : table_formats())
    text += fmt::format(" {} = {};", format->name, format->summary);
  text.back() = '.';
  return text;
}

int run(const Arguments& arguments) {
  const FitResult result = read_result(arguments.result);
  TableFormatOptions options;
  options.functions.positions = arguments.positions;
  options.functions.zero_plus = arguments.zero == "plus";
  options.grid_per_axis = arguments.grid;
  const auto files = find_table_format(arguments.format)->write(result, options);
  AtomicFolder folder(arguments.output);
  std::vector<std::string> names;
  for (const TableFile& file : files) {
    folder.write(file.name, file.content);
    names.push_back(file.name);
  }
  folder.commit();
  if (arguments.json) {
    const nlohmann::ordered_json json = {
        {"folder", arguments.output}, {"format", arguments.format}, {"files", names}};
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{}: {}\n", arguments.output, fmt::join(names, ", "));
    for (const std::string& invisible : result.rank.invisible) fmt::print("! {}\n", invisible);
  }
  return result.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

std::function<int()> define(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  app.add_option("RESULT", arguments->result, "result folder of volcal fit")->required();
  app.add_option("-o,--output", arguments->output, "folder for the tables")->required();
  app.add_option("-f,--format", arguments->format, format_help())->check(CLI::IsMember(table_format_names()));
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
