#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/conditions_options.h"
#include "volcal/identify/cli/options/output_file.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/io/exports/covariance_npz.h"
#include "volcal/identify/io/exports/gtc_archive.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {
namespace {

struct ExportArguments {
  std::string result;
  std::string gtc;
  std::string npz;
  std::string tool;
  ConditionsArguments conditions;
  bool json = false;
};

ErrorTableOptions export_table_options(const FitResult& result, const ExportArguments& arguments) {
  ErrorTableOptions options;
  options.conditions = conditions_of(result, arguments.conditions);
  TableFormatOptions named;
  named.tool = arguments.tool;
  options.tool = tool_of(result.machine, named).name;
  return options;
}

/// Throws InputError for a model or a table, which are read as errors elsewhere.
void require_result(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored) || is_result(path)) return;
  throw InputError({path, 0}, "it is not a result: export takes result folders",
                   "give the folder that volcal fit wrote, or its result.json; errors that are stated in a "
                   "model or in tables have no covariance");
}

int run_export(const ExportArguments& arguments) {
  if (arguments.gtc.empty() && arguments.npz.empty())
    throw InputError({}, "no file is given", "give --gtc FILE, --npz FILE, or both");
  const std::vector<std::string> read = {arguments.result, arguments.result + "/result.json"};
  for (const std::string& output : {arguments.gtc, arguments.npz})
    require_no_input(output, read, "name another file");
  if (arguments.gtc == arguments.npz)
    throw InputError({}, "--gtc and --npz name one file", "give each a file of its own");
  require_result(arguments.result);
  const FitResult result = read_result(arguments.result);
  if (arguments.conditions.no_extrapolation)
    require_within_readings(result, conditions_of(result, arguments.conditions));
  const JointValues parameters = parameters_with_covariance(result);
  const ErrorTableOptions options = export_table_options(result, arguments);
  const JointTable table = table_with_covariance(result, options);
  const std::size_t rows = table.rows.names.size();
  if (!arguments.gtc.empty()) write_text_file(arguments.gtc, gtc_archive(parameters, table));
  if (!arguments.npz.empty()) write_text_file(arguments.npz, covariance_npz(parameters, table));
  if (arguments.json) {
    nlohmann::ordered_json json = {{"parameters", parameters.names.size()}, {"table_rows", rows}};
    if (!arguments.gtc.empty()) json["gtc"] = arguments.gtc;
    if (!arguments.npz.empty()) json["npz"] = arguments.npz;
    add_findings("invisible", result.rank.invisible, json);
    add_findings("contradicted", contradictions(result), json);
    fmt::print("{}\n", json_text(json, 2));
  } else {
    if (!arguments.gtc.empty())
      fmt::print("written: {}, {} values with their correlations and {} rows of tables for GTC\n",
                 arguments.gtc, parameters.names.size(), rows);
    if (!arguments.npz.empty())
      fmt::print("written: {}, {} parameters and {} rows of tables, each with their covariance\n",
                 arguments.npz, parameters.names.size(), rows);
    fmt::print("{}{}", findings_text(result.rank.invisible), findings_text(contradictions(result)));
  }
  return result.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

std::function<int()> define_export(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  app.add_option("RESULT", arguments->result, "result folder of volcal fit, or its result.json")->required();
  app.add_option("--gtc", arguments->gtc,
                 "archive of the GUM Tree Calculator (JSON 1.5.0): every parameter as an uncertain number, "
                 "with the correlations, and every row of the error tables as a function of them");
  app.add_option("--npz", arguments->npz,
                 "archive of NumPy: names, units, values and covariance of the parameters, the same of the "
                 "error tables");
  app.add_option("--tool", arguments->tool,
                 "tool that tables share effects out for which couple axes; default: the first");
  add_conditions_options(app, arguments->conditions);
  app.add_flag("--json", arguments->json, "print one JSON document and nothing else");
  return [arguments] { return run_export(*arguments); };
}

}  // namespace

const Command& export_command() {
  static const Command command = {"export", "the full covariance of a result for other programs: GTC, NumPy",
                                  "  volcal export result --npz result.npz\n"
                                  "  volcal export result --gtc result-gtc.json --npz result.npz\n",
                                  define_export};
  return command;
}

}  // namespace volcal::cli
