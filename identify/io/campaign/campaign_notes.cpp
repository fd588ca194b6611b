#include "volcal/identify/io/campaign/campaign_notes.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "volcal/identify/io/campaign/doubtful_readings.h"
#include "volcal/identify/io/campaign/reading_columns.h"
#include "volcal/identify/standards/approach.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

std::string file_of(const Setup& setup) {
  return printable(std::filesystem::path(setup.data).filename().string());
}

bool in_milliseconds(const std::string& name) {
  return name.find("[ms]") != std::string::npos || name.find("(ms)") != std::string::npos ||
         name.ends_with("_ms");
}

/// Signs of approach of an axis that occur in the whole campaign.
std::set<int> signs_of(const Campaign& campaign, AxisName axis,
                       const std::vector<std::vector<std::int8_t>>& derived) {
  std::set<int> signs;
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    signs.insert(derived[i].begin(), derived[i].end());
    const auto& recorded = campaign.setups[i].readings.direction[index_of(axis)];
    signs.insert(recorded.begin(), recorded.end());
  }
  signs.erase(0);
  return signs;
}

/// By setup; empty where the file records the axis' directions or they are not to be derived.
std::vector<std::vector<std::int8_t>> directions_from_order(const Campaign& campaign, AxisName axis,
                                                            const std::vector<bool>& derive) {
  std::vector<std::vector<std::int8_t>> derived(campaign.setups.size());
  for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
    const Readings& readings = campaign.setups[i].readings;
    if (!derive[i] || !readings.direction[index_of(axis)].empty()) continue;
    for (const int sign : axis_approach(campaign.machine, readings, axis))
      derived[i].push_back(static_cast<std::int8_t>(sign));
  }
  return derived;
}

}  // namespace

void note_unused_columns(const std::vector<UnusedColumn>& unused, const Setup& setup, Campaign& campaign) {
  if (unused.empty()) return;
  std::vector<std::string> names, keys, sources;
  bool milliseconds = false;
  for (const UnusedColumn& column : unused) {
    names.push_back(printable(column.name));
    if (column.meant.empty() || std::ranges::find(keys, column.meant) != keys.end()) continue;
    keys.push_back(column.meant);
    sources.push_back(names.back());
    milliseconds = milliseconds || (column.meant == "time_s" && in_milliseconds(column.name));
  }
  Finding note{FindingCode::ReadingsColumnsUnused,
               {{"setup", printable(setup.name)}, {"file", file_of(setup)}, {"columns", names}}};
  if (!keys.empty()) {
    note.data["meant"] = keys;
    note.data["meant_columns"] = sources;
    note.data["milliseconds"] = milliseconds;
  }
  campaign.notes.push_back(note);
}

void note_doubtful_readings(Campaign& campaign) {
  for (const Setup& setup : campaign.setups) {
    for (Finding& doubt : doubts_of(setup, campaign.machine)) {
      doubt.data["setup"] = printable(setup.name);
      doubt.data["file"] = file_of(setup);
      campaign.notes.push_back(std::move(doubt));
    }
  }
  for (auto one = campaign.setups.begin(); one != campaign.setups.end(); ++one) {
    const auto twin = std::find_if(campaign.setups.begin(), one,
                                   [&](const Setup& other) { return same_readings(other, *one); });
    if (twin == one) continue;
    campaign.notes.push_back({FindingCode::ReadingsDuplicated,
                              {{"setup", printable(one->name)}, {"first_setup", printable(twin->name)}}});
  }
}

namespace {

void note_half_turns(const std::vector<bool>& derive, Campaign& campaign) {
  for (const Axis& axis : campaign.machine.axes) {
    std::size_t readings = 0;
    std::vector<std::string> setups;
    for (std::size_t i = 0; i < campaign.setups.size(); ++i) {
      const Readings& recorded = campaign.setups[i].readings;
      if (!derive[i] || !recorded.direction[index_of(axis.name)].empty()) continue;
      const std::size_t of_setup = readings_after_half_turns(campaign.machine, recorded, axis.name);
      if (of_setup > 0) setups.push_back(printable(campaign.setups[i].name));
      readings += of_setup;
    }
    if (readings == 0) continue;
    campaign.notes.push_back({FindingCode::ReadingsHalfTurns,
                              {{"readings", static_cast<std::int64_t>(readings)},
                               {"axis", std::string(1, letter_of(axis.name))},
                               {"column", direction_column(axis.name)},
                               {"setups", setups}}});
  }
}

}  // namespace

void derive_directions(const std::vector<bool>& derive, Campaign& campaign) {
  note_half_turns(derive, campaign);
  std::vector<std::string> columns;
  std::set<std::size_t> setups;
  for (const Axis& axis : campaign.machine.axes) {
    auto derived = directions_from_order(campaign, axis.name, derive);
    if (signs_of(campaign, axis.name, derived).size() < 2) continue;
    bool any = false;
    for (std::size_t i = 0; i < derived.size(); ++i) {
      if (std::ranges::all_of(derived[i], [](std::int8_t sign) { return sign == 0; })) continue;
      campaign.setups[i].readings.direction[index_of(axis.name)] = std::move(derived[i]);
      setups.insert(i);
      any = true;
    }
    if (any) columns.push_back(direction_column(axis.name));
  }
  if (columns.empty()) return;
  std::vector<std::string> names;
  for (const std::size_t i : setups) names.push_back(printable(campaign.setups[i].name));
  campaign.notes.push_back(
      {FindingCode::ReadingsDirectionsDerived, {{"columns", columns}, {"setups", names}}});
}

void note_assumed_centres(Campaign& campaign) {
  std::vector<std::string> axes;
  for (const AxisName axis : moving_rotary_axes(campaign)) {
    if (campaign.machine.axis(axis).centre_is_assumed) axes.emplace_back(1, letter_of(axis));
  }
  if (!axes.empty()) campaign.notes.push_back({FindingCode::MachineCentreAssumed, {{"axes", axes}}});
}

}  // namespace volcal
