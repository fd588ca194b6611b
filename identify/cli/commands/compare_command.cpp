#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/cli/progress.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/criticism/heldout_comparison.h"
#include "volcal/identify/criticism/screening.h"
#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/io/results/residual_writer.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/comparison_report.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/text_file.h"

namespace volcal::cli {
namespace {

const std::string kNominal = "nominal";

struct CompareArguments {
  std::string campaign;
  std::vector<std::string> models;
  std::string output;
  std::size_t worst = 10;
  int threads = 0;
  bool all = false;
  bool heldout = false;
  bool json = false;
};

struct NamedModel {
  std::string name;
  ModelSpec spec;
  ModelSpec refittable;  ///< what --held-out fits
  bool can_be_fitted = true;
  std::optional<FitResult> result = {};  ///< that it was read from
  std::vector<Finding> of_tables = {};   ///< findings_of_tables()
  std::optional<Campaign> aligned = {};  ///< the readings in the coordinate system of an aligned result

  const Campaign& readings(const Campaign& campaign) const { return aligned ? *aligned : campaign; }
};

/// Error tables as a model.
NamedModel load_tables(const std::string& argument, const Campaign& campaign) {
  const FitResult tables = read_known_errors(argument);
  NamedModel model{argument, tables.identified, tables.identified, false};
  model.of_tables = findings_of_tables(tables, tools_of_setups(campaign));
  model.aligned = readings_for(campaign, tables, {argument, 0});
  return model;
}

NamedModel load_result(const std::string& argument, const Campaign& campaign) {
  const FitResult result = read_result(argument);
  return {argument,
          model_of_result(result),
          refittable_model(result),
          true,
          result,
          findings_of_tables(result, tools_of_setups(campaign)),
          readings_for(campaign, result, {argument, 0})};
}

/// With values or without, which a fit of held-out lines finds.
NamedModel load_model(const std::string& argument, const Campaign& campaign) {
  const ModelFile file = read_model_with_machine(argument, {}, &campaign.machine);
  NamedModel model{argument, file.spec, file.spec, true};
  model.aligned = readings_for(campaign, stated_result(file.machine, file.spec), {argument, 0});
  model.name = compared_name(argument, model.spec);
  return model;
}

/// A result, a model file, a folder of error tables, or the word "nominal".
NamedModel load(const std::string& argument, const Campaign& campaign) {
  if (argument == kNominal) return {"nominal machine", nominal_model(), nominal_model(), false};
  if (!std::filesystem::exists(argument)) {
    throw InputError({argument, 0}, "there is no such result or model",
                     missing_remedy(argument,
                                    "give a result folder of volcal fit, a model.toml, a folder of tables "
                                    "--format csv, or the word nominal"));
  }
  if (is_tables_folder(argument)) return load_tables(argument, campaign);
  if (is_result(argument) || std::filesystem::is_directory(argument)) return load_result(argument, campaign);
  return load_model(argument, campaign);
}

/// residuals.csv, or residuals_A.csv and residuals_B.csv; comparison.json, comparison.txt, report.html.
void write_comparison(const std::string& target, const Campaign& campaign,
                      const std::vector<ComparedModel>& models, const std::vector<HeldOutModel>& heldout,
                      const std::string& text, const std::string& json) {
  AtomicFolder folder(target);
  const bool one = models.size() == 1;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const std::string name = one ? "residuals.csv" : fmt::format("residuals_{}.csv", "AB"[i]);
    write_residuals_csv(folder.path(name), models[i].records, campaign);
  }
  folder.write("comparison.txt", text);
  folder.write("comparison.json", json);
  if (report_available())
    folder.write("report.html", report_html(ComparisonView{models, heldout}, campaign, report_options()));
  folder.commit();
}

std::vector<HeldOutModel> judge_heldout(const Campaign& campaign, const std::vector<NamedModel>& models,
                                        const CompareArguments& arguments,
                                        const ComparisonOptions& comparison) {
  const auto rows = judging_rows(campaign);
  if (std::ranges::none_of(rows, [](const auto& setup) { return std::ranges::count(setup, true) > 0; })) {
    throw InputError({campaign.file, 0}, "--held-out: the setups have too few readings to hold lines out",
                     "at least fifty readings, or five lines, of a setup are needed");
  }
  ProgressBar bar("held-out lines");
  std::vector<HeldOutModel> judged;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const auto count = static_cast<double>(models.size());
    HeldOutOptions options{arguments.threads, models[m].can_be_fitted,
                           [&](const std::string& stage, double done) {
                             bar.update(stage, (static_cast<double>(m) + done) / count);
                           }};
    const auto records = heldout_residuals(models[m].readings(campaign), models[m].refittable, rows, options);
    judged.push_back({arguments.models[m], models[m].can_be_fitted, compare(campaign, records, comparison)});
  }
  bar.finish();
  return judged;
}

void note_models(const std::vector<NamedModel>& models, Campaign& campaign) {
  std::vector<ModelSpec> specs;
  std::vector<Finding> of_tables;
  for (const NamedModel& model : models) {
    specs.push_back(model.spec);
    of_tables.insert(of_tables.end(), model.of_tables.begin(), model.of_tables.end());
  }
  note_compared(specs, of_tables, campaign);
}

int run_compare(const CompareArguments& arguments) {
  if (!arguments.output.empty()) {
    std::vector<std::string> inputs = {arguments.campaign};
    std::ranges::remove_copy(arguments.models, std::back_inserter(inputs), kNominal);
    require_output_folder(arguments.output, inputs);
  }
  Campaign campaign = read_campaign(arguments.campaign);
  ComparisonOptions comparison;
  comparison.worst = arguments.worst;
  std::vector<NamedModel> named;
  std::vector<ComparedModel> models;
  for (const std::string& argument : arguments.models) {
    const NamedModel& model = named.emplace_back(load(argument, campaign));
    const Campaign& readings = model.readings(campaign);
    Evaluation evaluation = evaluate_model(readings, model.spec, nullptr, arguments.threads);
    std::optional<Screening> screening;
    if (model.result)
      screening =
          screen_evaluated(readings, as_fitted(evaluation, *model.result), *model.result, arguments.threads);
    models.push_back(compared_model(model.name, readings, std::move(evaluation.residuals), comparison));
    models.back().screening = screening;
    if (arguments.output.empty() || !report_available()) continue;
    models.back().circle_causes =
        circle_causes(readings, model.spec, evaluation.parameters, model.result ? &*model.result : nullptr,
                      models.back().figures.circles);
    if (model.result) models.back().rotary = rotary_pictures(*model.result, readings);
  }
  note_models(named, campaign);
  std::vector<HeldOutModel> heldout;
  if (arguments.heldout) heldout = judge_heldout(campaign, named, arguments, comparison);
  const std::string json = comparison_json(campaign, models, heldout);
  std::string text = comparison_text(campaign, models, {arguments.all, arguments.worst});
  if (!heldout.empty()) {
    text += '\n' + heldout_text(campaign, heldout, campaign.reading_count());
  } else if (models.size() > 1 &&
             std::ranges::any_of(named, [](const NamedModel& model) { return states_errors(model.spec); })) {
    text += '\n' + heldout_hint();
  }
  if (states_errors(named.back().spec) && fails(models.back()))
    text += fmt::format("\nnext: volcal diagnose {} --auto -o diagnosis\n", arguments.campaign);
  if (!arguments.output.empty()) write_comparison(arguments.output, campaign, models, heldout, text, json);
  if (arguments.json) {
    fmt::print("{}", json);
    return kDone;
  }
  fmt::print("{}", text);
  if (!arguments.output.empty()) {
    fmt::print("\nwritten: {}\n", arguments.output);
    if (!report_available()) fmt::print("no report.html: {}\n", how_to_get_report());
  }
  return kDone;
}

std::function<int()> define_compare(CLI::App& app) {
  auto arguments = std::make_shared<CompareArguments>();
  app.add_option("CAMPAIGN", arguments->campaign, "campaign.toml")->required();
  app.add_option(
         "MODEL", arguments->models,
         "one or two of: a result folder, a model.toml, a folder of tables --format csv, the word nominal "
         "(machine without errors); a model without coefficients is the nominal machine")
      ->required()
      ->expected(1, 2);
  app.add_option("-o,--output", arguments->output,
                 "folder for report.html, residuals.csv (of two models residuals_A.csv and residuals_B.csv), "
                 "comparison.txt and comparison.json");
  app.add_option("--worst", arguments->worst, "readings listed")
      ->check(not_negative())
      ->capture_default_str();
  app.add_option("--threads", arguments->threads, "0 = all; results do not depend on it")
      ->check(number_of_threads());
  app.add_flag("--held-out", arguments->heldout,
               "fit the models anew without every fifth line and judge them on those lines");
  app.add_flag("--all", arguments->all, "every setup, place, line and run, not only the worst");
  app.add_flag("--json", arguments->json, "print one JSON document on standard output and nothing else");
  return [arguments] { return run_compare(*arguments); };
}

}  // namespace

const Command& compare_command() {
  static const Command command = {
      "compare", "show where a model fails to explain a campaign, with the figures of ISO 230",
      "  volcal compare campaign.toml nominal\n"
      "  volcal compare campaign.toml result -o comparison\n"
      "  volcal compare campaign.toml nominal result\n"
      "  volcal compare campaign.toml result result-1 --held-out\n"
      "  volcal compare campaign.toml result --json | jq -r '.models[0].where_it_fails'\n",
      define_compare};
  return command;
}

}  // namespace volcal::cli
