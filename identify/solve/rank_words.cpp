#include "volcal/identify/solve/rank_words.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <utility>

#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/tool_tips.h"

namespace volcal {
namespace {

bool axis_moves(const Campaign& campaign, AxisName axis) {
  const MeasuredRange range = measured_range(campaign, axis);
  return range.max - range.min > 1e-3 * campaign.machine.axis(axis).travel();
}

/// Tools in use, as offsets across direction `k`.
double largest_sideways_offset(const Campaign& campaign, int k) {
  double largest = 0.0;
  for (const Setup& setup : campaign.setups) {
    Eigen::Vector3d offset = campaign.machine.tools[setup.tool].offset;
    offset[k] = 0.0;
    largest = std::max(largest, offset.norm());
  }
  return largest;
}

std::set<std::string> stations(const ParameterLayout& layout) {
  std::set<std::string> names;
  for (const ParameterBlock& block : layout.blocks) {
    if (block.name.starts_with("station ")) names.insert(block.name);
  }
  return names;
}

std::size_t tools_in_use(const Campaign& campaign) {
  std::set<std::size_t> tools;
  for (const Setup& setup : campaign.setups) tools.insert(setup.tool);
  return tools.size();
}

/// The axis of an error function whose readings stand at one or two positions of it.
std::optional<AxisName> axis_at_few_positions(const Campaign& campaign, const std::string& name) {
  const auto symbol = ErrorSymbol::parse(name);
  if (!symbol || automatic_intervals(campaign, symbol->axis) > 1) return std::nullopt;
  return symbol->axis;
}

}  // namespace

std::string list_in_words(const std::vector<std::string>& words) {
  std::ostringstream text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    text << (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") << words[i];
  }
  return text.str();
}

std::string straightness_beside(const std::string& name) {
  const auto axis = turned_axis(name);
  if (!axis) return "";
  const int across = 3 - direction_of(LocationSymbol::parse(name)->component) - direction_of(*axis);
  return ErrorSymbol{kAllComponents[static_cast<std::size_t>(across)], *axis}.name();
}

std::optional<Explanation> explain_standing(const Campaign& campaign, const std::string& name) {
  const auto symbol = ErrorSymbol::parse(name);
  const auto moving = symbol ? std::optional(symbol->axis) : turned_axis(name);
  if (!moving || axis_moves(campaign, *moving)) return std::nullopt;
  const std::string axis(1, letter_of(*moving));
  return Explanation{"axis " + axis + " does not move in this campaign", "measure along axis " + axis};
}

Explanation explain_unseen(const Campaign& campaign, const std::string& name) {
  const auto symbol = ErrorSymbol::parse(name);
  if (symbol && is_rotation(symbol->component)) {
    const int k = direction_of(symbol->component);
    const std::string about(1, "XYZ"[k]);
    if (largest_sideways_offset(campaign, k) < 1e-3) {
      return {"every tool offset lies on " + about,
              "add setups with a tool offset sideways to " + about + " (100 mm or more)"};
    }
    return {"no reading has a lever arm about " + about,
            "add setups with another tool offset, or an angle instrument about " + about};
  }
  const bool location = LocationSymbol::parse(name).has_value();
  const std::string off = symbol     ? " ([functions] " + name + " = { basis = \"zero\" })"
                          : location ? " ([locations] " + name + " = \"zero\")"
                                     : "";
  return {"no reading changes when it changes",
          "add readings that are sensitive to it, or switch it off in the model" + off};
}

Explanation explain_few_positions(AxisName axis) {
  const std::string name(1, letter_of(axis));
  return {"the readings stand at too few positions of axis " + name + " to tell its course between them",
          "add positions along axis " + name};
}

std::string remedy_for_mixture(const MeasurementModel& model, const std::string& error,
                               const std::vector<std::string>& partners) {
  const auto is_nuisance = [&](const std::string& name) {
    const ParameterBlock* block = model.layout().find_block(name);
    return block != nullptr && !block->location && block->kind != ParameterKind::Effect;
  };
  const std::size_t station_count = stations(model.layout()).size();
  std::vector<std::string> remedies;
  if (const auto axis = axis_at_few_positions(model.campaign(), error))
    remedies.push_back(std::string("add positions along axis ") + letter_of(*axis));
  if (station_count > 0 && station_count < 3)
    remedies.emplace_back("measure from more stations (four, well apart)");
  if (tools_in_use(model.campaign()) < 2)
    remedies.emplace_back("repeat with a second tool offset, sideways and of another length");
  if (std::string tool = third_tool(model.campaign(), error, partners); !tool.empty())
    remedies.push_back(std::move(tool));
  if (station_count == 0 && std::ranges::any_of(partners, is_nuisance)) {
    remedies.emplace_back(
        "add an instrument that holds position or direction over the whole travel (tracer, straightness, "
        "square)");
  }
  if (remedies.empty())
    remedies.emplace_back("add lines at other offsets, straightness or angle readings that tell them apart");
  return list_in_words(remedies);
}

}  // namespace volcal
