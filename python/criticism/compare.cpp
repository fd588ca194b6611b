#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/heldout_comparison.h"
#include "volcal/identify/criticism/screening.h"
#include "volcal/identify/errors/errors_of_tables.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/io/results/residual_writer.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/comparison_report.h"
#include "volcal/identify/report/values/circle_causes.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/today.h"
#include "volcal/model/description/errors.h"
#include "volcal/python/model.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/findings.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

const std::string kNominal = "nominal";

/// A model that is compared, by the name that it was given.
struct GivenModel {
  std::string given;
  std::string name;  ///< in full: "nominal machine"
  ModelSpec spec;
  ModelSpec refittable;
  bool can_be_fitted = true;
  const FitResult* result = nullptr;
  std::optional<Campaign> aligned = {};

  const Campaign& readings(const Campaign& campaign) const { return aligned ? *aligned : campaign; }
};

struct ComparisonOf {
  std::shared_ptr<const Campaign> campaign;
  std::vector<ComparedModel> models;
  std::vector<HeldOutModel> heldout;
  ComparisonTextOptions shown;

  std::string json() const { return comparison_json(*campaign, models, heldout); }
  std::string text() const {
    const std::string text = comparison_text(*campaign, models, shown);
    return heldout.empty() ? text : text + '\n' + heldout_text(*campaign, heldout, campaign->reading_count());
  }
};

GivenModel given_result(const std::string& name, const FitResult& result, const Campaign& campaign) {
  GivenModel model{name, name, model_of_result(result), refittable_model(result), true, &result};
  model.aligned = readings_for(campaign, result, {name, 0});
  return model;
}

GivenModel given_spec(const std::string& name, const Model& given, const Campaign& campaign) {
  GivenModel model{name, name, given.spec, given.spec};
  model.aligned = readings_for(campaign, stated_result(given.machine, given.spec), {name, 0});
  model.name = compared_name(name, given.spec);
  return model;
}

GivenModel given_model(const py::handle& given, const std::string& name, const Campaign& campaign) {
  if (py::isinstance<Result>(given))
    return given_result(name.empty() ? "result" : name, given.cast<const Result&>().result, campaign);
  if (py::isinstance<Model>(given)) {
    const auto& model = given.cast<const Model&>();
    return given_spec(!name.empty()             ? name
                      : model.spec.file.empty() ? "model"
                                                : model.spec.file,
                      model, campaign);
  }
  if (py::isinstance<py::str>(given) && given.cast<std::string>() == kNominal)
    return {kNominal, "nominal machine", nominal_model(), nominal_model(), false};
  throw py::type_error("compare() takes one or two of: a Result, a Model, \"nominal\"");
}

std::vector<GivenModel> given_models(const py::sequence& given, const std::vector<std::string>& names,
                                     const Campaign& campaign) {
  if (py::isinstance<py::str>(given)) throw py::type_error("compare() takes a list of one or two models");
  if (given.size() < 1 || given.size() > 2)
    throw InputError({}, fmt::format("{} models are given", given.size()), "give one or two");
  if (!names.empty() && names.size() != given.size())
    throw InputError({}, fmt::format("{} names for {} models", names.size(), given.size()),
                     "give one per model");
  std::vector<GivenModel> models;
  for (std::size_t i = 0; i < given.size(); ++i)
    models.push_back(given_model(given[i], names.empty() ? "" : names[i], campaign));
  return models;
}

/// The campaign with what is to be said of the models among its notes.
std::shared_ptr<const Campaign> with_notes(const std::shared_ptr<const Campaign>& campaign,
                                           const std::vector<GivenModel>& models) {
  std::vector<ModelSpec> specs;
  std::vector<Finding> of_tables;
  for (const GivenModel& model : models) {
    specs.push_back(model.spec);
    if (model.result == nullptr) continue;
    std::ranges::move(findings_of_tables(*model.result, tools_of_setups(*campaign)),
                      std::back_inserter(of_tables));
  }
  auto noted = std::make_shared<Campaign>(*campaign);
  note_compared(specs, of_tables, *noted);
  return noted;
}

ComparedModel evaluated(const GivenModel& model, const Campaign& campaign, const ComparisonOptions& options,
                        int threads) {
  const Campaign& readings = model.readings(campaign);
  Evaluation evaluation = evaluate_model(readings, model.spec, nullptr, threads);
  std::optional<Screening> screening;
  if (model.result != nullptr)
    screening = screen_evaluated(readings, as_fitted(evaluation, *model.result), *model.result, threads);
  ComparedModel compared = compared_model(model.name, readings, std::move(evaluation.residuals), options);
  compared.screening = screening;
  compared.circle_causes =
      circle_causes(readings, model.spec, evaluation.parameters, model.result, compared.figures.circles);
  return compared;
}

using CompareProgress = std::function<void(const std::string& stage, double done)>;

std::vector<HeldOutModel> judged_on_heldout(const Campaign& campaign, const std::vector<GivenModel>& models,
                                            const ComparisonOptions& options, int threads,
                                            const CompareProgress& progress) {
  const auto rows = judging_rows(campaign);
  if (std::ranges::none_of(rows, [](const auto& setup) { return std::ranges::count(setup, true) > 0; }))
    throw InputError({campaign.file, 0}, "held_out: the setups have too few readings to hold lines out",
                     "at least fifty readings, or five lines, of a setup are needed");
  std::vector<HeldOutModel> judged;
  for (std::size_t i = 0; i < models.size(); ++i) {
    const GivenModel& model = models[i];
    const auto part = [&, i](const std::string& stage, double done) {
      progress(stage, (static_cast<double>(i) + done) / static_cast<double>(models.size()));
    };
    const auto records = heldout_residuals(model.readings(campaign), model.refittable, rows,
                                           {threads, model.can_be_fitted, part});
    judged.push_back({model.given, model.can_be_fitted, compare(campaign, records, options)});
  }
  return judged;
}

ComparisonOf compare_models(const std::shared_ptr<Campaign>& campaign, const py::sequence& given,
                            const std::vector<std::string>& names, bool held_out, std::size_t worst,
                            int threads, const py::object& callback) {
  require_threads(threads);
  const std::vector<GivenModel> models = given_models(given, names, *campaign);
  const CompareProgress progress = progress_to(callback);
  return without_lock([&] {
    ComparisonOptions options;
    options.worst = worst;
    ComparisonOf of{with_notes(campaign, models), {}, {}, {.all_cells = false, .worst = worst}};
    for (const GivenModel& model : models) {
      progress("readings by " + model.name, 0.0);
      of.models.push_back(evaluated(model, *campaign, options, threads));
    }
    if (held_out) of.heldout = judged_on_heldout(*campaign, models, options, threads, progress);
    return of;
  });
}

void write_comparison_folder(const ComparisonOf& of, const std::filesystem::path& path, bool report) {
  without_lock([&] {
    AtomicFolder folder(path.string());
    for (std::size_t i = 0; i < of.models.size(); ++i) {
      const std::string name =
          of.models.size() == 1 ? "residuals.csv" : fmt::format("residuals_{}.csv", "AB"[i]);
      write_residuals_csv(folder.path(name), of.models[i].records, *of.campaign);
    }
    folder.write("comparison.txt", of.text());
    folder.write("comparison.json", of.json());
    if (report && report_available())
      folder.write("report.html",
                   report_html(ComparisonView{of.models, of.heldout}, *of.campaign,
                               {.date = today(), .provenance = provenance_of("volcal.compare")}));
    folder.commit();
  });
}

template <class Value>
py::list per_model(const ComparisonOf& of, const Value& value) {
  py::list list;
  for (const ComparedModel& model : of.models) list.append(value(model));
  return list;
}

py::list residual_views(const py::object& self) {
  return per_model(self.cast<const ComparisonOf&>(),
                   [&](const ComparedModel& model) { return residual_view(model.records, self); });
}

}  // namespace

void define_comparison(py::module_& module) {
  py::class_<ComparisonOf>(
      module, "Comparison",
      "Where one or two models fail to explain the readings of a campaign, with the figures of ISO "
      "230.")
      .def_property_readonly(
          "names",
          [](const ComparisonOf& of) {
            return per_model(of, [](const ComparedModel& model) { return text_of(model.name); });
          },
          "Names of the models, in the order given.")
      .def_property_readonly(
          "where_it_fails",
          [](const ComparisonOf& of) {
            return per_model(of, [](const ComparedModel& model) { return text_of(failure_sentence(model)); });
          },
          "A sentence per model.")
      .def_property_readonly(
          "rms",
          [](const ComparisonOf& of) {
            return per_model(of,
                             [](const ComparedModel& model) { return model.comparison.total.lengths.rms; });
          },
          "Root mean square of the residuals of lengths, m, per model; 0 without such readings.")
      .def_property_readonly(
          "angle_rms",
          [](const ComparisonOf& of) {
            return per_model(of,
                             [](const ComparedModel& model) { return model.comparison.total.angles.rms; });
          },
          "The same of angles, rad.")
      .def_property_readonly(
          "findings", [](const ComparisonOf& of) { return findings_of(of.campaign->notes); },
          "What was noticed while the campaign was read, rotary axes of which a model has no errors, "
          "readings beyond "
          "those of its errors, what tables hold that they were read from.")
      .def_property_readonly(
          "residuals", &residual_views,
          "Per model one record per observation: structured arrays of shape (m,), SI, read-only, no "
          "copy, with the fields of Result.residuals.")
      .def(
          "to_json", [](const ComparisonOf& of) { return text_of(of.json()); },
          "What `volcal compare --json` prints.")
      .def(
          "to_dict", [](const ComparisonOf& of) { return from_json(of.json()); },
          "The same as dicts and lists, in edge units.")
      .def("write", &write_comparison_folder, py::arg("path"), py::arg("report") = true,
           "Writes the folder that `volcal compare -o` writes. Raises InputError.")
      .def("__str__", [](const ComparisonOf& of) { return text_of(of.text()); })
      .def(
          "_repr_html_",
          [](const ComparisonOf& of) { return text_of("<pre>" + escaped(of.text()) + "</pre>"); },
          "The text that str() gives, for notebooks.")
      .def("__repr__", [](const ComparisonOf& of) {
        return text_of(fmt::format("<volcal.Comparison of {} on {}>",
                                   of.models.size() == 1 ? "a model" : "two models", of.campaign->file));
      });
  module.def(
      "compare", &compare_models, py::arg("campaign").none(false), py::arg("models"), py::kw_only(),
      py::arg("names") = std::vector<std::string>(), py::arg("held_out") = false, py::arg("worst") = 10,
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      "One or two models on the readings of a campaign, stations and the like estimated anew, as `volcal "
      "compare`: "
      "the same numbers to the last bit.\n\n"
      "models: one or two of a Result, a Model, \"nominal\" (the machine without errors); a Model without "
      "coefficients is the nominal machine. names: what they are called, [] = \"result\", the file of the "
      "model. "
      "held_out: fit them anew without every fifth line and judge them on those lines. worst: readings "
      "listed. "
      "threads: 0 = all. progress: as of fit(). Raises InputError.");
}

}  // namespace volcal::python
