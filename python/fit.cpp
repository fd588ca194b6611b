#include "volcal/identify/solve/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/screening.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/report/text/validation_text.h"
#include "volcal/identify/report/values/measured_error.h"
#include "volcal/identify/result/fitted_readings.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit_words.h"
#include "volcal/python/model.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/findings.h"
#include "volcal/python/shared/long_work.h"
#include "volcal/python/shared/option_words.h"
#include "volcal/python/tables.h"

namespace volcal::python {
namespace {

/// The call again, options that are not the default in it.
class CallText {
 public:
  explicit CallText(std::string begin) : text_(std::move(begin)) {}
  void add(const std::string& name, const std::string& word, const std::string& otherwise) {
    if (word != otherwise) text_ += fmt::format(", {}=\"{}\"", name, word);
  }
  void add(const std::string& name, bool flag, bool otherwise) {
    if (flag != otherwise) text_ += fmt::format(", {}={}", name, flag ? "True" : "False");
  }
  std::string text() const { return text_ + ")"; }

 private:
  std::string text_;
};

Result fit_campaign(const std::shared_ptr<Campaign>& campaign, const Model* model,
                    const std::string& outliers, const std::string& robust, const std::string& solver,
                    const std::string& noise, int threads, bool keep_stated_sigma, bool first_order,
                    bool screening, const py::object& progress) {
  require_threads(threads);
  const ModelSpec spec = spec_for(model, campaign->machine);
  FitOptions options;
  options.threads = threads;
  options.outliers = outlier_policy(outliers);
  options.loss = robust_loss(robust);
  options.solver = solver_kind(solver);
  options.noise = noise_policy(noise);
  options.variance_components = !keep_stated_sigma;
  options.exact_kinematics = !first_order;
  options.progress = progress_to(progress);
  CallText call(fmt::format("volcal.fit(volcal.read_campaign(\"{}\")", campaign->file));
  if (model != nullptr)
    call = CallText(fmt::format("volcal.fit(volcal.read_campaign(\"{}\"), model=\"{}\"", campaign->file,
                                model->spec.file));
  call.add("outliers", outliers, "list");
  call.add("robust", robust, "none");
  call.add("solver", solver, "compressed");
  call.add("noise", noise, "auto");
  call.add("keep_stated_sigma", keep_stated_sigma, false);
  call.add("first_order", first_order, false);
  call.add("screening", screening, true);
  return without_lock([&] {
    Result fitted{screening ? screened_fit(*campaign, spec, options) : fit(*campaign, spec, options),
                  campaign};
    fitted.result.provenance = provenance_of(call.text());
    return fitted;
  });
}

/// A campaign in the frame of the errors that it judges, with what is to be said of both among its notes.
struct JudgingCampaign {
  Campaign campaign;
  std::optional<MeasuredError> with_tables;  ///< that were active
};

JudgingCampaign judging_campaign(const Campaign& given, const FitResult& errors, const Tables* tables,
                                 int threads) {
  std::optional<Campaign> aligned = readings_for(given, errors, {given.file, 0});
  JudgingCampaign judging{aligned ? std::move(*aligned) : given, {}};
  if (tables != nullptr) {
    judging.with_tables = take_out_tables(active_tables_of(*tables, errors.active_compensations), errors,
                                          judging.campaign, threads);
  } else {
    std::ranges::move(differing_compensations(judging.campaign, errors),
                      std::back_inserter(judging.campaign.notes));
  }
  note_judgement(errors, judging.campaign);
  return judging;
}

void add_measured(const MeasuredError& measured, py::dict& dict) {
  dict["compensated_rms"] = measured.sizes.lengths.rms;
  dict["compensated_max"] = measured.sizes.lengths.max;
  dict["compensated_angle_rms"] = measured.sizes.angles.rms;
  dict["compensated_angle_max"] = measured.sizes.angles.max;
}

py::dict validation_figures(const Campaign& given, const Result& result, const Tables* tables, int threads) {
  require_threads(threads);
  const FittedReadings fitted = fitted_readings(given, result.result);
  JudgingCampaign judging =
      without_lock([&] { return judging_campaign(given, result.result, tables, threads); });
  Campaign& campaign = judging.campaign;
  const Validation validation = without_lock([&] { return validate(campaign, result.result, threads); });
  std::ranges::copy(validation.contradicted, std::back_inserter(campaign.notes));
  const ValidationFigures& figures = validation.figures;
  py::dict dict;
  dict["rms_before"] = figures.rms_before;
  dict["rms_after"] = figures.rms_after;
  dict["max_before"] = figures.max_before;
  dict["max_after"] = figures.max_after;
  dict["angle_rms_before"] = figures.angle_rms_before;
  dict["angle_rms_after"] = figures.angle_rms_after;
  dict["angle_max_before"] = figures.angle_max_before;
  dict["angle_max_after"] = figures.angle_max_after;
  dict["readings"] = figures.lengths;
  dict["angle_readings"] = figures.angles;
  dict["reduced_chi2"] = figures.reduced_chi2;
  dict["coverage95"] = figures.coverage95;
  if (judging.with_tables) add_measured(*judging.with_tables, dict);
  dict["fitted_readings"] = fitted.is_known ? py::object(py::int_(fitted.readings)) : py::object(py::none());
  dict["warning"] = text_of(with_arguments(seen_readings_warning(fitted)));
  dict["findings"] = findings_of(campaign.notes);
  return dict;
}

}  // namespace

void define_fit(py::module_& module) {
  module.def("fit", &fit_campaign, py::arg("campaign").none(false), py::arg("model") = py::none(),
             py::kw_only(), py::arg("outliers") = "list", py::arg("robust") = "none",
             py::arg("solver") = "compressed", py::arg("noise") = "auto", py::arg("threads") = 0,
             py::arg("keep_stated_sigma") = false, py::arg("first_order") = false,
             py::arg("screening") = true, py::arg("progress") = py::none(),
             "Identifies the errors of a machine from a campaign, as `volcal fit` does: the same numbers to "
             "the last bit.\n\n"
             "model: None = all 21 errors, cubic B-splines, automatic knots.\n"
             "outliers: \"list\" or \"remove\" readings that the w-test flags. robust: loss \"none\", "
             "\"huber\", \"cauchy\". "
             "solver: \"compressed\" or \"per-reading\". noise: \"auto\" or \"white\".\n"
             "threads: 0 = all; results do not depend on it. keep_stated_sigma: no variance components, no "
             "correlated noise. "
             "first_order: first-order kinematics only. screening: end with the scans of the residuals.\n"
             "progress: called with the stage and the share of the work that is done, 0 to 1; what it raises "
             "ends the work, as "
             "does Ctrl-C when the next stage begins. Raises InputError.");
  module.def(
      "validate", &validation_figures, py::arg("campaign").none(false), py::arg("result"), py::kw_only(),
      py::arg("tables") = py::none(), py::arg("threads") = 0,
      "How well a result predicts a campaign, as `volcal validate`: stations and other parameters of "
      "its setups "
      "are estimated anew, errors are not. rms_before, max_before (nominal machine), rms_after, "
      "max_after, m; "
      "angle_..., rad; readings, angle_readings: counts; reduced_chi2; coverage95: share of readings "
      "within the 95 % interval, 0 to 1.\n\n"
      "tables: Tables of tables() that were active while the campaign was measured: the compensated machine "
      "is "
      "judged, by the readings less what the tables corrected; compensated_rms, compensated_max, m, "
      "compensated_angle_..., rad: what it showed with them, off the machine without errors.\n"
      "fitted_readings: how many of the readings the fit was made from, None where the result does not say; "
      "warning: that such readings prove nothing, \"\" where there are none.\n"
      "findings: what was noticed while the campaign was read, whether other compensations were active than "
      "while "
      "the errors were identified, rotary axes without errors, readings beyond those of the errors, stated "
      "values "
      "that the readings contradict. Raises InputError, also for a result of another machine.");
}

}  // namespace volcal::python
