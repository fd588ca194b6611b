#include "volcal/identify/standards/setup_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/standards/approach.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal {

bool SetupValues::has(std::size_t row) const {
  return std::all_of(reading.begin(), reading.end(),
                     [&](const std::vector<double>& channel) { return !std::isnan(channel[row]); });
}

std::vector<SetupValues> values_by_setup(const Campaign& campaign, std::span<const ResidualRecord> records) {
  std::vector<SetupValues> values;
  for (const Setup& setup : campaign.setups) {
    const std::vector<double> empty(setup.readings.size(), std::nan(""));
    values.push_back(
        {std::vector(setup.readings.channels(), empty), std::vector(setup.readings.channels(), empty), 0});
  }
  for (const ResidualRecord& record : records) {
    if (record.left_out) continue;
    SetupValues& setup = values[record.setup];
    const auto channel = static_cast<std::size_t>(record.channel);
    setup.reading[channel][record.row] = record.reading;
    setup.predicted[channel][record.row] = record.predicted;
    setup.removed += record.removed ? 1 : 0;
  }
  return values;
}

std::vector<Finding> notes_on_removed(const SetupValues& values) {
  if (values.removed == 0) return {};
  return {{FindingCode::StandardsRemovedReadingsUsed, {{"readings", std::int64_t{values.removed}}}}};
}

std::vector<AxisName> moving_axes(const Setup& setup) {
  std::vector<AxisName> moving;
  for (const AxisName axis : kAllAxes) {
    const auto& column = setup.readings.position[index_of(axis)];
    if (column.empty()) continue;
    const auto [low, high] = std::ranges::minmax(column);
    if (high - low > kStandingRange) moving.push_back(axis);
  }
  return moving;
}

std::string place_of_other_axes(const Campaign& campaign, const Setup& setup, AxisName moving) {
  std::string place;
  for (const Axis& axis : campaign.machine.axes) {
    if (axis.name == moving || setup.readings.position[index_of(axis.name)].empty()) continue;
    const double position = setup.readings.position[index_of(axis.name)].front();
    constexpr double kShown = 1e3;  // to a thousandth of a mm or degree
    const double shown = position / position_unit(axis.name).si_per_unit;
    place += fmt::format("{}{} {:g}{}", place.empty() ? "" : ", ", letter_of(axis.name),
                         std::round(shown * kShown) / kShown, is_rotary(axis.name) ? " deg" : "");
  }
  return place;
}

}  // namespace volcal
