#pragma once
/// Readings and predictions of a setup side by side, as the standards' figures take them.

#include <span>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/finding.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

/// [channel][row], SI; not a number where there is no record.
struct SetupValues {
  std::vector<std::vector<double>> reading;
  std::vector<std::vector<double>> predicted;
  int removed = 0;

  /// Every channel of the row has a record.
  bool has(std::size_t row) const;
};

/// One entry per setup; readings that the campaign leaves out are in none.
std::vector<SetupValues> values_by_setup(const Campaign& campaign, std::span<const ResidualRecord> records);

/// That figures use readings which the adjustment left out.
std::vector<Finding> notes_on_removed(const SetupValues& values);

/// Axes whose commanded positions differ within the setup by more than scatter (kStandingRange).
std::vector<AxisName> moving_axes(const Setup& setup);

/// Positions of the other axes at the first reading: "Y 100, Z -135 mm, A 0 deg".
std::string place_of_other_axes(const Campaign& campaign, const Setup& setup, AxisName moving);

}  // namespace volcal
