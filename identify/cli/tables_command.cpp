#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/identify/cli/axis_position.h"
#include "volcal/identify/cli/command.h"
#include "volcal/identify/io/atomic_folder.h"
#include "volcal/identify/io/result_folder.h"
#include "volcal/identify/report/volumetric_text.h"
#include "volcal/identify/tables/table_format.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {
namespace {

struct TablesArguments {
  std::string result;
  std::string output;
  std::string format = "csv";
  std::string zero = "mean";
  int positions = 0;
  int grid = 5;
  std::vector<std::string> at;
  std::string tool;
  bool json = false;
};

std::string format_help() {
  std::string text = "table format:";
  for (const TableFormat* format : table_formats())
    text += fmt::format(" {} = {};", format->name, format->summary);
  text.back() = '.';
  return text;
}

/// All of them when none is named.
std::vector<Tool> chosen_tools(const Machine& machine, const std::string& name) {
  if (name.empty()) return machine.tools;
  std::string names;
  for (const Tool& tool : machine.tools) {
    if (tool.name == name) return {tool};
    names += (names.empty() ? "" : ", ") + tool.name;
  }
  throw InputError({}, "--tool " + name + ": the machine has no such tool", "its tools are " + names);
}

std::vector<VolumetricError> errors_at_points(const FitResult& result, const TablesArguments& arguments) {
  std::vector<VolumetricError> errors;
  const std::vector<Tool> tools = chosen_tools(result.machine, arguments.tool);
  for (const std::string& point : arguments.at) {
    const AxisPosition position = axis_position("--at", point, result.machine);
    for (const Tool& tool : tools) errors.push_back(volumetric_error(result, position, tool));
  }
  return errors;
}

void require_something_to_do(const TablesArguments& arguments) {
  if (arguments.at.empty() && !arguments.tool.empty())
    throw InputError({}, "--tool is given without --at", "the tables hold every tool; leave --tool out");
  if (arguments.at.empty() && arguments.output.empty())
    throw InputError({}, "neither a folder nor a point is given", "give -o FOLDER, or --at X=100,Y=50");
}

std::vector<std::string> write_tables(const FitResult& result, const TablesArguments& arguments) {
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
  return names;
}

int run_tables(const TablesArguments& arguments) {
  require_something_to_do(arguments);
  const FitResult result = read_result(arguments.result);
  const std::vector<VolumetricError> errors = errors_at_points(result, arguments);
  std::vector<std::string> names;
  if (!arguments.output.empty()) names = write_tables(result, arguments);
  if (arguments.json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    if (!names.empty()) json = {{"folder", arguments.output}, {"format", arguments.format}, {"files", names}};
    if (!errors.empty()) json["volumetric_errors"] = volumetric_json(result, errors);
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{}", volumetric_text(result, errors));
    if (!names.empty()) fmt::print("{}: {}\n", arguments.output, fmt::join(names, ", "));
    for (const std::string& invisible : result.rank.invisible) fmt::print("! {}\n", invisible);
  }
  return result.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

std::function<int()> define_tables(CLI::App& app) {
  auto arguments = std::make_shared<TablesArguments>();
  app.add_option("RESULT", arguments->result, "result folder of volcal fit")->required();
  app.add_option("-o,--output", arguments->output, "folder for the tables");
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
  app.add_option(
      "--at", arguments->at,
      "print the volumetric error at a point, X=100,Y=50 in mm and deg, axes not named at home; may "
      "be given several times");
  app.add_option("--tool", arguments->tool, "tool at that point; default: every tool");
  app.add_flag("--json", arguments->json, "print one JSON document and nothing else");
  return [arguments] { return run_tables(*arguments); };
}

}  // namespace

const Command& tables_command() {
  static const Command command = {
      "tables", "write the error tables of an identified machine, or print its error at points",
      "  volcal tables result -o tables\n"
      "  volcal tables result --positions 101 --grid 9 -o tables\n"
      "  volcal tables result --zero plus -o tables\n"
      "  volcal tables result --at X=100,Y=250,Z=-80 --tool long\n",
      define_tables};
  return command;
}

}  // namespace volcal::cli
