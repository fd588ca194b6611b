#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "volcal/identify/criticism/asked_laws.h"
#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/diagnosis_folder.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/criticism/diagnosis_text.h"
#include "volcal/identify/report/values/volume_causes.h"
#include "volcal/identify/session/diagnosed_campaign.h"
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

/// A diagnosis with what it was made from.
struct DiagnosisOf {
  Diagnosis diagnosis;
  std::shared_ptr<const Campaign> campaign;  ///< null where it was read from files
  ModelSpec model;
  std::shared_ptr<const FitResult> fit = {};  ///< null where it was read from files

  const Campaign& given_campaign() const {
    if (campaign != nullptr) return *campaign;
    throw InputError({}, "the diagnosis was read from files, without its campaign",
                     "extend a model by its effects: model.extend(diagnosis.effects[0], campaign)");
  }
};

constexpr long long kFewestFurther = 8, kMostFurther = 10000;  // as of the command line

DiagnosisOf diagnose_campaign(const std::shared_ptr<Campaign>& campaign, const Model* model, bool climb,
                              int threads, const std::vector<std::string>& leave_out,
                              const std::vector<py::object>& separate, std::size_t readings,
                              const std::vector<std::string>& try_effects,
                              const std::vector<std::string>& formula,
                              const std::vector<std::string>& parameters, const py::object& progress) {
  require_threads(threads);
  require_range("readings", static_cast<long long>(readings), kFewestFurther, kMostFurther);
  ModelSpec spec = spec_for(model, campaign->machine);
  DiagnoseOptions options;
  options.threads = threads;
  options.climb = climb;
  options.leave_out = leave_out;
  options.planning.readings = readings;
  for (const py::object& effect : separate)
    options.planning.separate.push_back(effect_spec_of(effect, campaign->machine, campaign.get()));
  for (const WrittenEffect& tried : written_effects("try_effects", try_effects, parameters))
    options.own.push_back(tried.spec);
  const ModelSpec given = spec;
  for (const std::string& text : formula)
    std::ranges::move(asked_laws(text, spec), std::back_inserter(options.asked_laws));
  options.progress = progress_to(progress);
  return without_lock([&] {
    DiagnosisOf of{{}, campaign, spec};
    DiagnosedModel diagnosed = diagnosed_campaign(*campaign, of.model, options);
    of.diagnosis = std::move(diagnosed.diagnosis);
    if (const auto taken = surfaces_taken_out(given, of.model)) of.diagnosis.findings.push_back(*taken);
    of.fit = std::make_shared<const FitResult>(std::move(diagnosed.fit));
    return of;
  });
}

void write_diagnosis(const DiagnosisOf& of, const std::filesystem::path& path, bool report) {
  const Campaign& campaign = of.given_campaign();
  without_lock([&] {
    std::map<std::string, std::string> more = {{"diagnosis.txt", diagnosis_text(of.diagnosis)}};
    if (report && report_available()) {
      const VolumeCauses causes = volume_causes(*of.fit, accepted_effects(of.diagnosis));
      more["report.html"] = report_html(
          of.diagnosis, campaign, {.date = today(), .provenance = provenance_of("volcal.diagnose")}, &causes);
    }
    write_diagnosis_folder(of.diagnosis, campaign.machine, offered_models(of.model, campaign, of.diagnosis),
                           path.string(), more);
  });
}

Model model_with_found(const DiagnosisOf& of) {
  const Campaign& campaign = of.given_campaign();
  return without_lock([&] {
    return Model{offered_models(of.model, campaign, of.diagnosis).front().model, campaign.machine};
  });
}

py::list amplitudes_of(const EffectFinding& effect) {
  py::list list;
  for (const AmplitudeFigure& each : effect.amplitudes) {
    py::dict amplitude;
    amplitude["label"] = text_of(each.label);
    amplitude["value"] = each.value;
    amplitude["u"] = each.u;
    amplitude["mdb"] = each.mdb;
    amplitude["unit"] = text_of(each.unit);
    amplitude["si_per_unit"] = each.si_per_unit;
    list.append(amplitude);
  }
  return list;
}

void define_effect(py::module_& module) {
  py::class_<EffectFinding>(module, "EffectFinding",
                            "An effect that a diagnosis names, or a candidate of it.")
      .def_property_readonly(
          "name", [](const EffectFinding& effect) { return text_of(full_name(effect.name)); },
          "\"KIND:TARGET:DRIVER:SHAPE\".")
      .def_property_readonly(
          "kind", [](const EffectFinding& effect) { return text_of(effect.name.kind); },
          "Kind: \"axis-coupling\".")
      .def_property_readonly(
          "target", [](const EffectFinding& effect) { return text_of(effect.name.target.name()); },
          "What it acts on: \"EAY\", \"tool long z\", \"station P1\".")
      .def_property_readonly(
          "label", [](const EffectFinding& effect) { return text_of(effect.label); }, "How reports call it.")
      .def_property_readonly(
          "amplitudes", &amplitudes_of,
          "Its amplitudes, each a dict: label, value, u (standard uncertainty), mdb (smallest "
          "amplitude found with 80 % power), SI; unit and si_per_unit of the edge.")
      .def_property_readonly(
          "shape", [](const EffectFinding& effect) { return text_of(effect.shape_text); },
          "Parameters of its shape in words: \"period 10.02 mm\"; \"\" without.")
      .def_property_readonly(
          "log10_p", [](const EffectFinding& effect) { return effect.log10_p; },
          "Decadic logarithm of the probability of such a test by chance, over all tests.")
      .def(
          "to_toml", [](const EffectFinding& effect) { return text_of(effect_toml(effect.spec)); },
          "Its [[effects]] table for a model.toml.")
      .def("__repr__", [](const EffectFinding& effect) {
        return text_of("<volcal.EffectFinding " + full_name(effect.name) + ">");
      });
}

void define_step(py::module_& module) {
  py::class_<LadderStep>(
      module, "LadderStep",
      "A model of the ladder of a diagnosis, judged on lines that it has not seen; lengths in m.")
      .def_property_readonly(
          "model", [](const LadderStep& step) { return step.model; },
          "Number of the model: \"0\" is the given one.")
      .def_property_readonly(
          "added", [](const LadderStep& step) { return text_of(step.added); },
          "What was added, \"\" for the first.")
      .def_readonly("rms_fit", &LadderStep::rms_fit, "RMS of the fitted readings, m.")
      .def_readonly("rms_heldout", &LadderStep::rms_heldout,
                    "RMS of the held-out readings, m; nan without any.")
      .def_readonly("noise_floor", &LadderStep::noise_floor, "RMS noise of the held-out readings, m.")
      .def_readonly("systematic", &LadderStep::systematic, "What of rms_heldout exceeds the noise, m.")
      .def_readonly("systematic_low", &LadderStep::systematic_low, "Lower end of its 95 % interval, m.")
      .def_readonly("systematic_high", &LadderStep::systematic_high, "Upper end of its 95 % interval, m.")
      .def_readonly("heldout_loglik_gain", &LadderStep::heldout_loglik_gain,
                    "Log likelihood of the held-out readings against the step before, natural.")
      .def("__repr__", [](const LadderStep& step) {
        return text_of(fmt::format("<volcal.LadderStep {} {}: {:.3g} um held out>", step.model, step.added,
                                   step.rms_heldout * 1e6));
      });
}

std::string diagnosis_html(const DiagnosisOf& of) {
  return fmt::format("<div><p><b>{}</b></p><pre>{}</pre></div>", to_string(of.diagnosis.verdict),
                     escaped(diagnosis_summary_text(of.diagnosis)));
}

void define_diagnosis_class(py::module_& module) {
  py::class_<DiagnosisOf>(module, "Diagnosis", "Where a model fails to explain readings, and what it lacks.")
      .def_property_readonly(
          "verdict", [](const DiagnosisOf& of) { return to_string(of.diagnosis.verdict); },
          "\"NAMED\", \"NAMED_MORE_REMAINS\", \"ONE_OF\", \"UNKNOWN\", \"NOTHING_ABOVE\" or \"NOT_VISIBLE\".")
      .def_property_readonly(
          "findings", [](const DiagnosisOf& of) { return findings_of(of.diagnosis.findings); },
          "What the verdict says.")
      .def_property_readonly(
          "effects", [](const DiagnosisOf& of) { return of.diagnosis.effects; },
          "Effects that it names, in the order in which they were added.")
      .def_property_readonly(
          "accepted", [](const DiagnosisOf& of) { return accepted_effects(of.diagnosis); },
          "What extended_model() adds: these, and what was drawn for what has no name.")
      .def_property_readonly(
          "one_of", [](const DiagnosisOf& of) { return of.diagnosis.one_of; },
          "Alternatives that the readings do not separate.")
      .def_property_readonly(
          "ranked", [](const DiagnosisOf& of) { return ranked_effects(of.diagnosis); },
          "Effects by rank, most likely first: added, not separated, then the ranking of all.")
      .def_property_readonly(
          "ladder", [](const DiagnosisOf& of) { return of.diagnosis.ladder; },
          "The given model and each with one effect more.")
      .def("extended_model", &model_with_found,
           "The model that was diagnosed with what was found. Raises InputError for a diagnosis read from "
           "files.")
      .def(
          "to_json", [](const DiagnosisOf& of) { return text_of(diagnosis_json(of.diagnosis)); },
          "diagnosis.json as `write` writes it.")
      .def(
          "to_dict", [](const DiagnosisOf& of) { return from_json(diagnosis_json(of.diagnosis)); },
          "diagnosis.json as dicts and lists: amplitudes in their units, um elsewhere.")
      .def("write", &write_diagnosis, py::arg("path"), py::arg("report") = true,
           "Writes the folder that `volcal diagnose` writes: diagnosis.json, diagnosis.txt, extended.toml, "
           "and "
           "report.html unless `report` is False. Raises InputError.")
      .def("__str__", [](const DiagnosisOf& of) { return text_of(diagnosis_text(of.diagnosis)); })
      .def("__repr__",
           [](const DiagnosisOf& of) {
             return text_of("<volcal.Diagnosis " + to_string(of.diagnosis.verdict) + ", " +
                            std::to_string(of.diagnosis.effects.size()) + " effects>");
           })
      .def(
          "_repr_html_", [](const DiagnosisOf& of) { return text_of(diagnosis_html(of)); },
          "Verdict and summary, for notebooks.");
}

}  // namespace

void define_diagnosis(py::module_& module) {
  define_effect(module);
  define_step(module);
  define_diagnosis_class(module);
  module.def(
      "diagnose", &diagnose_campaign, py::arg("campaign").none(false), py::arg("model") = py::none(),
      py::kw_only(), py::arg("climb") = false, py::arg("threads") = 0,
      py::arg("leave_out") = std::vector<std::string>(), py::arg("separate") = py::list(),
      py::arg("readings") = PlanningOptions{}.readings, py::arg("try_effects") = std::vector<std::string>(),
      py::arg("formula") = std::vector<std::string>(), py::arg("parameters") = std::vector<std::string>(),
      py::arg("progress") = py::none(),
      "Where a model fails and which effect it lacks, as `volcal diagnose`: the same numbers to the last "
      "bit. Own "
      "effects (register_effect) are looked for too.\n\n"
      "model: None = all 21 errors. climb: add everything that is found, one effect after another (--auto). "
      "threads: 0 = all; results do not depend on it. leave_out: kinds that are not looked for.\n"
      "separate: effects, as Model.extend takes them, that a next measurement should separate; readings: how "
      "many "
      "it may take.\n"
      "try_effects: effects of one's own, \"TARGET: expression\" or \"TARGET += expression\", judged like "
      "those of "
      "the catalogue; parameters: of their expressions, as of try_effect(). formula: \"TARGET: DRIVERS\", "
      "which law "
      "of one to three recorded variables the target follows, or \"model\", laws behind the surfaces of the "
      "model, "
      "which is criticised without them.\n"
      "progress: called with the stage and the share of the work that is done, 0 to 1; what it raises ends "
      "the "
      "work, as does Ctrl-C when the next stage begins. Raises InputError.");
  module.def(
      "read_diagnosis",
      [](const std::filesystem::path& path) {
        return DiagnosisOf{read_diagnosis(path.string()), nullptr, {}};
      },
      py::arg("path"),
      "Diagnosis of a folder that `volcal diagnose` or Diagnosis.write wrote, or of its diagnosis.json. "
      "Raises "
      "InputError.");
}

}  // namespace volcal::python
