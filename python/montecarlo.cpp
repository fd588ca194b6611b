#include "volcal/identify/montecarlo/montecarlo.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/io/results/montecarlo_writer.h"
#include "volcal/identify/montecarlo/disturbance.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/field_text.h"
#include "volcal/identify/report/text/montecarlo_text.h"
#include "volcal/identify/result/fitted_readings.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/today.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

struct Study {
  MonteCarloResult result;
  Machine machine;
};

/// Until it is done, or the time is over; Ctrl-C ends it between two blocks.
void draw_blocks(MonteCarloStudy& study, double minutes,
                 const std::function<void(const std::string&, double)>& tell) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  while (!study.done()) {
    study.run_block();
    const std::uint64_t expected = study.expected_draws();
    const double share =
        expected == 0 ? 0.0 : static_cast<double>(study.draws()) / static_cast<double>(expected);
    tell(fmt::format("{} draws", study.draws()), std::min(1.0, share));
    const double past = std::chrono::duration<double>(Clock::now() - start).count();
    if (minutes > 0.0 && past > minutes * kSecondsPerMinute) return;
  }
}

/// Whether a result was made from these readings, setup by setup.
bool is_fit_of(const Campaign& campaign, const FitResult& result) {
  return std::ranges::equal(campaign.setups, result.setups,
                            [](const Setup& setup, const SetupSummary& fitted) {
                              return readings_fingerprint(setup) == fitted.fingerprint;
                            });
}

/// Draws need the readings that were adjusted, and the adjustment.
void require_fit_of(const Campaign& campaign, const Result& of) {
  const FitResult& result = of.result;
  const std::string remedy = "give fit() of this campaign";
  if (!result.alignment.empty())
    throw InputError({}, "the result is aligned, and draws are of a fit", remedy + ", not aligned");
  if (result.residuals.empty() || result.adjustment == nullptr)
    throw InputError({}, "the result was read from files, without residuals", remedy);
  if (of.campaign.get() == &campaign) return;
  if (!is_fit_of(campaign, result))
    throw InputError({campaign.file, 0}, "the result is of another campaign", remedy);
  readings_for(campaign, result, {campaign.file, 0});
}

/// Ranges as of the command line.
void require_sample(std::uint64_t draws, const std::optional<int>& digits, std::uint64_t most_draws,
                    int refits, int grid) {
  constexpr int kMostDigits = 2, kMostRefits = 1000, kMostPoints = 11;
  if (digits) require_range("digits", *digits, 1, kMostDigits);
  if (digits && draws > 0)
    throw InputError({}, "digits and draws are given, and each says when to end", "leave one of the two out");
  require_positive("most_draws", static_cast<double>(most_draws));
  require_range("refits", refits, 0, kMostRefits);
  require_range("grid", grid, 0, kMostPoints);
}

Study draw_campaign(const Campaign& campaign, const Result& result, std::uint64_t draws,
                    const std::optional<int>& digits, std::uint64_t most_draws, std::uint64_t seed,
                    const std::string& path, const std::string& functions, int refits, int grid, int threads,
                    double minutes, const std::vector<std::string>& disturb, const py::dict& conditions,
                    bool within_readings, const py::object& progress) {
  require_fit_of(campaign, result);
  require_not_negative("minutes", minutes);
  require_sample(draws, digits, most_draws, refits, grid);
  require_threads(threads);
  MonteCarloOptions options;
  options.path = draw_path(path);
  options.draws = draws;
  options.digits = digits.value_or(options.digits);
  options.most_draws = most_draws;
  options.seed = seed;
  options.threads = threads;
  options.refits = refits;
  options.grid_per_axis = grid;
  options.sources.functions = function_roughness(functions);
  for (const std::string& text : disturb)
    options.sources.disturbances.push_back(disturbance_from(text, campaign));
  const Conditions stated = stated_conditions(result.result, named_texts(conditions));
  if (!conditions.empty()) options.conditions = stated;
  if (within_readings) require_within_readings(result.result, stated);
  const auto tell = progress_to(progress);
  return without_lock([&] {
    tell("refits", 0.0);
    MonteCarloStudy study(campaign, result.result, options);
    draw_blocks(study, draws == 0 ? minutes : 0.0, tell);
    Study drawn{study.result(), result.result.machine};
    drawn.result.notes = campaign.notes;
    return drawn;
  });
}

template <class Value>
py::array_t<double> quantity_array(const Study& study, const Value& value) {
  std::vector<double> values;
  for (const QuantityResult& each : study.result.quantities) values.push_back(value(each));
  return array_of(values);
}

py::list quantity_names(const Study& study) {
  py::list names;
  for (const QuantityResult& each : study.result.quantities) names.append(text_of(each.quantity.words()));
  return names;
}

void write_study(const Study& study, const std::filesystem::path& path, bool report) {
  without_lock([&] {
    AtomicFolder folder(path.string());
    folder.write("montecarlo.json", montecarlo_json(study.result));
    folder.write("montecarlo.csv", montecarlo_csv(study.result));
    folder.write("montecarlo.txt", montecarlo_text(study.result));
    if (report && report_available())
      folder.write("report.html",
                   report_html(study.result, study.machine,
                               {.date = today(), .provenance = provenance_of("volcal.montecarlo")}));
    folder.commit();
  });
}

}  // namespace

void define_montecarlo(py::module_& module) {
  py::class_<Study>(module, "MonteCarlo", "Distributions of q quantities by drawing a campaign again; SI.")
      .def_property_readonly(
          "names", &quantity_names,
          "The q quantities in words: \"EXX at 400 mm +\", \"station P1 x\", \"rms of tool long\".")
      .def_property_readonly(
          "estimate",
          [](const Study& study) {
            return quantity_array(study, [](const QuantityResult& each) { return each.quantity.estimate; });
          },
          "Values of the fit: float array of shape (q,), SI.")
      .def_property_readonly(
          "u",
          [](const Study& study) {
            return quantity_array(study, [](const QuantityResult& each) { return each.u; });
          },
          "Standard uncertainties of the draws: float array of shape (q,), SI.")
      .def_property_readonly(
          "u_linear",
          [](const Study& study) {
            return quantity_array(study, [](const QuantityResult& each) { return each.u_linear; });
          },
          "Standard uncertainties by linear propagation: float array of shape (q,), SI.")
      .def_property_readonly(
          "bias",
          [](const Study& study) {
            return quantity_array(study, [](const QuantityResult& each) { return each.bias; });
          },
          "Means of the draws less the estimates: float array of shape (q,), SI.")
      .def_property_readonly(
          "draws", [](const Study& study) { return study.result.draws; }, "Number of draws.")
      .def_property_readonly(
          "path", [](const Study& study) { return std::string(to_string(study.result.path)); },
          "How draws were made: \"linear\", \"chord\" or \"refit\".")
      .def_property_readonly(
          "settled", [](const Study& study) { return study.result.settled; },
          "Whether the digits that were asked for are right in all quantities.")
      .def(
          "to_json", [](const Study& study) { return text_of(montecarlo_json(study.result)); },
          "montecarlo.json as `write` writes it.")
      .def(
          "to_dict", [](const Study& study) { return from_json(montecarlo_json(study.result)); },
          "montecarlo.json as dicts and lists, in edge units.")
      .def("write", &write_study, py::arg("path"), py::arg("report") = true,
           "Writes the folder that `volcal montecarlo` writes. Raises InputError.")
      .def("__str__", [](const Study& study) { return text_of(montecarlo_text(study.result)); })
      .def("__repr__", [](const Study& study) {
        return text_of(fmt::format("<volcal.MonteCarlo of {} quantities, {} draws>",
                                   study.result.quantities.size(), study.result.draws));
      });
  module.def(
      "montecarlo", &draw_campaign, py::arg("campaign").none(false), py::arg("result"), py::kw_only(),
      py::arg("draws") = std::uint64_t{0}, py::arg("digits") = py::none(),
      py::arg("most_draws") = std::uint64_t{10000000}, py::arg("seed") = std::uint64_t{1},
      py::arg("path") = "auto", py::arg("functions") = "drawn", py::arg("refits") = 20, py::arg("grid") = 3,
      py::arg("threads") = 0, py::arg("minutes") = 10.0, py::arg("disturb") = std::vector<std::string>(),
      py::arg("conditions") = py::dict(), py::arg("within_readings") = false,
      py::arg("progress") = py::none(),
      "Distributions of every error by drawing the campaign again, as `volcal montecarlo`; the same seed "
      "gives "
      "the same bits for any number of threads. `result` must come from fit() of this campaign.\n\n"
      "draws: 0 = until `digits` (1 or 2; None = 2) of every uncertainty are right, at most `most_draws` and "
      "`minutes` (0 = no "
      "limit). path: \"auto\", \"linear\", \"chord\", \"refit\". functions: \"drawn\" or \"fixed\". refits: "
      "sample on which the paths are compared. grid: points per axis whose errors are listed, 0 = nothing of "
      "the volume.\n"
      "disturb: effects that act on the readings and that the fit knows nothing of, \"KIND:TARGET=U\" of "
      "standard "
      "uncertainty U or \"KIND:TARGET=+-A\" within limits A, in the unit of the effect. conditions: "
      "{\"T_air\": "
      "24.0} that errors are stated for. within_readings: refuse where an axis was measured over a part of "
      "its "
      "travel, and conditions beyond the measured ones.\n"
      "progress: called with the stage and the share of the work that is done, 0 to 1; what it raises ends "
      "the "
      "work, as does Ctrl-C between two blocks of draws. Raises InputError.");
}

}  // namespace volcal::python
