#include "volcal/identify/io/plan_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/campaign_writer.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/result/error_unit.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

using PlanJson = nlohmann::ordered_json;

PlanJson in_unit(double si, double unit) {
  return std::isfinite(si) ? PlanJson(si / unit) : PlanJson(nullptr);
}

/// What is finer is rounding of the search.
double whole_nanometres(double metres) { return std::round(metres * 1e9); }

PlanJson millimetres(const Eigen::Vector3d& place) {
  PlanJson json = PlanJson::array();
  for (const double each : place) json.push_back(whole_nanometres(each) / 1e6);
  return json;
}

const char* name_of(PlanTarget target) {
  switch (target) {
    case PlanTarget::Volumetric:
      return "volumetric";
    case PlanTarget::Worst:
      return "worst";
    case PlanTarget::Symbol:
      return "symbol";
    case PlanTarget::Separate:
      return "separate";
  }
  return "";
}

PlanJson budget_json(const CampaignPlan& plan) {
  const PlanSettings& settings = plan.settings;
  PlanJson json = {{"instrument", settings.instrument}, {"stations", settings.budget.stations}};
  if (settings.bar.length > 0.0) {
    json["bar_mm"] = settings.bar.length / kMetrePerMillimetre;
    if (settings.bar.length_sigma) json["bar_sigma_um"] = *settings.bar.length_sigma / kMicro;
  }
  if (settings.budget.readings) json["readings"] = *settings.budget.readings;
  if (settings.budget.time) json["time_h"] = *settings.budget.time / kSecondsPerHour;
  for (const std::size_t tool : tools_of(settings))
    json["tools"].push_back(settings.machine.tools[tool].name);
  json["extends"] = settings.existing != nullptr;
  return json;
}

PlanJson layout_json(const CampaignPlan& plan) {
  PlanJson stations = PlanJson::array(), runs = PlanJson::array();
  const PlanLayout& layout = plan.searched.layout;
  for (std::size_t i = 0; i < layout.stations_w.size(); ++i) {
    PlanJson station = {{"name", layout.station_names[i]},
                        {"position_mm", millimetres(layout.stations_w[i])}};
    if (i < plan.searched.station_tolerance.size())
      station["may_be_off_mm"] = plan.searched.station_tolerance[i] / kMetrePerMillimetre;
    stations.push_back(std::move(station));
  }
  for (const PlanRun& run : layout.runs) {
    const std::string name = run_name(layout, run, plan.settings.machine);
    Setup named;
    named.name = name;
    PlanJson json = {{"setup", name},
                     {"station", layout.station_names[run.station]},
                     {"tool", plan.settings.machine.tools[run.tool].name}};
    const bool turns = plan_instrument_of(plan.settings).turns_rotary_axes();
    if (!run.part.empty()) json[turns ? "path" : "plane"] = run.part;
    json["positions"] = run.positions.size();
    json["readings"] = 2 * run.positions.size();
    json["points"] = "campaign/" + readings_file_name(named);
    runs.push_back(std::move(json));
  }
  PlanJson json = {{"stations", std::move(stations)}, {"runs", std::move(runs)}};
  for (const Eigen::Vector3d& place : plan.searched.as_good_w)
    json["stations_as_good_mm"].push_back(millimetres(place));
  json["pool_positions"] = plan.searched.pool;
  json["positions_converged"] = plan.searched.converged;
  return json;
}

PlanJson errors_json(const ExpectedCampaign& campaign) {
  PlanJson errors = PlanJson::array();
  for (const Observability& error : campaign.result.rank.errors) {
    const ErrorUnit unit = unit_of(campaign.result, error.symbol);
    PlanJson json = {{"symbol", error.symbol.name()},
                     {"visible", error.visible},
                     {"visible_fraction", error.visible_fraction},
                     {"effective_parameters", in_unit(error.effective_parameters, 1.0)}};
    json["unit"] = unit.name;
    json["u"] = error.visible ? in_unit(error.u_rms, unit.si_per_unit) : PlanJson(nullptr);
    if (!error.visible) {
      const Explanation words = explanation(error.cause);
      json["reason"] = words.reason;
      json["remedy"] = words.remedy;
    }
    errors.push_back(std::move(json));
  }
  return errors;
}

PlanJson effects_json(const ExpectedCampaign& campaign) {
  PlanJson effects = PlanJson::array();
  for (const DetectableEffect& effect : campaign.detectable) {
    effects.push_back({{"kind", effect.name.kind},
                       {"target", effect.name.target.name()},
                       {"driver", effect.name.driver.name()},
                       {"shape", effect.name.shape},
                       {"label", effect.label},
                       {"visible", effect.visible},
                       {"visible_fraction", effect.visible_fraction},
                       {"unit", effect.unit},
                       {"mdb", in_unit(effect.visible ? effect.mdb : NAN, effect.si_per_unit)},
                       {"volumetric_um", in_unit(effect.visible ? effect.volumetric : NAN, kMicro)}});
  }
  return effects;
}

PlanJson campaign_json(const ExpectedCampaign& campaign) {
  return {{"name", campaign.name},
          {"setups", campaign.campaign.setups.size()},
          {"readings", campaign.campaign.reading_count()},
          {"time_h", in_unit(campaign.duration, kSecondsPerHour)},
          {"u_volumetric_rms_um", in_unit(campaign.volumetric.rms, kMicro)},
          {"u_volumetric_largest_um", in_unit(campaign.volumetric.largest, kMicro)},
          {"u_worst_length_um", in_unit(campaign.worst_length, kMicro)},
          {"worst_length_at", campaign.worst_length_at},
          {"u_worst_angle_urad", in_unit(campaign.worst_angle, kMicro)},
          {"worst_angle_at", campaign.worst_angle_at},
          {"not_visible", names_of(campaign.invisible())},
          {"errors", errors_json(campaign)},
          {"effects", effects_json(campaign)}};
}

std::string in_mm(const Eigen::Vector3d& place) {
  std::string text;
  for (const double each : place)
    text += (text.empty() ? "" : ", ") + edge_number(whole_nanometres(each) / 1e9, kMetrePerMillimetre);
  return "[" + text + "]";
}

constexpr const char* kKnownLinearAxes =
    "[truth]  # linear axes are known\nvolumetric_rms_um = [0.0, 0.0]\nreversal_max_um = "
    "0.0\nangular_reversal_max_urad = 0.0\n";

std::string points_of(const Setup& setup) { return toml_text("campaign/" + readings_file_name(setup)); }

/// Where a setup of the plan's instrument stands.
std::optional<NamedPlace> simulated_at(const CampaignPlan& plan, const Setup& setup) {
  if (setup.instrument != plan_instrument_of(plan.settings).instrument()) return std::nullopt;
  return plan_instrument_of(plan.settings).place_of(setup, plan.settings.machine);
}

std::string not_simulated(const CampaignPlan& plan) {
  std::string comments;
  for (const Setup& setup : plan.plan.campaign.setups) {
    if (simulated_at(plan, setup)) continue;
    comments += "# not simulated: setup " + setup.name + " of the campaign that is extended\n";
  }
  return comments;
}

/// First lines of a measurement.
std::string measurement_toml(const PlanSettings& settings, const InstrumentTraits& traits) {
  const PlanNoise& noise = settings.noise;
  const std::string angle =
      traits.encoders.empty() ? "" : ", angle_urad = " + edge_number(noise.angle, kRadianPerMicroradian);
  return fmt::format(
      "[[measurements]]\nkind = \"{}\"\nreading_s = {}\n"
      "noise = {{ constant_um = {}, per_metre_um = {}, repeatability_um = {}{} }}\n",
      plan_instrument_of(settings).study_kind(), edge_number(settings.costs.reading, 1.0),
      edge_number(noise.constant, kMicro), edge_number(noise.per_metre, kMicro),
      edge_number(noise.repeatability, kMicro), angle);
}

/// Stations, and runs that name them.
std::string station_runs_toml(const CampaignPlan& plan) {
  std::string stations, runs;
  std::set<std::string> known;
  for (const Setup& setup : plan.plan.campaign.setups) {
    const auto place = simulated_at(plan, setup);
    if (!place) continue;
    if (known.insert(place->name).second) {
      stations += fmt::format("[[measurements.stations]]\nname = {}\nposition_mm = {}\n",
                              toml_text(place->name), in_mm(place->place_w));
    }
    runs +=
        fmt::format("[[measurements.runs]]\nstation = {}\ntool = {}\npoints = {}\n", toml_text(place->name),
                    toml_text(plan.settings.machine.tools[setup.tool].name), points_of(setup));
  }
  return stations + runs;
}

/// Runs, each about a centre ball of its own.
std::string bar_runs_toml(const CampaignPlan& plan) {
  const PlanSettings& settings = plan.settings;
  std::string text;
  if (settings.bar.length_sigma)
    text += fmt::format("length_sigma_um = {}\n", edge_number(*settings.bar.length_sigma, kMicro));
  for (const Setup& setup : plan.plan.campaign.setups) {
    const auto place = simulated_at(plan, setup);
    if (!place) continue;
    text += fmt::format("[[measurements.runs]]\nname = {}\ncentre_mm = {}\ntool = {}\npoints = {}\n",
                        toml_text(setup.name), in_mm(place->place_w),
                        toml_text(settings.machine.tools[setup.tool].name), points_of(setup));
  }
  return text;
}

/// Spheres, and runs that name them.
std::string sphere_runs_toml(const CampaignPlan& plan) {
  std::string spheres, runs;
  std::set<std::string> known;
  for (const Setup& setup : plan.plan.campaign.setups) {
    const auto place = simulated_at(plan, setup);
    if (!place) continue;
    if (known.insert(place->name).second) {
      spheres += fmt::format("[[measurements.spheres]]\nname = {}\nposition_mm = {}\n",
                             toml_text(place->name), in_mm(place->place_w));
    }
    runs += fmt::format("[[measurements.runs]]\nname = {}\nsphere = {}\ntool = {}\npoints = {}\n",
                        toml_text(setup.name), toml_text(place->name),
                        toml_text(plan.settings.machine.tools[setup.tool].name), points_of(setup));
  }
  return spheres + runs;
}

/// [[measurements]] of a study that takes the planned readings.
std::string planned_measurement_toml(const CampaignPlan& plan) {
  const PlanInstrument& planned = plan_instrument_of(plan.settings);
  const InstrumentTraits& traits = find_instrument(planned.instrument())->schema().traits;
  const std::string head = measurement_toml(plan.settings, traits);
  if (traits.has_bar) return head + bar_runs_toml(plan);
  return head + (planned.stays_at_its_place() ? sphere_runs_toml(plan) : station_runs_toml(plan));
}

}  // namespace

std::string plan_json(const CampaignPlan& plan) {
  PlanJson json = {{"format", kPlanFormat},
                   {"machine", plan.settings.machine.name},
                   {"minimised", name_of(plan.settings.target)}};
  if (plan.settings.target == PlanTarget::Symbol) json["symbol"] = plan.settings.symbol.name();
  json["budget"] = budget_json(plan);
  json["layout"] = layout_json(plan);
  if (plan.searched.textbook > 0.0)
    json["target_to_textbook"] = std::sqrt(plan.searched.value / plan.searched.textbook);
  if (plan.replaced)
    json["searched"] = {{"target_to_textbook", plan.replaced->target_ratio},
                        {"not_visible", names_of(plan.replaced->invisible)}};
  json["campaigns"].push_back(campaign_json(plan.plan));
  if (plan.settings.existing == nullptr) json["campaigns"].push_back(campaign_json(plan.textbook));
  if (plan.given) json["campaigns"].push_back(campaign_json(*plan.given));
  json["options"] = PlanJson::array();
  for (const PlanOption& option : plan.options) {
    json["options"].push_back({{"words", sentence(option.what)},
                               {"finding", finding_json(option.what)},
                               {"new_station", option.new_station},
                               {"new_tool", option.new_tool},
                               {"readings", option.readings},
                               {"u_volumetric_rms_um", in_unit(option.volumetric_rms, kMicro)},
                               {"makes_visible", names_of(option.made_visible)},
                               {"still_not_visible", names_of(option.still_invisible)}});
  }
  if (!plan.findings.empty()) {
    json["messages"] = sentences(plan.findings);
    json["findings"] = findings_json(plan.findings);
  }
  add_notes(plan.notes, json);
  return json_text(json, 2) + "\n";
}

std::string plan_study_toml(const CampaignPlan& plan) {
  const PlanSettings& settings = plan.settings;
  return fmt::format(
      "# The plan measured on a random machine: volcal simulate study.toml -o simulated\n"
      "format = \"volcal-study-1\"\nmachine = \"machine.toml\"\nseed = {}\npause_s = {}\n{}{}\n{}",
      settings.seed, edge_number(settings.costs.run, 1.0), not_simulated(plan),
      settings.linear_axes_known ? kKnownLinearAxes : "", planned_measurement_toml(plan));
}

void write_plan_campaign(const CampaignPlan& plan, const AtomicFolder& folder) {
  folder.write("machine.toml", machine_toml(plan.settings.machine));
  folder.write("study.toml", plan_study_toml(plan));
  std::filesystem::create_directories(folder.path("campaign"));
  write_campaign(plan.plan.campaign, folder.path("campaign"), "../machine.toml");
}

}  // namespace volcal
