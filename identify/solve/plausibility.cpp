#include "volcal/identify/solve/plausibility.h"

#include <algorithm>
#include <sstream>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr double kImplausibleResidual = 0.02;  // of the longest travel

double longest_travel(const Machine& machine) {
  double longest = 0.0;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) longest = std::max(longest, axis.travel());
  }
  return longest;
}

}  // namespace

void require_plausible(const Campaign& campaign, const std::vector<SetupSummary>& on_nominal_machine) {
  const double most = kImplausibleResidual * longest_travel(campaign.machine);
  for (std::size_t i = 0; i < on_nominal_machine.size(); ++i) {
    const SetupSummary& summary = on_nominal_machine[i];
    if (summary.reading_unit != "um" || summary.rms_residual < most) continue;
    std::ostringstream problem;
    problem << "setup \"" << summary.name << "\": its readings miss the nominal machine by "
            << summary.rms_residual * 1e3 << " mm RMS";
    const Setup& setup = campaign.setups[i];
    throw InputError(
        {setup.data.empty() ? campaign.file : setup.data, 0}, problem.str(),
        "check the unit of the reading column (scale = { ... = 1000.0 }), the tool and the station");
  }
}

}  // namespace volcal
