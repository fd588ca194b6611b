#include "volcal/identify/solve/plausibility.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr double kImplausibleResidual = 0.02;  // of the longest travel
constexpr double kBlunderShare = 0.5;          // of a setup's squares, in one reading

double longest_travel(const Machine& machine) {
  double longest = 0.0;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) longest = std::max(longest, axis.travel());
  }
  return longest;
}

struct Worst {
  double residual = 0.0;
  int line = 0;
  double share = 0.0;  ///< of the setup's sum of squares
};

Worst worst_of(const std::vector<ResidualRecord>& records, std::size_t setup) {
  Worst worst;
  double squares = 0.0;
  for (const ResidualRecord& record : records) {
    if (record.setup != setup || record.removed) continue;
    squares += record.residual() * record.residual();
    if (std::abs(record.residual()) <= worst.residual) continue;
    worst.residual = std::abs(record.residual());
    worst.line = static_cast<int>(record.source_line);
  }
  if (squares > 0.0) worst.share = worst.residual * worst.residual / squares;
  return worst;
}

[[noreturn]] void refuse(const Campaign& campaign, const Setup& setup, double rms, const Worst& worst,
                         const std::string& machine) {
  std::ostringstream problem;
  problem << "setup \"" << setup.name << "\": its readings miss the " << machine << " machine by "
          << rms * 1e3 << " mm RMS, this one by " << worst.residual * 1e3 << " mm";
  const std::string one =
      "this reading alone is far off: correct it, or leave it out with leave_out = [{ rows = [" +
      std::to_string(worst.line) + "], reason = \"...\" }]";
  const std::string all =
      std::string("check the unit of the reading column (scale = { ... = 1000.0 }), the tool, ") +
      (setup.readings.given.empty()
           ? ""
           : "whether normals point out of the sphere and its radius is not a diameter, ") +
      "and what the setup says of station, centre or direction";
  throw InputError({setup.data.empty() ? campaign.file : setup.data, worst.line}, problem.str(),
                   worst.share > kBlunderShare ? one : all);
}

}  // namespace

void require_plausible(const Campaign& campaign, const std::vector<ResidualRecord>& records,
                       const std::vector<SetupSummary>& setups, const std::string& machine) {
  const double most = kImplausibleResidual * longest_travel(campaign.machine);
  for (std::size_t i = 0; i < setups.size(); ++i) {
    const SetupSummary& summary = setups[i];
    if (summary.reading_unit != "um" || summary.rms_residual < most) continue;
    refuse(campaign, campaign.setups[i], summary.rms_residual, worst_of(records, i), machine);
  }
}

}  // namespace volcal
