#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/errors/alignment.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/result/fitted_readings.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

struct ValidateArguments {
  std::string result;
  std::string campaign;
  double max_rms_um = 0.0;
  int threads = 0;
  bool json = false;
};

nlohmann::ordered_json figures_json(const ValidationFigures& figures, const FittedReadings& fitted) {
  nlohmann::ordered_json json = {{"rms_before_um", figures.rms_before * kPerMicro},
                                 {"rms_after_um", figures.rms_after * kPerMicro},
                                 {"max_before_um", figures.max_before * kPerMicro},
                                 {"max_after_um", figures.max_after * kPerMicro},
                                 {"reduced_chi2", figures.reduced_chi2},
                                 {"coverage95", figures.coverage95},
                                 {"readings", figures.lengths}};
  if (fitted.is_known) {
    json["fitted_readings"] = fitted.readings;
  } else {
    json["fitted_readings"] = nullptr;
  }
  if (figures.angles > 0) {
    json["angle_rms_before_urad"] = figures.angle_rms_before * kPerMicro;
    json["angle_rms_after_urad"] = figures.angle_rms_after * kPerMicro;
    json["angle_max_before_urad"] = figures.angle_max_before * kPerMicro;
    json["angle_max_after_urad"] = figures.angle_max_after * kPerMicro;
    json["angle_readings"] = figures.angles;
  }
  return json;
}

/// Whose readings these are.
std::string provenance(const FittedReadings& fitted) {
  if (!fitted.is_known) return "Readings (which ones the fit was made from, the result does not say)";
  if (fitted.readings == 0) return "Readings that the fit never saw";
  return fitted.are_all() ? "Readings that the fit was made from"
                          : "Readings, some of which the fit was made from";
}

std::string warning(const FittedReadings& fitted) {
  if (fitted.readings == 0) return {};
  const std::string remedy =
      "give a campaign with other setups, or hold lines out: volcal compare --held-out";
  if (fitted.are_all()) {
    return "\n! this is the campaign that the fit was made from: a fit explains its own readings, and these "
           "figures prove nothing; " +
           remedy + "\n";
  }
  return fmt::format("\n! the fit was made from {} of {} readings, those of {}; {}\n",
                     count_number(static_cast<long long>(fitted.readings)),
                     count_number(static_cast<long long>(fitted.all)), fmt::join(fitted.setups, ", "),
                     remedy);
}

std::string validation_text(const Validation& validation, const FittedReadings& fitted) {
  const ValidationFigures& figures = validation.figures;
  TextTable totals({{"", Align::Left},
                    {"readings"},
                    {"RMS before"},
                    {"RMS after"},
                    {"max before"},
                    {"max after"},
                    {"unit", Align::Left}},
                   provenance(fitted) + "; before = nominal machine, after = identified");
  const auto add = [&](const char* name, std::size_t count, double rms0, double rms1, double max0,
                       double max1, const char* unit) {
    if (count == 0) return;
    totals.add_row({name, count_number(static_cast<long long>(count)), fixed_number(rms0 * kPerMicro, 3),
                    fixed_number(rms1 * kPerMicro, 3), fixed_number(max0 * kPerMicro, 3),
                    fixed_number(max1 * kPerMicro, 3), unit});
  };
  add("lengths and vectors", figures.lengths, figures.rms_before, figures.rms_after, figures.max_before,
      figures.max_after, "um");
  add("angles", figures.angles, figures.angle_rms_before, figures.angle_rms_after, figures.angle_max_before,
      figures.angle_max_after, "urad");
  TextTable setups({{"setup", Align::Left},
                    {"instrument", Align::Left},
                    {"tool", Align::Left},
                    {"RMS before"},
                    {"RMS after"},
                    {"unit", Align::Left}},
                   "Per setup (single components)");
  for (std::size_t i = 0; i < validation.after.setups.size(); ++i) {
    const SetupSummary& setup = validation.after.setups[i];
    setups.add_row({setup.name, setup.instrument, setup.tool,
                    fixed_number(validation.before.setups[i].rms_residual * kPerMicro, 3),
                    fixed_number(setup.rms_residual * kPerMicro, 3), setup.reading_unit});
  }
  return totals.text() + "\n" + setups.text() +
         fmt::format(
             "\nreduced chi2 {:.3f} and {:.1f} % of readings inside {} sqrt(u_model^2 + sigma^2) (95 % "
             "expected)\n",
             figures.reduced_chi2, 100.0 * figures.coverage95, kCoverageFactor) +
         warning(fitted);
}

int run_validate(const ValidateArguments& arguments) {
  const FitResult result = read_known_errors(arguments.result);
  Campaign campaign = read_campaign(arguments.campaign);
  const FittedReadings fitted = fitted_readings(campaign, result);
  adopt_alignment(campaign, result);
  const std::string difference = machine_difference(result.machine, campaign.machine);
  if (!difference.empty()) {
    throw InputError({arguments.campaign, 0}, "its machine is not the one that was identified: " + difference,
                     "validate on a campaign of the same machine");
  }
  const Validation validation = validate(campaign, result, arguments.threads);
  if (arguments.json) {
    auto json = figures_json(validation.figures, fitted);
    add_notes(campaign.notes, json);
    fmt::print("{}\n", json_text(json, 2));
  } else {
    fmt::print("{}", validation_text(validation, fitted));
    fmt::print("{}", findings_text(campaign.notes));
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
                                  "  volcal validate result truth/campaign.toml --json\n"
                                  "  volcal validate result acceptance/campaign.toml --max-rms-um 3\n",
                                  define_validate};
  return command;
}

}  // namespace volcal::cli
