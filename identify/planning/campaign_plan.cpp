#include "volcal/identify/planning/campaign_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/numeric/interruption.h"
#include "volcal/identify/planning/expected_effects.h"
#include "volcal/identify/planning/measured_positions.h"
#include "volcal/identify/planning/plan_options.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr int kReportedVolume = 5;  // points per axis

std::string place_of(const ErrorTableRow& row) {
  if (!row.axis) return row.symbol.name();
  const Unit unit = position_unit(*row.axis);
  return fmt::format("{} at {:.0f} {}", row.symbol.name(), row.position / unit.si_per_unit, unit.suffix);
}

void find_worst_values(ExpectedCampaign& expected) {
  for (const ErrorTableRow& row : error_table(expected.result)) {
    double& worst = row.rotation ? expected.worst_angle : expected.worst_length;
    if (row.u <= worst) continue;
    worst = row.u;
    (row.rotation ? expected.worst_angle_at : expected.worst_length_at) = place_of(row);
  }
}

VolumetricUncertainty volume_of(const FitResult& result, const PlanSettings& settings) {
  const std::vector<Tool> tools = own_tools(settings);
  const LineOfSight sight(settings);
  if (!sight.instrument().turns_rotary_axes()) return volumetric_uncertainty(result, tools, kReportedVolume);
  std::vector<std::vector<AxisPosition>> poses;
  for (std::size_t tool = 0; tool < tools.size(); ++tool)
    poses.push_back(sight.volume(tool, kReportedVolume));
  return uncertainty_at_poses(result, tools, poses);
}

double target_uncertainty(const ExpectedCampaign& expected, const PlanSettings& settings) {
  if (settings.target != PlanTarget::Symbol) return expected.volumetric.rms;
  for (const Observability& error : expected.result.rank.errors) {
    if (error.symbol == settings.symbol) return error.u_rms;
  }
  return std::nan("");
}

/// The searches' progress within a share of the whole.
PlanSettings with_share(PlanSettings settings, double from, double share) {
  if (!settings.progress) return settings;
  settings.progress = [whole = settings.progress, from, share](const std::string& stage, double done) {
    whole(stage, from + share * done);
  };
  return settings;
}

/// What one setup more would bring, where an error is not visible.
void find_options(const PlanSettings& settings, CampaignPlan& plan) {
  std::atomic<double> done{0.0};
  PlanSettings adding = settings;
  adding.existing = &plan.plan.campaign;
  adding.progress = [&done](const std::string& /*stage*/, double share) { done = share; };
  try {
    const Interruption guard([&] {
      if (settings.progress) settings.progress(kLookingForOptions, 0.9 + 0.1 * done);
    });
    plan.options = setup_options(adding, plan.plan).options;
  } catch (const OptionsNotWanted&) {
    plan.findings.push_back({FindingCode::PlanOptionsLeft});
  }
}

void tell(const PlanSettings& settings, const std::string& stage, double done) {
  if (settings.progress) settings.progress(stage, done);
}

}  // namespace

std::vector<MachineError> ExpectedCampaign::invisible() const {
  std::vector<MachineError> errors;
  for (const Observability& error : result.rank.errors) {
    if (!error.visible) errors.push_back(error.symbol);
  }
  return errors;
}

ExpectedCampaign expected_campaign(const std::string& name, const Campaign& campaign,
                                   const PlanSettings& settings, bool effects) {
  ExpectedCampaign expected;
  expected.name = name;
  expected.campaign = campaign;
  expected.result = expected_result(campaign, settings.model, settings.roughness, settings.threads);
  expected.volumetric = volume_of(expected.result, settings);
  expected.target_u = target_uncertainty(expected, settings);
  expected.duration = std::nan("");
  find_worst_values(expected);
  if (effects) expected.detectable = expected_detectable(campaign, expected.result, settings.threads);
  return expected;
}

namespace {

/// Of its uncertainty of the target to the textbook's; separation and the worst value are of the criterion.
double ratio_to_textbook(const CampaignPlan& plan) {
  const PlanTarget target = plan.settings.target;
  if ((target == PlanTarget::Separate || target == PlanTarget::Worst) && plan.searched.textbook > 0.0)
    return std::sqrt(plan.searched.value / plan.searched.textbook);
  return plan.plan.target_u / plan.textbook.target_u;
}

}  // namespace

void keep_the_surer(const PlanLayout& textbook, CampaignPlan& plan) {
  const std::vector<MachineError> lacks = plan.plan.invisible();
  const double ratio = ratio_to_textbook(plan);
  const PlanTarget target = plan.settings.target;
  const bool others_count = target == PlanTarget::Volumetric || target == PlanTarget::Worst;
  const bool one_tells_all = lacks.empty() != plan.textbook.invisible().empty();
  const bool is_surer = others_count && one_tells_all ? !lacks.empty() : ratio > 1.0;
  if (!is_surer) return;
  plan.replaced = ReplacedPlan{ratio, lacks};
  plan.plan = plan.textbook;
  plan.plan.name = "plan";
  SearchedPlan kept;
  kept.layout = textbook;
  kept.tools = plan.searched.tools;
  kept.value = kept.textbook = plan.searched.textbook;
  plan.searched = std::move(kept);
}

CampaignPlan plan_campaign(const PlanSettings& given_settings, const Campaign* given) {
  check_plan_settings(given_settings);
  CampaignPlan plan;
  PlanSettings settings = given_settings;
  const Campaign textbook_campaign = campaign_of(textbook_layout(settings, LineOfSight(settings)), settings);
  if (auto held = hold_effects_unseen(textbook_campaign, settings.model))
    plan.findings.push_back(*std::move(held));
  plan.settings = settings;
  PlanSettings searching = with_share(settings, 0.0, 0.8);
  // What verifies is best where the first campaign knows least.
  if (settings.apart_from != nullptr) searching.existing = settings.apart_from;
  const LineOfSight sight(searching);
  const PlanProblem problem(searching);
  plan.searched = search_plan(searching, problem, sight);
  tell(settings, "figures", 0.8);
  plan.plan = expected_campaign("plan", campaign_of(plan.searched.layout, settings), settings, true);
  plan.plan.duration = duration(plan.searched.layout, settings);
  PlanSettings same_tools = settings;
  same_tools.budget.tools = plan.searched.tools;
  const PlanLayout textbook = textbook_layout(same_tools, sight);
  plan.textbook = expected_campaign("textbook", campaign_of(textbook, settings), settings, true);
  plan.textbook.duration = duration(textbook, settings);
  if (settings.apart_from == nullptr && are_apart(textbook.stations_w)) keep_the_surer(textbook, plan);
  if (given != nullptr) plan.given = expected_campaign("given", *given, settings, true);
  if (!plan.plan.invisible().empty()) find_options(settings, plan);
  tell(settings, "done", 1.0);
  return plan;
}

CampaignPlan extend_campaign(const PlanSettings& settings) {
  check_plan_settings(settings);
  CampaignPlan plan;
  plan.settings = settings;
  plan.given = expected_campaign("given", *settings.existing, settings, true);
  Campaign reached = *settings.existing;
  ExpectedCampaign now = *plan.given;
  const int setups = settings.budget.stations;
  const std::size_t readings =
      static_cast<std::size_t>(settings.budget.readings.value_or(0)) / static_cast<std::size_t>(setups);
  for (int setup = 0; setup < setups; ++setup) {
    PlanSettings adding = with_share(plan.settings, 0.9 * setup / setups, 0.9 / setups);
    adding.existing = &reached;
    adding.budget.readings = static_cast<int>(readings);
    tell(adding, "setups", 0.0);
    PlanSettings silent = adding;
    silent.progress = nullptr;
    const SetupOptions found = setup_options(silent, now);
    if (found.options.empty()) break;
    if (plan.options.empty()) plan.options = found.options;
    plan.settings.machine = found.machine;
    plan.settings.hypothetical_tools = found.hypothetical_tools;
    adding.machine = found.machine;
    adding.hypothetical_tools = found.hypothetical_tools;
    reached.machine = found.machine;
    PlanLayout added = with_chosen_positions(adding, found.best);
    now = expected_campaign("plan", campaign_of(added, adding), plan.settings, false);
    const ExpectedCampaign even =
        expected_campaign("plan", campaign_of(found.best, adding), plan.settings, false);
    if (even.invisible().size() < now.invisible().size()) {
      added = found.best;
      now = even;
    }
    append(added, plan.searched.layout);
    reached = now.campaign;
  }
  plan.plan = expected_campaign("plan", reached, plan.settings, true);
  plan.plan.duration = duration(plan.searched.layout, plan.settings);
  tell(settings, "done", 1.0);
  return plan;
}

}  // namespace volcal
