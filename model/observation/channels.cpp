#include "volcal/model/observation/channels.h"

#include <algorithm>
#include <cstring>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr const char* kAngles = " angles";

bool is_angle_column(const std::string& column) {
  const std::string_view unit = unit_of_key(column).suffix;
  return unit == "urad" || unit == "mrad" || unit == "rad" || unit == "deg";
}

}  // namespace

std::string channel_column(const Setup& setup, std::size_t channel) {
  const Instrument* instrument = find_instrument(setup.instrument);
  if (!instrument) {
    throw InputError({setup.data, setup.source_line},
                     "setup " + setup.name + ": unknown instrument " + setup.instrument,
                     "use one of the registered instruments");
  }
  return instrument->schema().column_sets.at(setup.readings.column_set).at(channel).column;
}

bool is_angle_channel(const Setup& setup, std::size_t channel) {
  return is_angle_column(channel_column(setup, channel));
}

std::vector<std::vector<bool>> angle_channels(const Campaign& campaign) {
  std::vector<std::vector<bool>> is_angle;
  for (const Setup& setup : campaign.setups) {
    is_angle.emplace_back();
    for (std::size_t channel = 0; channel < setup.readings.channels(); ++channel)
      is_angle.back().push_back(is_angle_channel(setup, channel));
  }
  return is_angle;
}

std::string residual_unit(const Setup& setup, std::size_t channel) {
  return is_angle_channel(setup, channel) ? "urad" : "um";
}

std::string noise_group(const Setup& setup, std::size_t channel) {
  const Instrument* instrument = find_instrument(setup.instrument);
  const bool angle = is_angle_channel(setup, channel);
  const auto& columns = instrument->schema().column_sets.at(setup.readings.column_set);
  const bool reads_both = angle && std::ranges::any_of(columns, [](const ColumnSchema& each) {
                            return !is_angle_column(each.column);
                          });
  return setup.instrument + (reads_both ? kAngles : "");
}

std::string instrument_of_noise_group(const std::string& group) {
  return group.ends_with(kAngles) ? group.substr(0, group.size() - std::strlen(kAngles)) : group;
}

std::string noise_group_unit(const std::string& group) {
  if (group.ends_with(kAngles)) return "urad";
  const Instrument* known = find_instrument(group);
  if (known == nullptr) return "um or urad";
  const bool lengths = std::ranges::any_of(known->schema().column_sets, [](const auto& columns) {
    return std::ranges::any_of(columns,
                               [](const ColumnSchema& each) { return !is_angle_column(each.column); });
  });
  return lengths ? "um" : "urad";
}

}  // namespace volcal
