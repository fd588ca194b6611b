#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <string>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/effect_list.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/options/parameter_option.h"
#include "volcal/identify/cli/options/picture.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/criticism/asked_laws.h"
#include "volcal/identify/criticism/catalogue/named_effect.h"
#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/formulas/formula_search.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/results/diagnosis_folder.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/criticism/diagnosis_text.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/session/diagnosed_campaign.h"
#include "volcal/identify/text/atomic_folder.h"

namespace volcal::cli {
namespace {

struct DiagnoseArguments {
  std::string campaign;
  std::string model;
  std::string output;
  std::string shown;
  std::string picture;
  int threads = 0;
  bool climb = false;
  bool list = false;
  bool json = false;
  bool verbose = false;
  std::vector<std::string> separate;
  std::vector<std::string> tried;
  std::vector<std::string> laws;
  std::vector<std::string> parameters;
  std::size_t readings = PlanningOptions{}.readings;
};

ModelSpec given_model(const DiagnoseArguments& arguments, const Campaign& campaign) {
  return arguments.model.empty() ? ModelSpec{} : read_model(arguments.model, campaign.machine);
}

/// Of a campaign also by name.
int print_list(const DiagnoseArguments& arguments) {
  std::vector<std::string> testable;
  std::vector<Finding> notes;
  if (!arguments.campaign.empty()) {
    const Campaign campaign = read_campaign(arguments.campaign);
    testable = testable_effects(campaign, given_model(arguments, campaign));
    notes = campaign.notes;
  }
  fmt::print("{}", arguments.json ? effect_list_json(testable, notes)
                                  : effect_list_text(testable) + findings_text(notes));
  return kDone;
}

/// The ladder of an earlier diagnosis again.
int show(const DiagnoseArguments& arguments) {
  if (!arguments.campaign.empty()) {
    throw InputError({}, "both a campaign to diagnose and --show are given",
                     "volcal diagnose --show DIR prints an earlier diagnosis; leave one of the two out");
  }
  const Diagnosis diagnosis = read_diagnosis(arguments.shown);
  fmt::print("{}", arguments.json ? diagnosis_json(diagnosis) : diagnosis_text(diagnosis));
  return kDone;
}

void write_diagnosis(const DiagnoseArguments& arguments, const Campaign& campaign, const ModelSpec& model,
                     const DiagnosedModel& diagnosed) {
  const Diagnosis& diagnosis = diagnosed.diagnosis;
  std::map<std::string, std::string> more = {{"diagnosis.txt", diagnosis_text(diagnosis)}};
  if (report_available()) {
    const VolumeCauses causes = volume_causes(diagnosed.fit, accepted_effects(diagnosis));
    more["report.html"] = report_html(diagnosis, campaign, report_options(), &causes);
  }
  write_diagnosis_folder(diagnosis, campaign.machine, offered_models(model, campaign, diagnosis),
                         arguments.output, more);
}

/// Where an effect was found, how it enters the model, and how that is fitted.
std::string what_next(const DiagnoseArguments& arguments, const Diagnosis& diagnosis) {
  if (accepted_effects(diagnosis).empty()) return "";
  const std::string extended = (std::filesystem::path(arguments.output) / "extended.toml").string();
  if (arguments.model.empty()) {
    const std::string removed = removed_in_fit_text(diagnosis, arguments.campaign, extended);
    return removed.empty()
               ? fmt::format("next: volcal fit {} --model {} -o RESULT\n", arguments.campaign, extended)
               : removed;
  }
  return fmt::format("next: volcal extend {} --diagnosis {} --accepted -o NEW.toml\n", arguments.model,
                     arguments.output) +
         removed_in_fit_text(diagnosis, arguments.campaign, "NEW.toml");
}

int run_diagnose(const DiagnoseArguments& arguments) {
  if (arguments.list) return print_list(arguments);
  if (!arguments.shown.empty()) return show(arguments);
  if (arguments.campaign.empty()) {
    throw InputError({}, "no campaign is given",
                     "volcal diagnose CAMPAIGN.toml -o DIR, --show DIR, or --list");
  }
  if (!arguments.output.empty()) {
    require_output_folder(arguments.output, {arguments.campaign, arguments.model});
  }
  if (!arguments.picture.empty()) require_picture("--picture", arguments.picture);
  const Campaign campaign = read_campaign(arguments.campaign);
  const ModelSpec model = given_model(arguments, campaign);
  DiagnoseOptions options;
  options.threads = arguments.threads;
  options.climb = arguments.climb;
  options.planning.readings = arguments.readings;
  options.planning.separate = named_effects("--separate", arguments.separate, campaign);
  for (const WrittenEffect& tried : written_effects("--try", arguments.tried, arguments.parameters))
    options.own.push_back(tried.spec);
  ModelSpec criticised = model;
  for (const std::string& text : arguments.laws)
    std::ranges::move(asked_laws(text, criticised), std::back_inserter(options.asked_laws));
  ProgressBar bar("diagnose");
  options.progress = [&bar](const std::string& stage, double done) { bar.update(stage, done); };
  DiagnosedModel diagnosed = diagnosed_campaign(campaign, criticised, options);
  if (const auto taken = surfaces_taken_out(model, criticised))
    diagnosed.diagnosis.findings.push_back(*taken);
  const Diagnosis& diagnosis = diagnosed.diagnosis;
  bar.finish();
  if (!arguments.output.empty()) write_diagnosis(arguments, campaign, criticised, diagnosed);
  if (!arguments.picture.empty())
    write_picture("--picture", diagnosis_picture(diagnosis, campaign, report_options()), arguments.picture);
  if (arguments.json) {
    fmt::print("{}", diagnosis_json(diagnosis));
  } else {
    const bool kept = !arguments.output.empty();
    fmt::print("{}",
               kept && !arguments.verbose ? diagnosis_summary_text(diagnosis) : diagnosis_text(diagnosis));
    if (kept) fmt::print("written: {} (all of it: diagnosis.txt)\n", arguments.output);
    if (kept) fmt::print("{}", what_next(arguments, diagnosis));
    if (!arguments.picture.empty()) fmt::print("drawn: {}\n", arguments.picture);
    if (kept && !report_available()) fmt::print("no report.html: {}\n", how_to_get_report());
  }
  return kDone;
}

std::function<int()> define_diagnose(CLI::App& app) {
  auto arguments = std::make_shared<DiagnoseArguments>();
  app.add_option("CAMPAIGN", arguments->campaign, "campaign.toml");
  app.add_option("-m,--model", arguments->model, "model.toml to criticise; default: all 21 errors");
  app.add_option("-o,--output", arguments->output,
                 "folder for diagnosis.json, report.html, diagnosis.txt and extended.toml");
  app.add_option("--threads", arguments->threads, "0 = all; results do not depend on it")
      ->check(number_of_threads());
  app.add_flag("--auto", arguments->climb,
               "add everything that is found, one effect after another, not the first alone");
  app.add_option(
      "--try", arguments->tried,
      "\"TARGET: expression\" or \"TARGET += expression\": an effect of your own, judged like those "
      "of the catalogue; may be given several times");
  add_parameter_option(app, arguments->parameters);
  app.add_option(
      "--formula", arguments->laws,
      "\"TARGET: DRIVERS\": which law of one to three recorded variables the target follows, beside "
      "what is found or in the place of a surface of these variables; \"model\": laws behind the surfaces "
      "of the model, which is criticised without them; may be given several times");
  app.add_option("--separate", arguments->separate,
                 "KIND:TARGET,KIND:TARGET: which measurement would separate these effects, or show them")
      ->delimiter(',');
  app.add_option("--readings", arguments->readings, "readings that a further measurement may take")
      ->check(CLI::Range(8, 10000))
      ->capture_default_str();
  app.add_option(
      "--picture", arguments->picture,
      "PNG file for the surface or curve of what was found first, or for the added-variable plot of "
      "the leading effect; drawn by Chromium, which must be installed");
  app.add_option("--show", arguments->shown,
                 "print the diagnosis kept in a folder (or diagnosis.json) again");
  app.add_flag(
      "--list", arguments->list,
      "print every kind, target, driver and shape of effects, and what could act in CAMPAIGN, and stop");
  app.add_flag(
      "-v,--verbose", arguments->verbose,
      "print all of diagnosis.txt: ranked evidence, nearly collinear effects, detection limits, noise");
  app.add_flag("--json", arguments->json, "print diagnosis.json on standard output and nothing else");
  return [arguments] { return run_diagnose(*arguments); };
}

}  // namespace

const Command& diagnose_command() {
  static const Command command = {"diagnose",
                                  "show where the model fails, and name the effect that is missing",
                                  "  volcal diagnose campaign.toml -o diagnosis\n"
                                  "  volcal diagnose campaign.toml --model model.toml --auto --try \"EXX += "
                                  "dir_x * (T_air - 20)\" -o diagnosis\n"
                                  "  volcal diagnose campaign.toml --separate station-drift:\"station "
                                  "P1\",dead-path:\"readings of P1_short\"\n"
                                  "  volcal diagnose campaign.toml --auto --formula \"EZX: x y\"\n"
                                  "  volcal diagnose --show diagnosis\n"
                                  "  volcal diagnose --list\n"
                                  "  volcal diagnose campaign.toml --list\n",
                                  define_diagnose};
  return command;
}

}  // namespace volcal::cli
