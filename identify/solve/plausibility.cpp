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

[[noreturn]] void refuse(const Campaign& campaign, const Setup& setup, double rms, const Worst& worst) {
  std::ostringstream problem;
  problem << "setup \"" << setup.name << "\": its readings miss the nominal machine by " << rms * 1e3
          << " mm RMS, this one by " << worst.residual * 1e3 << " mm";
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

/// The first setup that misses the machine by more than errors are.
const SetupSummary* implausible(const Campaign& campaign, const std::vector<SetupSummary>& setups) {
  const double most = kImplausibleResidual * longest_travel(campaign.machine);
  const auto found = std::ranges::find_if(setups, [most](const SetupSummary& setup) {
    return setup.reading_unit == "um" && !(setup.rms_residual < most);
  });
  return found == setups.end() ? nullptr : &*found;
}

/// "EXX by sin(x / p): p" from 30 to -2e5, ...
std::string moved_shapes(const ParameterLayout& layout, const Eigen::VectorXd& parameters) {
  std::ostringstream text;
  for (const ParameterBlock& block : layout.blocks) {
    if (block.kind != ParameterKind::EffectShape) continue;
    text << (text.tellp() > 0 ? ", " : "") << '"' << block.name << "\" from "
         << block.guess[0] / block.si_per_unit[0] << " to " << parameters[block.offset] / block.si_per_unit[0]
         << (block.units[0].empty() ? "" : " ") << block.units[0];
  }
  return text.str();
}

}  // namespace

void require_plausible(const Campaign& campaign, const std::vector<ResidualRecord>& records,
                       const std::vector<SetupSummary>& setups) {
  const SetupSummary* setup = implausible(campaign, setups);
  if (setup == nullptr) return;
  const auto at = static_cast<std::size_t>(setup - setups.data());
  refuse(campaign, campaign.setups[at], setup->rms_residual, worst_of(records, at));
}

void require_plausible_fit(const MeasurementModel& model, const Eigen::VectorXd& parameters,
                           const std::vector<SetupSummary>& setups) {
  const SetupSummary* setup = implausible(model.campaign(), setups);
  if (setup == nullptr) return;
  std::ostringstream problem;
  problem << "the adjustment went astray: the fitted machine misses setup \"" << setup->name << "\" by "
          << setup->rms_residual * 1e3 << " mm RMS, the nominal machine does not";
  const std::string moved = moved_shapes(model.layout(), parameters);
  if (!moved.empty()) problem << "; it took " << moved;
  throw InputError({model.spec().file, 0}, problem.str(),
                   moved.empty()
                       ? "leave effects out of the model one by one, or state [priors] in it"
                       : "hold this parameter, without its standard uncertainty, or begin it elsewhere "
                         "with a smaller one");
}

}  // namespace volcal
