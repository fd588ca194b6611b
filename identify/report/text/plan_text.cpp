#include "volcal/identify/report/text/plan_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/planning/rotary_positions.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/values/detectable_groups.h"
#include "volcal/identify/result/error_unit.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

std::string joined_words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string hours(double seconds) {
  return std::isfinite(seconds) ? fixed_number(seconds / kSecondsPerHour, 2) : "-";
}

std::string tolerance_text(double tolerance) {
  return tolerance > 0.0 ? fixed_number(tolerance * kPerMilli, 0) : "< 10";
}

/// Plan, what it is compared with, the user's own.
std::vector<const ExpectedCampaign*> compared(const CampaignPlan& plan) {
  std::vector<const ExpectedCampaign*> all = {&plan.plan};
  if (plan.settings.existing == nullptr) all.push_back(&plan.textbook);
  if (plan.given) all.push_back(&*plan.given);
  return all;
}

InstrumentWords words_of(const CampaignPlan& plan) { return plan_instrument_of(plan.settings).words(); }

/// "100 mm, u 0.5 um"
std::string bar_words(const PlannedBar& bar) {
  const std::string length = fmt::format("{:g} mm", bar.length * kPerMilli);
  if (!bar.length_sigma) return length + ", length unknown";
  return fmt::format("{}, u {:g} um", length, *bar.length_sigma * kPerMicro);
}

/// "short 76, side_x 90"; where a tool has several parts "short XY 72, short YZ 66".
std::string readings_by_tool(const PlanLayout& layout, std::size_t station, const Machine& machine) {
  std::string text;
  for (const PlanRun& run : layout.runs) {
    if (run.station != station) continue;
    text += fmt::format("{}{}{} {}", text.empty() ? "" : ", ", machine.tools[run.tool].name,
                        run.part.empty() ? "" : " " + run.part, 2 * run.positions.size());
  }
  return text;
}

/// Stations of a campaign, or places of centre balls, whichever the plan has.
std::set<std::string> places_of(const Campaign& campaign, const InstrumentWords& words) {
  std::set<std::string> places;
  for (const Setup& setup : campaign.setups) {
    const PlanInstrument* instrument = find_plan_instrument(setup.instrument);
    if (instrument == nullptr || instrument->words().place != words.place) continue;
    if (const auto place = instrument->place_of(setup, campaign.machine)) places.insert(place->name);
  }
  return places;
}

/// What the plan takes of the axes that its instrument does not measure.
std::string assumed_of_axes(const CampaignPlan& plan) {
  if (plan.settings.linear_axes_known)
    return "linear axes: known, by a campaign of their own (with --model or --extend they are unknowns)\n";
  const bool turns = plan_instrument_of(plan.settings).turns_rotary_axes();
  const std::vector<RotaryStretch> rotary = rotary_stretches(plan.settings.machine);
  if (turns || rotary.empty() || !moving_rotary_axes(plan.plan.campaign).empty()) return "";
  std::string letters;
  for (const RotaryStretch& each : rotary)
    letters += (letters.empty() ? "" : ", ") + std::string(1, letter_of(each.axis));
  return "rotary axes " + letters +
         " stand at home; their errors: --instrument r-test, ball-bar-rotary or laser-tracer-rotary\n";
}

/// What holds for a campaign on a compensated machine (ISO/TR 16907:2015, 11.3).
std::string verification_words(const CampaignPlan& plan) {
  if (plan.settings.apart_from == nullptr) return "";
  return "verifies: at other places and positions than the campaign given (ISO/TR 16907, 11.3)\n"
         "  the control must know the offset of the tool, where L-ANG, L-VOL, R-ANG or R-VOL is active\n"
         "  angles measured directly stay as they were: linear axes correct what rotations do, not "
         "rotations\n"
         "  judge it: volcal validate RESULT measured/campaign.toml --tables TABLES\n";
}

std::string plan_head(const CampaignPlan& plan) {
  const PlanSettings& settings = plan.settings;
  const PlanBudget& budget = settings.budget;
  std::string text = fmt::format("{} ({})\n", settings.machine.name, settings.machine.structure.code);
  text += fmt::format("minimised: {}\n", target_words(settings));
  text += fmt::format("budget: {} {}{} of {}", budget.stations, settings.existing ? "further " : "",
                      words_of(plan).places, settings.instrument);
  if (settings.bar.length > 0.0) text += " " + bar_words(settings.bar);
  if (budget.readings) text += fmt::format(", {} readings", count_number(*budget.readings));
  if (budget.time) text += fmt::format(", {} h", hours(*budget.time));
  if (const std::size_t values = values_of_a_reading(settings); values > 1)
    text += fmt::format("; a reading is {} values, which the campaigns below count one by one", values);
  text += "\n" + assumed_of_axes(plan) + verification_words(plan);
  return text;
}

std::string layout_table(const CampaignPlan& plan) {
  const PlanLayout& layout = plan.searched.layout;
  const InstrumentWords words = words_of(plan);
  TextTable table({{words.place, Align::Left},
                   {"x [mm]"},
                   {"y [mm]"},
                   {"z [mm]"},
                   {"may be off [mm]"},
                   {"readings by tool", Align::Left}},
                  words.heading);
  for (std::size_t i = 0; i < layout.stations_w.size(); ++i) {
    const Eigen::Vector3d at = layout.stations_w[i] * kPerMilli;
    const bool known = i < plan.searched.station_tolerance.size();
    table.add_row({layout.station_names[i], fixed_number(at.x(), 0), fixed_number(at.y(), 0),
                   fixed_number(at.z(), 0), known ? tolerance_text(plan.searched.station_tolerance[i]) : "-",
                   readings_by_tool(layout, i, plan.settings.machine)});
  }
  std::string text = table.text();
  if (!plan.searched.as_good_w.empty()) {
    std::vector<std::string> places;
    for (const Eigen::Vector3d& at : plan.searched.as_good_w) {
      places.push_back(fmt::format("[{:.0f}, {:.0f}, {:.0f}]", at.x() * kPerMilli, at.y() * kPerMilli,
                                   at.z() * kPerMilli));
    }
    text += fmt::format("  as good within {:.1f} %: {} mm\n",
                        std::max(0.1, 100.0 * (plan.searched.as_good_ratio - 1.0)), joined_words(places));
  }
  return text;
}

std::string figures_table(const CampaignPlan& plan) {
  const InstrumentWords words = words_of(plan);
  TextTable table({{"campaign", Align::Left},
                   {words.places},
                   {"setups"},
                   {"readings"},
                   {"time [h]"},
                   {"u volume, RMS [um]"},
                   {"largest [um]"},
                   {"worst length in tables [um]"},
                   {"worst angle [urad]"},
                   {"not visible", Align::Left}},
                  "What it would tell (standard uncertainties)");
  for (const ExpectedCampaign* each : compared(plan)) {
    const std::vector<std::string> hidden = names_of(each->invisible());
    table.add_row({each->name, count_number(static_cast<long long>(places_of(each->campaign, words).size())),
                   count_number(static_cast<long long>(each->campaign.setups.size())),
                   count_number(static_cast<long long>(each->campaign.reading_count())),
                   hours(each->duration), fixed_number(each->volumetric.rms * kPerMicro, 3),
                   fixed_number(each->volumetric.largest * kPerMicro, 3),
                   fixed_number(each->worst_length * kPerMicro, 3),
                   fixed_number(each->worst_angle * kPerMicro, 3),
                   hidden.empty() ? "-" : joined_words(hidden)});
  }
  return table.text();
}

const Observability* error_of(const ExpectedCampaign& campaign, const MachineError& symbol) {
  for (const Observability& error : campaign.result.rank.errors) {
    if (error.symbol == symbol) return &error;
  }
  return nullptr;
}

std::string planned_errors_table(const CampaignPlan& plan) {
  std::vector<TextColumn> columns = {{"error", Align::Left}, {"unit", Align::Left}};
  const std::vector<const ExpectedCampaign*> all = compared(plan);
  for (const ExpectedCampaign* each : all) columns.push_back({"U95 " + each->name});
  columns.push_back({"less by [%]"});
  columns.push_back({"visible fraction"});
  columns.push_back({"effective parameters"});
  TextTable table(columns,
                  fmt::format("Every error: U95 = {} u, root mean square over the travel; visible fraction "
                              "(share of its signal that nothing else imitates) and effective parameters "
                              "with the plan",
                              kCoverageFactor));
  for (const Observability& error : plan.plan.result.rank.errors) {
    const ErrorUnit unit = unit_of(plan.plan.result, error.symbol);
    std::vector<std::string> cells = {error.symbol.name(), unit.name};
    for (const ExpectedCampaign* each : all) {
      const Observability* own = error_of(*each, error.symbol);
      cells.push_back(own == nullptr  ? "-"
                      : !own->visible ? "not visible"
                                      : fixed_number(kCoverageFactor * own->u_rms / unit.si_per_unit, 3));
    }
    const Observability* before = error_of(*all[1], error.symbol);
    const bool both = before != nullptr && before->visible && error.visible;
    cells.push_back(both ? fixed_number(100.0 * (1.0 - error.u_rms / before->u_rms), 1) : "-");
    cells.push_back(fixed_number(error.visible_fraction, 3));
    cells.push_back(fixed_number(error.effective_parameters, 1));
    table.add_row(cells);
  }
  return table.text();
}

std::string planned_effects_table(const CampaignPlan& plan) {
  TextTable table({{"effect", Align::Left},
                   {"effects"},
                   {"not visible"},
                   {"MDB, easiest"},
                   {"hardest"},
                   {"unit", Align::Left},
                   {"hardest one", Align::Left}},
                  "Smallest amplitudes that would be found (80 % power, 0.5 % risk over the catalogue); all "
                  "in plan.json");
  for (const report::DetectableGroup& group : report::detectable_groups(plan.plan.detectable)) {
    const auto cell = [&](const DetectableEffect* effect) {
      return effect == nullptr ? "-" : short_number(effect->mdb / group.si_per_unit, 3);
    };
    table.add_row({group.kind, count_number(static_cast<long long>(group.effects)),
                   count_number(static_cast<long long>(group.not_visible)), cell(group.easiest),
                   cell(group.hardest), group.unit, group.hardest == nullptr ? "-" : group.hardest->label});
  }
  return table.text();
}

std::string invisible_text(const CampaignPlan& plan) {
  std::string text;
  for (const std::string& sentence : sentences(plan.plan.result.rank.invisible))
    text += "  " + sentence + "\n";
  return text.empty() ? "" : "\nWhat this budget cannot determine\n" + text;
}

std::string options_table(const CampaignPlan& plan) {
  TextTable table({{"one setup more", Align::Left},
                   {"readings"},
                   {"u volume, RMS [um]"},
                   {"makes visible", Align::Left},
                   {"still not visible", Align::Left}},
                  "What one setup more would bring, best first: fewest errors not visible, then the least " +
                      target_words(plan.settings));
  for (const PlanOption& option : plan.options) {
    table.add_row({sentence(option.what), count_number(static_cast<long long>(option.readings)),
                   fixed_number(option.volumetric_rms * kPerMicro, 3),
                   option.made_visible.empty() ? "-" : joined_words(names_of(option.made_visible)),
                   option.still_invisible.empty() ? "-" : joined_words(names_of(option.still_invisible))});
  }
  return table.empty() ? "" : "\n" + table.text();
}

std::string verdict(const CampaignPlan& plan) {
  if (plan.settings.apart_from != nullptr) return "";  // it adds to a campaign, and is no measure alone
  if (plan.replaced) return replaced_words(plan) + "\n";
  const double ratio = target_ratio(plan);
  const std::string other = plan.settings.existing != nullptr ? "what there is" : "the textbook layout";
  return fmt::format("Against {}: {} {:.1f} % {}\n", other, target_words(plan.settings),
                     100.0 * std::abs(1.0 - ratio), ratio <= 1.0 ? "less" : "more");
}

}  // namespace

std::size_t values_of_a_reading(const PlanSettings& settings) {
  const Eigen::Vector3d place = Eigen::Vector3d::Zero(), point = Eigen::Vector3d::UnitX();
  return plan_instrument_of(settings).nominal_reading(place, point).size();
}

std::string target_words(const PlanSettings& settings) {
  switch (settings.target) {
    case PlanTarget::Volumetric:
      return "volumetric uncertainty, RMS of the vector";
    case PlanTarget::Worst:
      return "largest uncertainty of a table value, rotations by their lever";
    case PlanTarget::Symbol:
      return "uncertainty of " + settings.symbol.name();
    case PlanTarget::Separate:
      break;
  }
  std::vector<std::string> names;
  for (const EffectSpec& effect : settings.separate)
    names.push_back(full_name(find_effect(effect.kind)->make(effect, {})->name()));
  return "amplitude at which " + joined_words(names) + " are separated";
}

const ExpectedCampaign& compared_with(const CampaignPlan& plan) {
  return plan.settings.existing != nullptr ? *plan.given : plan.textbook;
}

double target_ratio(const CampaignPlan& plan) {
  const bool by_search =
      plan.settings.target == PlanTarget::Separate || plan.settings.target == PlanTarget::Worst;
  if (by_search && plan.searched.textbook > 0.0)
    return std::sqrt(plan.searched.value / plan.searched.textbook);
  return plan.plan.target_u / compared_with(plan).target_u;
}

std::string replaced_words(const CampaignPlan& plan) {
  if (!plan.replaced) return "";
  const double ratio = plan.replaced->target_ratio;
  std::string text =
      fmt::format("The plan is the textbook layout. What the search found: {}, {:.1f} % {}",
                  target_words(plan.settings), 100.0 * std::abs(1.0 - ratio), ratio >= 1.0 ? "more" : "less");
  if (plan.replaced->invisible.size() > plan.plan.invisible().size())
    text += "; " + joined_words(names_of(plan.replaced->invisible)) + " not determined";
  return text + ".";
}

std::string plan_text(const CampaignPlan& plan) {
  return plan_head(plan) + "\n" + layout_table(plan) + "\n" + figures_table(plan) + "\n" + verdict(plan) +
         "\n" + planned_errors_table(plan) + "\n" + planned_effects_table(plan) + invisible_text(plan) +
         options_table(plan) + findings_text(plan.findings) + findings_text(plan.notes);
}

}  // namespace volcal
