// Another tool at a station: what acts on the tool's point, on the beam's length or on rotations changes its
// share.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

constexpr double kLonger = 2.0;         // times the longest tool
constexpr double kLeastLength = 0.1;    // m, below which a tool says nothing about rotations
constexpr double kUsualLength = 0.3;    // m
constexpr double kSidewaysShare = 0.3;  // of the length: makes the roll of the last axis visible

double length_of_tool(const Tool& tool) { return tool.offset.norm(); }

/// Twice the longest tool, and to the side.
Tool longer_tool(const Machine& machine) {
  Tool longest = *std::ranges::max_element(machine.tools, {}, length_of_tool);
  if (length_of_tool(longest) < kLeastLength) longest.offset = {0.0, 0.0, -kUsualLength / kLonger};
  Tool tool = longest;
  tool.offset = kLonger * longest.offset;
  tool.offset.x() += kSidewaysShare * length_of_tool(longest);
  tool.name = fmt::format("of [{:.0f}, {:.0f}, {:.0f}] mm", tool.offset.x() * kPerMilli,
                          tool.offset.y() * kPerMilli, tool.offset.z() * kPerMilli);
  return tool;
}

ExtraMeasurement with_tool(const CandidateContext& context, const Setup& setup, std::size_t tool,
                           const std::string& name) {
  ExtraMeasurement extra = taken_again(context, setup, setup.name + " with tool " + name,
                                       fmt::format("measure at {} with tool {}", place_name(setup), name));
  extra.setups.front().tool = tool;
  return extra;
}

}  // namespace

/// Every tool of the machine that a station has not seen, and a longer one.
std::vector<ExtraMeasurement> second_tools(const CandidateContext& context) {
  const Campaign& campaign = context.campaign;
  const auto& tools = campaign.machine.tools;
  std::vector<ExtraMeasurement> all;
  for (const Setup* setup : one_setup_per_station(campaign)) {
    if (station_of(*setup).empty()) continue;
    std::set<std::size_t> seen;
    for (const Setup& each : campaign.setups) {
      if (station_of(each) == station_of(*setup)) seen.insert(each.tool);
    }
    for (std::size_t tool = 0; tool < tools.size(); ++tool) {
      if (!seen.contains(tool)) all.push_back(with_tool(context, *setup, tool, tools[tool].name));
    }
    const Tool longer = longer_tool(campaign.machine);
    all.push_back(with_tool(context, *setup, tools.size(), longer.name));
    all.back().tools.push_back(longer);
  }
  return all;
}

}  // namespace volcal
