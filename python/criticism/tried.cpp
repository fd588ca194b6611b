#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <memory>
#include <string>

#include "volcal/identify/report/text/criticism/tried_text.h"
#include "volcal/identify/session/tried_effect.h"
#include "volcal/python/model.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

struct TriedOf {
  std::string effect;
  TriedEffect tried;
};

TriedOf try_written(const std::shared_ptr<Campaign>& campaign, const std::string& effect, const Model* model,
                    const std::vector<std::string>& parameters, int threads, const py::object& progress) {
  require_threads(threads);
  const ModelSpec spec = spec_for(model, campaign->machine);
  const WrittenEffect written = written_effect("effect", effect, parameters);
  const TryOptions options{threads, progress_to(progress)};
  return without_lock([&] {
    return at_its_column("effect", effect, [&] {
      return TriedOf{effect, try_effect(*campaign, spec, written, options)};
    });
  });
}

py::list tried_values_of(const TriedOf& of) {
  py::list list;
  for (const TriedValue& each : of.tried.values) {
    py::dict value;
    value["name"] = text_of(each.name);
    value["value"] = each.value;
    value["u"] = each.u;
    value["unit"] = text_of(each.unit);
    list.append(value);
  }
  return list;
}

py::dict size_on_lines(const Comparison& comparison) {
  py::dict size;
  size["observations"] = comparison.total.observations;
  size["chi2"] = comparison.total.chi2;
  size["rms"] = comparison.total.lengths.rms;
  size["angle_rms"] = comparison.total.angles.rms;
  return size;
}

py::object held_out_of(const TriedOf& of) {
  if (!of.tried.judged) return py::none();
  py::dict held_out;
  held_out["without"] = size_on_lines(of.tried.without);
  held_out["with"] = size_on_lines(of.tried.with);
  held_out["chi2_less_by"] = of.tried.gain.chi2;
  held_out["chi2_by_chance"] = of.tried.gain.by_chance;
  return held_out;
}

}  // namespace

void define_trial(py::module_& module) {
  py::class_<TriedOf>(module, "TriedEffect", "An effect of one's own, tried on a campaign.")
      .def_property_readonly(
          "effect", [](const TriedOf& of) { return text_of(of.effect); }, "As it was written.")
      .def_property_readonly("values", &tried_values_of,
                             "Its amplitude and what was estimated of its expression: dicts of name, value, "
                             "u (standard uncertainty; nan "
                             "where it was held) and unit, at the edge (um, urad).")
      .def_property_readonly(
          "visible", [](const TriedOf& of) { return of.tried.not_visible.empty(); },
          "Whether the readings show it.")
      .def_property_readonly(
          "not_visible", [](const TriedOf& of) { return text_of(of.tried.not_visible); },
          "Why not; \"\" where they do.")
      .def_property_readonly(
          "status", [](const TriedOf& of) { return std::string(to_string(of.tried.status)); },
          "Status of the fit with it, as of a Result.")
      .def_property_readonly("held_out", &held_out_of,
                             "On lines that neither fit has seen, \"without\" and \"with\" it: observations, "
                             "chi2, rms (m), angle_rms (rad); \"chi2_less_by\" with it, and "
                             "\"chi2_by_chance\", which noise alone makes of that, either way, with 95 % at "
                             "most. None where there are too few lines.")
      .def_property_readonly(
          "verdict_of_what_remains",
          [](const TriedOf& of) { return std::string(to_string(of.tried.remains.verdict)); },
          "Verdict of a diagnosis of the model with it that draws nothing: \"NOTHING_ABOVE\" where nothing "
          "is left above the noise.")
      .def(
          "to_json", [](const TriedOf& of) { return text_of(tried_json(of.effect, of.tried)); },
          "What `volcal try --json` prints.")
      .def(
          "to_dict", [](const TriedOf& of) { return from_json(tried_json(of.effect, of.tried)); },
          "The same as dicts and lists, in edge units.")
      .def("__str__", [](const TriedOf& of) { return text_of(tried_text(of.effect, of.tried)); })
      .def(
          "_repr_html_",
          [](const TriedOf& of) {
            return text_of("<pre>" + escaped(tried_text(of.effect, of.tried)) + "</pre>");
          },
          "The text that str() gives, for notebooks.")
      .def("__repr__", [](const TriedOf& of) { return text_of("<volcal.TriedEffect " + of.effect + ">"); });
  module.def("try_effect", &try_written, py::arg("campaign").none(false), py::arg("effect"),
             py::arg("model") = py::none(), py::kw_only(), py::arg("parameters") = std::vector<std::string>(),
             py::arg("threads") = 0, py::arg("progress") = py::none(),
             "Tries an effect of one's own, as `volcal try` (try is a word of Python's): its size, whether "
             "it predicts "
             "readings better that no fit has seen, and what remains; the same numbers to the last bit.\n\n"
             "effect: \"EZX: abs(x) / 400 * dir_x\" or \"EXX += dir_x * (T_air - 20)\". model: that it is "
             "added to, None "
             "= all 21 errors. parameters: of the expression, \"p=250\" (held) or \"p=250+-50\" (estimated). "
             "threads: 0 "
             "= all. progress: as of fit(). Raises InputError.");
}

}  // namespace volcal::python
