/// A plan in space: volume, stations, positions by tool, beams; what it costs and tells beside the textbook's
/// layout.

#include <algorithm>
#include <cmath>

#include "volcal/identify/planning/line_of_sight.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/planning/rotary_positions.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/text/plan_text.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal::report {
namespace {

constexpr std::size_t kBeamsOfSetup = 14;
constexpr std::size_t kPointsOfPlan = 4000;

Json corners_json(const Eigen::AlignedBox3d& box) {
  Json corners = Json::array();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d share(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    corners.push_back(rounded_vector(box.min() + share.cwiseProduct(box.sizes()), kPerMilli, 6));
  }
  return corners;
}

/// Positions of the rotary axes that the plan turns, deg, of the pass there.
Json rotary_positions_json(const Setup& setup, const std::vector<RotaryStretch>& rotary, std::size_t count) {
  Json positions = Json::array();
  const auto moves = [&](const RotaryStretch& each) {
    const auto [low, high] = std::ranges::minmax(setup.readings.position[index_of(each.axis)]);
    return high > low;
  };
  if (setup.readings.size() == 0 || std::ranges::none_of(rotary, moves)) return positions;
  for (std::size_t row = 0; row < count; ++row) {
    Json at = Json::array();
    for (const RotaryStretch& each : rotary)
      at.push_back(rounded(setup.readings.position[index_of(each.axis)][row] / kRadianPerDegree, 5));
    positions.push_back(std::move(at));
  }
  return positions;
}

/// First readings of every position: the pass there.
Json planned_setup_json(const Setup& setup, const Machine& machine, const KinematicChain& chain,
                        std::size_t most) {
  Json points = Json::array(), beams = Json::array();
  const Readings& readings = setup.readings;
  const bool both = !readings.run.empty() && readings.run.back() == 1;
  const std::size_t count = both ? readings.size() / 2 : readings.size();
  const std::size_t step = std::max<std::size_t>(1, (count + most - 1) / most);
  const std::size_t beam_step = std::max<std::size_t>(1, count / kBeamsOfSetup);
  for (std::size_t row = 0; row < count; row += 1) {
    if (row % step != 0 && row % beam_step != 0) continue;
    AxisPosition position{};
    for (const Axis& axis : machine.axes)
      position[index_of(axis.name)] = readings.position[index_of(axis.name)][row];
    const Json point =
        rounded_vector(chain.nominal_point_w(position, machine.tools[setup.tool].offset), kPerMilli, 6);
    if (row % step == 0) points.push_back(point);
    if (row % beam_step == 0) beams.push_back(point);
  }
  const std::string& tool = machine.tools[setup.tool].name;
  const PlanInstrument* instrument = find_plan_instrument(setup.instrument);
  const auto place = instrument != nullptr ? instrument->place_of(setup, machine) : std::nullopt;
  return {{"name", setup.name},
          {"station", place ? place->name : ""},
          {"station_mm", place ? rounded_vector(place->place_w, kPerMilli, 6) : Json(nullptr)},
          {"tool", tool},
          {"part", place ? place->part : ""},
          {"instrument", setup.instrument},
          {"readings", readings.size()},
          {"point_mm", std::move(points)},
          {"beam_mm", std::move(beams)},
          {"rotary_deg", rotary_positions_json(setup, rotary_stretches(machine), std::min(count, most))}};
}

Json campaign_of_page(const ExpectedCampaign& expected, const CampaignPlan& plan) {
  const KinematicChain chain(expected.campaign.machine);
  const std::size_t most =
      std::max<std::size_t>(10, kPointsOfPlan / std::max<std::size_t>(1, expected.campaign.setups.size()));
  Json setups = Json::array();
  for (const Setup& setup : expected.campaign.setups)
    setups.push_back(planned_setup_json(setup, expected.campaign.machine, chain, most));
  Json tolerance = Json::object();
  const SearchedPlan& searched = plan.searched;
  for (std::size_t i = 0; &expected == &plan.plan && i < searched.station_tolerance.size(); ++i) {
    tolerance[searched.layout.station_names[i]] = rounded(searched.station_tolerance[i] * kPerMilli, 4);
  }
  return {{"name", expected.name},
          {"setups", std::move(setups)},
          {"readings", expected.campaign.reading_count()},
          {"time_h", rounded(expected.duration / kSecondsPerHour, 3)},
          {"u_rms_um", rounded(expected.volumetric.rms * kPerMicro, 4)},
          {"u_largest_um", rounded(expected.volumetric.largest * kPerMicro, 4)},
          {"worst_length_um", rounded(expected.worst_length * kPerMicro, 3)},
          {"worst_length_at", expected.worst_length_at},
          {"worst_angle_urad", rounded(expected.worst_angle * kPerMicro, 3)},
          {"worst_angle_at", expected.worst_angle_at},
          {"not_visible", names_of(expected.invisible())},
          {"may_be_off_mm", std::move(tolerance)}};
}

}  // namespace

Json plan_layout_page(const PlanPageInput& input) {
  const CampaignPlan& plan = input.plan;
  const LineOfSight sight(plan.settings);
  Json campaigns = Json::array();
  campaigns.push_back(campaign_of_page(plan.plan, plan));
  if (plan.settings.existing == nullptr) campaigns.push_back(campaign_of_page(plan.textbook, plan));
  if (plan.given) campaigns.push_back(campaign_of_page(*plan.given, plan));
  Json options = Json::array();
  for (const PlanOption& option : plan.options) {
    options.push_back({{"words", sentence(option.what)},
                       {"readings", option.readings},
                       {"u_um", rounded(option.volumetric_rms * kPerMicro, 4)},
                       {"made_visible", names_of(option.made_visible)},
                       {"still_invisible", names_of(option.still_invisible)}});
  }
  const InstrumentWords words = sight.instrument().words();
  Json rotary = Json::array();
  for (const RotaryStretch& each : rotary_stretches(plan.settings.machine))
    rotary.push_back(std::string(1, letter_of(each.axis)));
  return {{"rotary_axes", std::move(rotary)},
          {"place", words.place},
          {"places", words.places},
          {"heading", words.heading},
          {"region", words.region},
          {"checked", words.checked},
          {"values_a_reading", values_of_a_reading(plan.settings)},
          {"target", target_words(plan.settings)},
          {"ratio", rounded(target_ratio(plan), 4)},
          {"against", compared_with(plan).name},
          {"replaced", replaced_words(plan)},
          {"volume_mm", corners_json(sight.swept_w())},
          {"region_mm", corners_json(sight.stations_w())},
          {"campaigns", std::move(campaigns)},
          {"invisible", sentences(plan.plan.result.rank.invisible)},
          {"messages", sentences(plan.findings)},
          {"options", std::move(options)}};
}

}  // namespace volcal::report
