#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/conditions_options.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/design_stage.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/errors/volume/volume_points.h"
#include "volcal/identify/io/campaign/tolerance_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/report/text/error_budget_text.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"

namespace volcal::cli {
namespace {

struct BudgetArguments {
  std::string errors;
  std::string tolerances;
  std::string tool;
  ConditionsArguments conditions;
  int grid = kVolumeCells;
  bool verbose = false;
  bool json = false;
};

const Tool& chosen_tool(const Machine& machine, const BudgetArguments& arguments) {
  TableFormatOptions options;
  options.tool = arguments.tool;
  return tool_of(machine, options);
}

int run_design(const BudgetArguments& arguments) {
  const auto [machine, tolerances] = read_design(arguments.errors, arguments.tolerances);
  const FitResult result = result_of_tolerances(machine, tolerances);
  const Tool& tool = chosen_tool(machine, arguments);
  const Conditions conditions = conditions_of(result, arguments.conditions);
  const ErrorBudget budget = error_budget(result, tool, conditions, arguments.grid);
  if (arguments.json) {
    nlohmann::ordered_json json = design_budget_json(budget, machine, tolerances);
    json["tool"] = tool.name;
    json["conditions"] = conditions_json(result, conditions);
    fmt::print("{}\n", json_text(json, 2));
  } else {
    fmt::print("{}{}", conditions_text(result, conditions),
               design_budget_text(budget, machine, tolerances, tool.name, arguments.verbose));
  }
  return kDone;
}

int run_budget(const BudgetArguments& arguments) {
  if (is_design(arguments.errors, arguments.tolerances)) return run_design(arguments);
  const FitResult result = read_known_errors(arguments.errors);
  const Tool& tool = chosen_tool(result.machine, arguments);
  const Conditions conditions = conditions_of(result, arguments.conditions);
  if (arguments.conditions.no_extrapolation) require_within_readings(result, conditions);
  const ErrorBudget budget = error_budget(result, tool, conditions, arguments.grid);
  if (arguments.json) {
    nlohmann::ordered_json json = error_budget_json(budget);
    json["tool"] = tool.name;
    json["conditions"] = conditions_json(result, conditions);
    add_findings("effects_in_no_figure", effects_in_no_figure(result), json);
    add_findings("of_tables", findings_of_tables(result, {tool.name}), json);
    add_findings("invisible", result.rank.invisible, json);
    add_findings("contradicted", contradictions(result), json);
    fmt::print("{}\n", json_text(json, 2));
  } else {
    fmt::print("{}{}", conditions_text(result, conditions),
               error_budget_text(budget, tool.name, result.coverage_factor, arguments.verbose));
    fmt::print("{}{}", findings_text(unmeasured_travel(result)), findings_text(effects_in_no_figure(result)));
    fmt::print("{}", findings_text(findings_of_tables(result, {tool.name})));
    fmt::print("{}{}", findings_text(result.rank.invisible), findings_text(contradictions(result)));
  }
  return result.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

std::function<int()> define_budget(CLI::App& app) {
  auto arguments = std::make_shared<BudgetArguments>();
  app.add_option(
         "ERRORS", arguments->errors,
         "result folder of volcal fit, model.toml with values, or folder of tables --format csv; of a "
         "machine that is not built yet, machine.toml or a file of tolerances")
      ->required();
  app.add_option(
      "--tolerances", arguments->tolerances,
      "file of tolerances for the machine of ERRORS (volcal-tolerances-1): widths of the bands of its "
      "errors, as straightness_um = 8");
  app.add_option("--tool", arguments->tool, "tool whose functional point is meant; default: the first");
  app.add_option("--grid", arguments->grid,
                 "as many places as a grid of so many positions per linear axis has, 100 at least; they are "
                 "spread evenly, without a period")
      ->check(CLI::Range(2, 41))
      ->capture_default_str();
  add_conditions_options(app, arguments->conditions);
  app.add_flag("--verbose", arguments->verbose, "list every contribution");
  app.add_flag("--json", arguments->json, "print one JSON document and nothing else");
  return [arguments] { return run_budget(*arguments); };
}

}  // namespace

const Command& budget_command() {
  static const Command command = {
      "budget", "which error contributes how much to the error in the volume, by cause and by error",
      "  volcal budget result\n"
      "  volcal budget result/identified.toml --tool short --verbose\n"
      "  volcal budget machine.toml --tolerances tolerances.toml\n",
      define_budget};
  return command;
}

}  // namespace volcal::cli
