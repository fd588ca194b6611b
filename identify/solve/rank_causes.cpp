#include "volcal/identify/solve/rank_causes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <utility>

#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/tool_tips.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/description/rotary_places.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

std::string letter(AxisName axis) { return std::string(1, letter_of(axis)); }

constexpr double kLeastApart = 1e-3;  // of the travel
constexpr double kPiecesOfAGap = 2.0;
constexpr double kMostOfTravel = 0.9;

bool axis_moves(const Campaign& campaign, AxisName axis) {
  const MeasuredRange range = measured_range(campaign, axis);
  return range.max - range.min > 1e-3 * campaign.machine.axis(axis).travel();
}

/// Of tools, as offsets across direction `k`.
double largest_sideways_offset(const Machine& machine, const std::set<std::size_t>& tools, int k) {
  double largest = 0.0;
  for (const std::size_t tool : tools) {
    Eigen::Vector3d offset = machine.tools[tool].offset;
    offset[k] = 0.0;
    largest = std::max(largest, offset.norm());
  }
  return largest;
}

std::set<std::string> stations(const ParameterLayout& layout) {
  std::set<std::string> names;
  for (const ParameterBlock& block : layout.blocks) {
    const auto point = named_point(block.name);
    if (point && point->kind == NamedPoint::Kind::Station) names.insert(point->name);
  }
  return names;
}

std::size_t tools_in_use(const Campaign& campaign) {
  std::set<std::size_t> tools;
  for (const Setup& setup : campaign.setups) tools.insert(setup.tool);
  return tools.size();
}

/// For a function of so many unknowns: no more than these, or none over a stretch of two of its pieces.
bool are_too_few(const std::vector<double>& positions, int unknowns) {
  if (static_cast<int>(positions.size()) <= unknowns) return true;
  double gap = 0.0;
  for (std::size_t i = 1; i < positions.size(); ++i) gap = std::max(gap, positions[i] - positions[i - 1]);
  return gap > kPiecesOfAGap * (positions.back() - positions.front()) / unknowns;
}

/// The axis of an error function whose readings stand at one or two positions of it.
std::optional<AxisName> axis_at_few_positions(const Campaign& campaign, const MachineError& error) {
  const auto symbol = error.motion();
  if (!symbol || automatic_intervals(campaign, symbol->axis) > 1) return std::nullopt;
  return symbol->axis;
}

constexpr double kOnAxis = 1e-3;        // m
constexpr double kSidewaysTool = 0.06;  // m
constexpr double kTurned = 1e-3;        // rad, from home
constexpr std::size_t kEnoughSpheres = 3;
constexpr double kTogether = 0.99;  // of the square of the correlation of two positions

std::optional<AxisName> rotary_axis_of(const MachineError& error) {
  const auto axis = error.axis();
  return axis && is_rotary(*axis) ? axis : std::nullopt;
}

bool is_of_linear_axis(const MachineError& error) {
  const auto axis = error.axis();
  return axis && !is_rotary(*axis);
}

/// Does some reading stand with two rotary axes turned away from home?
bool turns_two_at_once(const Campaign& campaign, const std::vector<AxisName>& moving) {
  for (const Setup& setup : campaign.setups) {
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      const auto turned = std::ranges::count_if(moving, [&](AxisName axis) {
        const double from_home =
            setup.readings.position[index_of(axis)][row] - campaign.machine.axis(axis).home;
        return std::abs(from_home) > kTurned;
      });
      if (turned > 1) return true;
    }
  }
  return false;
}

/// The axis with the same direction as that of an error among its partners.
std::optional<AxisName> axis_beside(const MachineError& error, const std::vector<MachineError>& partners) {
  const auto own = error.axis();
  if (!own || is_rotary(*own)) return std::nullopt;
  for (const MachineError& partner : partners) {
    const auto other = partner.axis();
    if (other && !is_rotary(*other) && *other != *own && main_axis_of(*other) == main_axis_of(*own))
      return other;
  }
  return std::nullopt;
}

/// Whether the position of one axis follows from that of the other, as a straight line, in all readings.
bool move_together(const Campaign& campaign, AxisName first, AxisName second) {
  double count = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (const Setup& setup : campaign.setups) {
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      const Eigen::Vector2d at(
          setup.readings.position[index_of(first)][row] - campaign.machine.axis(first).home,
          setup.readings.position[index_of(second)][row] - campaign.machine.axis(second).home);
      count += 1.0;
      sum += at;
      squares += at * at.transpose();
    }
  }
  const Eigen::Matrix2d spread = squares - sum * sum.transpose() / count;
  const double product = spread(0, 0) * spread(1, 1);
  return product > 0.0 && spread(0, 1) * spread(0, 1) > kTogether * product;
}

std::size_t spheres(const ParameterLayout& layout) {
  return static_cast<std::size_t>(std::ranges::count_if(layout.blocks, [](const ParameterBlock& block) {
    const auto point = named_point(block.name);
    return point && point->kind == NamedPoint::Kind::Sphere;
  }));
}

/// Whether an axis travels less than a turn and was measured over a part of it, with both for the cause: the
/// gauge of its error motions is taken over the travel (rotary_gauge.h).
bool is_measured_in_part(const Campaign& campaign, AxisName axis, Finding& cause) {
  const Axis& own = campaign.machine.axis(axis);
  const MeasuredRange range = measured_range(campaign, axis);
  if (own.travels_a_turn() || range.max - range.min >= kMostOfTravel * own.travel()) return false;
  cause.data["partly"] = letter(axis);
  for (const auto& [key, value] :
       {std::pair("from", range.min), std::pair("to", range.max), std::pair("travel_from", own.travel_min),
        std::pair("travel_to", own.travel_max)})
    cause.data[key] = FindingNumber{value, "deg", kRadianPerDegree};
  return true;
}

/// What tells errors of rotary axes apart: poses of both, places on the table, tools to the side. Of tools
/// those count that the axis moves; `cause` tells where others are in use.
std::vector<std::string> rotary_remedies(const MeasurementModel& model, AxisName axis, Finding& cause) {
  const Campaign& campaign = model.campaign();
  std::vector<std::string> remedies;
  if (is_measured_in_part(campaign, axis, cause)) remedies.emplace_back("measured-travel");
  const std::vector<AxisName> moving = moving_rotary_axes(campaign);
  if (moving.size() > 1 && !turns_two_at_once(campaign, moving)) remedies.emplace_back("combined-poses");
  const std::size_t sphere_count = spheres(model.layout());
  if (sphere_count > 0 && sphere_count < kEnoughSpheres) remedies.emplace_back("spheres");
  const std::set<std::size_t> tools = tools_moved_by(campaign, axis);
  if (tools.size() < 2) remedies.emplace_back("second-tool");
  if (largest_sideways_offset(campaign.machine, tools, direction_of(AxisName::Z)) < kSidewaysTool)
    remedies.emplace_back("mandrel");
  if (tools.size() < tools_in_use(campaign)) cause.data["turning"] = letter(axis);
  return remedies;
}

}  // namespace

std::vector<double> different_positions(const Campaign& campaign, AxisName axis) {
  const double same = kLeastApart * campaign.machine.axis(axis).travel();
  std::vector<double> different;
  for (const double position : used_positions(campaign, axis)) {
    if (different.empty() || position - different.back() > same) different.push_back(position);
  }
  return different;
}

std::optional<ErrorSymbol> straightness_beside(const MachineError& error) {
  const auto axis = turned_axis(error);
  if (!axis) return std::nullopt;
  const int across = 3 - direction_of(*error.component()) - direction_of(*axis);
  return ErrorSymbol{kAllComponents[static_cast<std::size_t>(across)], *axis};
}

std::optional<Finding> cause_of_standing(const Campaign& campaign, const MachineError& error) {
  const auto moving = error.motion() ? error.axis() : turned_axis(error);
  if (!moving || axis_moves(campaign, *moving)) return std::nullopt;
  return Finding{FindingCode::NotVisibleAxisAtRest, {{"error", error.name()}, {"axis", letter(*moving)}}};
}

Finding cause_of_unseen(const Campaign& campaign, const MachineError& error) {
  const auto symbol = error.motion();
  if (symbol && is_rotation(symbol->component)) {
    const int k = direction_of(symbol->component);
    const bool on_table =
        is_rotary(symbol->axis) && campaign.machine.structure.is_on_workpiece_side(symbol->axis);
    const double sideways =
        largest_sideways_offset(campaign.machine, tools_moved_by(campaign, symbol->axis), k);
    const bool on_axis = !on_table && sideways < kOnAxis;
    Finding cause{on_axis ? FindingCode::NotVisibleToolsOnOneAxis : FindingCode::NotVisibleNoLeverArm,
                  {{"error", error.name()}, {"about", std::string(1, "XYZ"[k])}}};
    if (on_table) cause.data["table"] = letter(symbol->axis);
    return cause;
  }
  Finding cause{FindingCode::NotVisibleNoReadingChanges, {{"error", error.name()}}};
  if (symbol) {
    cause.data["switch"] = "functions";
  } else if (error.location()) {
    cause.data["switch"] = "locations";
  }
  return cause;
}

Finding cause_of_open_course(const MeasurementModel& model, ErrorSymbol symbol, int unknowns) {
  const FunctionSpec& function = model.spec().function(symbol);
  const bool repeats = is_rotary(symbol.axis) && function.basis == "fourier";
  const std::vector<double> positions = repeats ? places_in_turn(model.campaign(), symbol.axis)
                                                : different_positions(model.campaign(), symbol.axis);
  if (!are_too_few(positions, unknowns))
    return {FindingCode::NotVisibleReadingsTooFew, {{"error", symbol.name()}}};
  Finding cause{FindingCode::NotVisibleFewPositions,
                {{"error", symbol.name()}, {"axis", letter(symbol.axis)}}};
  if (!repeats) return cause;
  cause.data["positions"] = static_cast<std::int64_t>(positions.size());
  cause.data["told"] = static_cast<std::int64_t>(most_periods(positions));
  cause.data["harmonics"] = static_cast<std::int64_t>(function.degree);
  if (const int parts = regular_parts(positions); parts > 0)
    cause.data["spacing"] = FindingNumber{2.0 * std::numbers::pi / parts, "deg", kRadianPerDegree};
  return cause;
}

Finding cause_like_straightness(const MachineError& squareness, ErrorSymbol straightness) {
  return {FindingCode::NotVisibleLikeStraightness,
          {{"error", squareness.name()},
           {"axis", letter(straightness.axis)},
           {"straightness", straightness.name()}}};
}

Finding cause_exchangeable(const MeasurementModel& model, const MachineError& error,
                           const std::vector<MachineError>& partners) {
  const auto is_nuisance = [&](const MachineError& partner) {
    const ParameterBlock* block = model.layout().find_block(partner);
    return block != nullptr && !block->location && block->kind != ParameterKind::Effect;
  };
  Finding cause{FindingCode::NotVisibleExchangeable, {{"error", error.name()}}};
  const std::size_t station_count = stations(model.layout()).size();
  std::vector<std::string> remedies;
  if (const auto axis = axis_at_few_positions(model.campaign(), error)) {
    remedies.emplace_back("positions");
    cause.data["axis"] = letter(*axis);
  }
  if (const auto beside = axis_beside(error, partners)) {
    const AxisName main = main_axis_of(*beside);
    const AxisName parallel =
        is_parallel(*beside) ? *beside : kParallelAxes[static_cast<std::size_t>(direction_of(main))];
    if (move_together(model.campaign(), main, parallel)) {
      remedies.emplace_back("one-axis-standing");
      cause.data["standing"] = letter(main);
      cause.data["moving"] = letter(parallel);
    }
  }
  if (station_count > 0 && station_count < 3) remedies.emplace_back("stations");
  if (const auto rotary = rotary_axis_of(error)) {
    if (station_count == 0 && std::ranges::any_of(partners, is_of_linear_axis))
      remedies.emplace_back("linear-axes");
    for (std::string& remedy : rotary_remedies(model, *rotary, cause)) remedies.push_back(std::move(remedy));
  } else if (tools_in_use(model.campaign()) < 2) {
    remedies.emplace_back("second-tool");
  }
  if (const auto across = third_tool_across(model.campaign(), error, partners)) {
    remedies.emplace_back("third-tool");
    cause.data["third_tool_across"] = std::string(1, *across);
  }
  if (station_count == 0 && !cause.has("partly") && std::ranges::any_of(partners, is_nuisance))
    remedies.emplace_back("holding-instrument");
  if (remedies.empty()) remedies.emplace_back("other-lines");
  cause.data["partners"] = names_of(partners);
  cause.data["remedies"] = std::move(remedies);
  return cause;
}

}  // namespace volcal
