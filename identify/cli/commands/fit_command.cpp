#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/criticism/screening.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/io/results/result_json.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/fit_summary.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/fit_words.h"
#include "volcal/identify/text/atomic_folder.h"

namespace volcal::cli {
namespace {

struct FitArguments {
  std::string campaign;
  std::string model;
  std::string output;
  std::string loss = "none";
  std::string outliers = "list";
  std::string solver = "compressed";
  std::string noise = "auto";
  int threads = 0;
  bool keep_stated_sigma = false;
  bool first_order = false;
  bool json = false;
  bool verbose = false;
};

FitOptions fit_options(const FitArguments& arguments) {
  FitOptions options;
  options.threads = arguments.threads;
  options.loss = robust_loss(arguments.loss);
  options.outliers = outlier_policy(arguments.outliers);
  options.solver = solver_kind(arguments.solver);
  options.noise = noise_policy(arguments.noise);
  options.variance_components = !arguments.keep_stated_sigma;
  options.exact_kinematics = !arguments.first_order;
  return options;
}

std::string diagnosis_of(const FitArguments& arguments) {
  return "volcal diagnose " + arguments.campaign +
         (arguments.model.empty() ? "" : " --model " + arguments.model) + " --auto -o diagnosis";
}

int run_fit(const FitArguments& arguments) {
  require_output_folder(arguments.output, {arguments.campaign, arguments.model});
  const Campaign campaign = read_campaign(arguments.campaign);
  const ModelSpec model =
      arguments.model.empty() ? ModelSpec{} : read_model(arguments.model, campaign.machine);
  FitOptions options = fit_options(arguments);
  ProgressBar bar("fit");
  options.progress = [&bar](const std::string& stage, double done) { bar.update(stage, done); };
  FitResult result = screened_fit(campaign, model, options);
  result.provenance = provenance();
  bar.finish();
  std::map<std::string, std::string> more;
  if (report_available()) more["report.html"] = report_html(result, campaign, report_options());
  write_result_folder(result, campaign, arguments.output, more);
  if (arguments.json) {
    fmt::print("{}\n", result_summary_json(result));
  } else {
    fmt::print("{}", arguments.verbose ? fit_text(result, campaign) : fit_summary_text(result));
    fmt::print("written: {} ({})\n", arguments.output,
               report_available() ? "report.html has all of it" : "--verbose prints all of it");
    if (result.status == FitStatus::LackOfFit) fmt::print("next: {}\n", diagnosis_of(arguments));
    if (!report_available()) fmt::print("no report.html: {}\n", how_to_get_report());
  }
  return result.status == FitStatus::RankDeficient || result.status == FitStatus::NotConverged ? kIncomplete
                                                                                               : kDone;
}

std::function<int()> define_fit(CLI::App& app) {
  auto arguments = std::make_shared<FitArguments>();
  app.add_option("CAMPAIGN", arguments->campaign, "campaign.toml")->required();
  app.add_option("-m,--model", arguments->model,
                 "model.toml: bases of the error functions, errors left out, effects, widths of priors "
                 "([priors] squareness_mrad, displacement_um, rotation_urad); default: all 21 errors, cubic "
                 "B-splines, automatic knots");
  app.add_option("-o,--output", arguments->output, "result folder (replaced as a whole)")->required();
  app.add_option("--outliers", arguments->outliers, "readings flagged by the w-test: list or remove them")
      ->check(one_of(kOutlierWords));
  app.add_option("--robust", arguments->loss, "robust loss")->check(one_of(kLossWords));
  app.add_option("--solver", arguments->solver,
                 "compressed normal equations, or one residual block per reading")
      ->check(one_of(kSolverWords));
  app.add_option(
         "--noise", arguments->noise,
         "auto: estimate correlated drift, offsets of lines and noise in proportion to length, and weight by "
         "what is supported; white: independent readings")
      ->check(one_of(kNoiseWords));
  app.add_option("--threads", arguments->threads, "0 = all; results do not depend on it")
      ->check(number_of_threads());
  app.add_flag("--keep-stated-sigma", arguments->keep_stated_sigma,
               "do not estimate variance components nor correlated noise");
  app.add_flag("--first-order", arguments->first_order, "first-order kinematics only");
  app.add_flag("-v,--verbose", arguments->verbose,
               "print every error, setup, noise term, flagged reading and message");
  app.add_flag("--json", arguments->json, "print result.json on standard output and nothing else");
  return [arguments] { return run_fit(*arguments); };
}

}  // namespace

const Command& fit_command() {
  static const Command command = {
      "fit", "identify the errors of a machine from a campaign",
      "  volcal fit campaign.toml -o result\n"
      "  volcal fit campaign.toml --model model.toml --outliers remove -o result\n"
      "  volcal fit campaign.toml -o result --json | jq .sigma0\n",
      define_fit};
  return command;
}

}  // namespace volcal::cli
