#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/io/campaign/campaign_on_machine.h"
#include "volcal/identify/io/plan_writer.h"
#include "volcal/identify/planning/campaign_plan.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/text/plan_text.h"
#include "volcal/identify/text/today.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/python/model.h"
#include "volcal/python/result.h"
#include "volcal/python/shared/arguments.h"
#include "volcal/python/shared/arrays.h"
#include "volcal/python/shared/long_work.h"

namespace volcal::python {
namespace {

constexpr int kMostStations = 12, kFewestPlanned = 16, kMostPlanned = 20000;  // as of the command line

void require_budget(const std::optional<int>& readings, const std::optional<double>& time_h, int stations) {
  require_range("stations", stations, 1, kMostStations);
  if (readings) require_range("readings", *readings, kFewestPlanned, kMostPlanned);
  if (time_h) require_positive("time_h", *time_h);
}

std::vector<std::size_t> tools_named(const Machine& machine, const std::vector<std::string>& names) {
  std::vector<std::size_t> tools;
  for (const std::string& name : names) {
    const auto tool = machine.tool_index(name);
    if (!tool) throw InputError({}, "the machine has no tool " + name, "choose one of Machine.tools");
    tools.push_back(*tool);
  }
  return tools;
}

void set_target(const std::string& target, const std::vector<py::object>& separate, const Campaign* with,
                PlanSettings& settings) {
  for (const py::object& effect : separate)
    settings.separate.push_back(effect_spec_of(effect, settings.machine, with));
  if (!separate.empty()) {
    settings.target = PlanTarget::Separate;
  } else if (target == "worst") {
    settings.target = PlanTarget::Worst;
  } else if (target != "volumetric") {
    settings.target = PlanTarget::Symbol;
    settings.symbol = MachineError::parse(target);
  }
}

CampaignPlan plan_of(const Machine& machine, const Model* model, std::optional<int> readings,
                     std::optional<double> time_h, int stations, const std::vector<std::string>& tools,
                     const std::string& instrument, const std::string& minimise,
                     const std::vector<py::object>& separate, const std::shared_ptr<Campaign>& given,
                     bool extend, std::optional<double> bar_mm, std::optional<double> bar_sigma_um,
                     std::uint64_t seed, int threads, const py::object& progress) {
  require_threads(threads);
  require_budget(readings, time_h, stations);
  if (bar_mm) require_positive("bar_mm", *bar_mm);
  if (bar_sigma_um) require_positive("bar_sigma_um", *bar_sigma_um);
  PlanSettings settings;
  settings.machine = machine;
  settings.model = spec_for(model, machine);
  settings.instrument = instrument.empty() ? usual_plan_instrument() : instrument;
  if (find_plan_instrument(settings.instrument) == nullptr)
    throw InputError({}, "no plan is made for instrument " + instrument, "leave it out for a laser tracer");
  settings.budget.stations = stations;
  settings.budget.readings = readings;
  if (time_h) settings.budget.time = *time_h * kSecondsPerHour;
  settings.budget.tools = tools_named(machine, tools);
  if (bar_mm) settings.bar.length = *bar_mm * kMetrePerMillimetre;
  if (bar_sigma_um) settings.bar.length_sigma = *bar_sigma_um * kMetrePerMicrometre;
  settings.costs.reading = plan_instrument_of(settings).usual_reading_time();
  settings.seed = seed;
  settings.threads = threads;
  std::optional<Campaign> campaign;
  if (given != nullptr) campaign = campaign_on_machine(*given, machine);
  const Campaign* with = campaign ? &*campaign : nullptr;
  if (extend && !campaign) throw InputError({}, "there is no campaign to extend", "give campaign=");
  settings.linear_axes_known =
      model == nullptr && !extend && plan_instrument_of(settings).turns_rotary_axes();
  if (settings.linear_axes_known) settings.model = with_known_linear_axes(settings.model, machine);
  check_plan_settings(settings);
  set_target(minimise, separate, with, settings);
  if (extend) settings.existing = with;
  settings.progress = progress_to(progress);
  return without_lock([&] {
    CampaignPlan plan = extend ? extend_campaign(settings) : plan_campaign(settings, with);
    if (campaign) plan.notes = campaign->notes;
    plan.settings.progress = nullptr;
    plan.settings.existing = nullptr;
    return plan;
  });
}

void write_plan(const CampaignPlan& plan, const std::filesystem::path& path, bool report) {
  without_lock([&] {
    AtomicFolder folder(path.string(), Replaceable::Unedited);
    folder.write("plan.json", plan_json(plan));
    folder.write("plan.txt", plan_text(plan));
    write_plan_campaign(plan, folder);
    if (report && report_available())
      folder.write("report.html",
                   report_html(plan, {.date = today(), .provenance = provenance_of("volcal.plan")}));
    folder.commit();
  });
}

}  // namespace

void define_plan(py::module_& module) {
  py::class_<CampaignPlan>(module, "Plan", "A campaign that is still to be measured, and what it would tell.")
      .def_property_readonly(
          "campaign", [](const CampaignPlan& plan) { return std::make_shared<Campaign>(plan.plan.campaign); },
          "The planned campaign, with nominal readings.")
      .def_property_readonly(
          "expected_u", [](const CampaignPlan& plan) { return plan.plan.target_u; },
          "Standard uncertainty of what was minimised, SI.")
      .def_property_readonly(
          "invisible", [](const CampaignPlan& plan) { return names_of(plan.plan.invisible()); },
          "Symbols of errors that it would not show.")
      .def(
          "to_json", [](const CampaignPlan& plan) { return text_of(plan_json(plan)); },
          "plan.json as `write` writes it.")
      .def(
          "to_dict", [](const CampaignPlan& plan) { return from_json(plan_json(plan)); },
          "plan.json as dicts and lists, in edge units.")
      .def("write", &write_plan, py::arg("path"), py::arg("report") = true,
           "Writes the folder that `volcal plan` writes. Raises InputError.")
      .def("__str__", [](const CampaignPlan& plan) { return text_of(plan_text(plan)); })
      .def("__repr__", [](const CampaignPlan& plan) {
        return text_of(fmt::format("<volcal.Plan of {} setups, {} readings>",
                                   plan.plan.campaign.setups.size(), plan.plan.campaign.reading_count()));
      });
  module.def(
      "plan", &plan_of, py::arg("machine"), py::arg("model") = py::none(), py::kw_only(),
      py::arg("readings") = py::none(), py::arg("time_h") = py::none(), py::arg("stations") = 4,
      py::arg("tools") = std::vector<std::string>(), py::arg("instrument") = "",
      py::arg("minimise") = "volumetric", py::arg("separate") = py::list(), py::arg("campaign") = py::none(),
      py::arg("extend") = false, py::arg("bar_mm") = py::none(), py::arg("bar_sigma_um") = py::none(),
      py::arg("seed") = std::uint64_t{1}, py::arg("threads") = 0, py::arg("progress") = py::none(),
      "Stations, tools and positions that make the errors as certain as a budget allows, as `volcal "
      "plan`.\n\n"
      "readings or time_h (hours): the budget. stations: of the instrument. tools: names that may be used, "
      "[] = "
      "all. instrument: \"\" = laser-tracer; bar_mm, bar_sigma_um: length of a ball-bar and its standard "
      "uncertainty. minimise: \"volumetric\", \"worst\", or an error as \"EXX\". separate: two effects, as "
      "Model.extend takes them, to be separated. campaign: to compare with, or, with extend, to add to.\n"
      "seed: of the positions; the same seed gives the same plan. threads: 0 = all. progress: as of fit(). "
      "Raises "
      "InputError.");
}

}  // namespace volcal::python
