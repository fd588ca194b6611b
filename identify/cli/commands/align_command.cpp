#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/alignment_options.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

struct AlignArguments {
  std::string errors;
  std::string output;
  AlignmentArguments alignment;
  bool json = false;
};

struct AngleWithU {
  std::string name;
  double value = 0.0;  ///< rad
  double u = 0.0;
};

std::vector<AngleWithU> squareness_of(const FitResult& result) {
  std::vector<AngleWithU> angles;
  for (const LocationSymbol symbol : result.machine.datum.squareness()) {
    const ParameterBlock* block = result.layout.find_location(symbol);
    if (block == nullptr) continue;
    angles.push_back({symbol.name(), result.parameters[block->offset],
                      std::sqrt(parameter_variance(result, block->offset))});
  }
  return angles;
}

std::vector<AngleWithU> frame_of(const AlignedResult& aligned) {
  std::vector<AngleWithU> angles;
  angles.reserve(3);
  for (int i = 0; i < 3; ++i)
    angles.push_back({std::string("about ") + "xyz"[i], aligned.frame_rotation[i],
                      std::sqrt(std::max(0.0, aligned.frame_covariance(i, i)))});
  return angles;
}

nlohmann::ordered_json angles_json(const std::vector<AngleWithU>& angles) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const AngleWithU& angle : angles)
    json.push_back({{"name", angle.name}, {"urad", angle.value / kMicro}, {"u_urad", angle.u / kMicro}});
  return json;
}

std::string angles_text(const AlignedResult& aligned, const FitResult& before) {
  TextTable table({{"", Align::Left}, {"", Align::Left}, {"value [urad]"}, {"u [urad]"}});
  const auto add = [&](const char* what, const std::vector<AngleWithU>& angles) {
    for (const AngleWithU& angle : angles) {
      table.add_row(
          {what, angle.name, fixed_number(angle.value / kMicro, 3), fixed_number(angle.u / kMicro, 3)});
      what = "";
    }
  };
  add("frame turned", frame_of(aligned));
  add("squareness before", squareness_of(before));
  add("squareness now", squareness_of(aligned.result));
  return table.text();
}

/// What the fit left in its folder and the alignment does not change.
std::map<std::string, std::string> kept_files(const std::string& folder) {
  std::map<std::string, std::string> files;
  const std::filesystem::path residuals = std::filesystem::path(folder) / "residuals.csv";
  std::error_code error;
  if (std::filesystem::is_regular_file(residuals, error))
    files["residuals.csv"] = read_text_file(residuals.string());
  return files;
}

int run_align(const AlignArguments& arguments) {
  require_output_folder(arguments.output, {arguments.errors});
  const FitResult before = read_known_errors(arguments.errors);
  if (!arguments.alignment.any())
    throw InputError({}, "nothing is to be aligned",
                     "give --primary, --secondary, --origin, or --align spindle");
  const AlignedResult aligned = align_result(before, alignment_of(before, arguments.alignment));
  Campaign campaign;
  campaign.machine = aligned.result.machine;
  campaign.file = arguments.errors;
  std::map<std::string, std::string> files = kept_files(arguments.errors);
  if (is_result(arguments.errors) && report_available())
    files["report.html"] = report_html(aligned.result, campaign, report_options());
  write_result_folder(aligned.result, campaign, arguments.output, files);
  if (arguments.json) {
    nlohmann::ordered_json json = {{"folder", arguments.output},
                                   {"alignment", aligned.result.alignment},
                                   {"frame_rotation", angles_json(frame_of(aligned))},
                                   {"squareness_before", angles_json(squareness_of(before))},
                                   {"squareness", angles_json(squareness_of(aligned.result))}};
    add_findings("invisible", before.rank.invisible, json);
    add_findings("of_tables", findings_of_tables(before), json);
    add_findings("contradicted", contradictions(before), json);
    fmt::print("{}\n", json_text(json, 2));
  } else {
    fmt::print("{}\n{}written to {}\n", aligned.result.alignment, angles_text(aligned, before),
               arguments.output);
    fmt::print("{}{}{}", findings_text(findings_of_tables(before)), findings_text(before.rank.invisible),
               findings_text(contradictions(before)));
  }
  return before.status == FitStatus::RankDeficient ? kIncomplete : kDone;
}

std::function<int()> define_align(CLI::App& app) {
  auto arguments = std::make_shared<AlignArguments>();
  app.add_option("ERRORS", arguments->errors,
                 "result folder of volcal fit, model.toml with values, or folder of tables --format csv")
      ->required();
  app.add_option("-o,--output", arguments->output,
                 "result folder to write; its identified.toml is the aligned model")
      ->required();
  add_alignment_options(app, arguments->alignment);
  app.add_flag("--json", arguments->json, "print one JSON document and nothing else");
  return [arguments] { return run_align(*arguments); };
}

}  // namespace

const Command& align_command() {
  static const Command command = {
      "align",
      "turn a result, a model or tables to another primary or secondary axis, origin or spindle direction",
      "  volcal align result --primary Y --secondary X -o result-y\n"
      "  volcal align result --origin X=0,Y=0,Z=-200 -o result-centre\n"
      "  volcal align result --align spindle --spindle-tilt A=12,B=-5 -o result-spindle\n",
      define_align};
  return command;
}

}  // namespace volcal::cli
