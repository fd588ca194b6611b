#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/options/superimposed_tables.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/io/results/residual_writer.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/validation_text.h"
#include "volcal/identify/report/values/measured_error.h"
#include "volcal/identify/result/fitted_readings.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

struct ValidateArguments {
  std::string result;
  std::string campaign;
  std::string tables;
  std::string output;
  double max_rms_um = 0.0;
  int threads = 0;
  bool json = false;
};

/// Before and after, as `compare` sees two models.
std::vector<ComparedModel> compared(const Campaign& campaign, const FitResult& result,
                                    const Validation& validation) {
  std::vector<ComparedModel> models;
  models.push_back(compared_model("nominal machine", campaign, validation.before.residuals));
  models.push_back(compared_model("identified", campaign, validation.after.residuals));
  models.back().circle_causes =
      circle_causes(campaign, model_of_result(result), validation.after.parameters,
                    result.covariance.isZero(0.0) ? nullptr : &result, models.back().figures.circles);
  models.back().rotary = rotary_pictures(result, campaign);
  return models;
}

void write_validation(const ValidateArguments& arguments, const Campaign& campaign, const FitResult& result,
                      const Validation& validation, const FittedReadings& fitted, const std::string& text,
                      const std::string& json) {
  AtomicFolder folder(arguments.output);
  write_residuals_csv(folder.path("residuals_before.csv"), validation.before.residuals, campaign);
  write_residuals_csv(folder.path("residuals_after.csv"), validation.after.residuals, campaign);
  folder.write("validation.txt", text);
  folder.write("validation.json", json);
  if (report_available()) {
    const auto models = compared(campaign, result, validation);
    folder.write("report.html",
                 report_html(ValidationView{validation.figures, fitted, models}, campaign, report_options()));
  }
  folder.commit();
}

struct Verified {
  MeasuredError measured;
  bool replaces_tables = false;  ///< that were active while the errors were identified
};

/// With tables that were active: the readings become what they are without; what the machine showed with
/// them.
std::optional<Verified> verify(const ValidateArguments& arguments, const FitResult& result,
                               Campaign& campaign) {
  if (arguments.tables.empty()) {
    std::ranges::move(differing_compensations(campaign, result), std::back_inserter(campaign.notes));
    return {};
  }
  const ActiveTables active = active_tables_for(arguments.tables, result.active_compensations);
  return Verified{take_out_tables(active, result, campaign, arguments.threads), active.former.has_value()};
}

std::string compensated_text(const Verified& verified) {
  std::string text = "Measured with the tables active, off the machine without errors\n";
  const auto add = [&](const ErrorSize& size, const char* what, const char* unit) {
    if (size.count > 0)
      text += fmt::format("  {} {}: RMS {:.3f}, largest {:.3f} {}\n", size.count, what, size.rms * kPerMicro,
                          size.max * kPerMicro, unit);
  };
  add(verified.measured.sizes.lengths, "lengths and vectors", "um");
  add(verified.measured.sizes.angles, "angles", "urad");
  return text + fmt::format(
                    "Below: the same readings less what the tables corrected{}, so that the model predicts "
                    "them\n\n",
                    verified.replaces_tables ? " beyond those that they are superimposed on" : "");
}

int run_validate(const ValidateArguments& arguments) {
  if (!arguments.output.empty())
    require_output_folder(arguments.output, {arguments.result, arguments.campaign});
  const FitResult result = read_known_errors(arguments.result);
  Campaign campaign = read_campaign(arguments.campaign);
  const FittedReadings fitted = fitted_readings(campaign, result);
  if (auto aligned = readings_for(campaign, result, {arguments.campaign, 0})) campaign = std::move(*aligned);
  const std::optional<Verified> compensated = verify(arguments, result, campaign);
  note_judgement(result, campaign);
  const Validation validation = validate(campaign, result, arguments.threads);
  std::ranges::copy(validation.contradicted, std::back_inserter(campaign.notes));
  auto figures = validation_json(validation.figures, fitted);
  if (compensated) {
    figures["compensated_rms_um"] = compensated->measured.sizes.lengths.rms * kPerMicro;
    figures["compensated_max_um"] = compensated->measured.sizes.lengths.max * kPerMicro;
    if (const ErrorSize& angles = compensated->measured.sizes.angles; angles.count > 0) {
      figures["compensated_angle_rms_urad"] = angles.rms * kPerMicro;
      figures["compensated_angle_max_urad"] = angles.max * kPerMicro;
    }
  }
  add_notes(campaign.notes, figures);
  const std::string json = json_text(figures, 2) + '\n';
  const std::string text = (compensated ? compensated_text(*compensated) : "") +
                           validation_text(validation, fitted) + findings_text(campaign.notes);
  if (!arguments.output.empty())
    write_validation(arguments, campaign, result, validation, fitted, text, json);
  fmt::print("{}", arguments.json ? json : text);
  if (!arguments.json && !arguments.output.empty()) {
    fmt::print("written: {}\n", arguments.output);
    if (!report_available()) fmt::print("no report.html: {}\n", how_to_get_report());
  }
  const bool exceeded =
      arguments.max_rms_um > 0.0 && validation.figures.rms_after * kPerMicro > arguments.max_rms_um;
  if (exceeded) fmt::print(stderr, "RMS after exceeds the limit of {} um\n", arguments.max_rms_um);
  return exceeded ? kIncomplete : kDone;
}

std::function<int()> define_validate(CLI::App& app) {
  auto arguments = std::make_shared<ValidateArguments>();
  app.add_option("ERRORS", arguments->result,
                 "result folder of volcal fit, model.toml with values, or folder of tables --format csv")
      ->required();
  app.add_option("CAMPAIGN", arguments->campaign, "campaign.toml with readings that the fit did not use")
      ->required();
  app.add_option("-o,--output", arguments->output,
                 "folder for report.html, residuals_before.csv, residuals_after.csv, validation.txt and "
                 "validation.json");
  app.add_option(
      "--tables", arguments->tables,
      "folder of tables that were active while CAMPAIGN was measured: judges the compensated machine");
  app.add_option("--max-rms-um", arguments->max_rms_um, "exit 1 when the RMS after exceeds this")
      ->check(positive());
  app.add_option("--threads", arguments->threads, "0 = all")->check(number_of_threads());
  app.add_flag("--json", arguments->json, "print one JSON document and nothing else");
  return [arguments] { return run_validate(*arguments); };
}

}  // namespace

const Command& validate_command() {
  static const Command command = {"validate", "judge an identified model on readings it never saw",
                                  "  volcal validate result other-setups/campaign.toml\n"
                                  "  volcal validate result other-setups/campaign.toml -o validation\n"
                                  "  volcal validate result truth/campaign.toml --json\n"
                                  "  volcal validate result verification/campaign.toml --tables tables\n"
                                  "  volcal validate result acceptance/campaign.toml --max-rms-um 3\n",
                                  define_validate};
  return command;
}

}  // namespace volcal::cli
