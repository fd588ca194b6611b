#pragma once
/// What hidden effects change besides the error motions of the machine: tool, instrument, reading.

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/setup_plan.h"

namespace volcal::sim {

/// One reading about to be taken.
struct Occasion {
  const SetupPlan& plan;
  const CommandedPoint& point;
  const MachineState& state;
  double first_time = 0.0;  ///< of the setup's first reading, s
};

struct Interference {
  /// Added to the tool offset, m.
  std::vector<std::function<Eigen::Vector3d(const Occasion&)>> tool;
  /// Changes the instrument's true values, for this reading.
  std::vector<std::function<void(const Occasion&, InstrumentTruth&)>> instrument;
  /// Added to one component of the reading, whose undisturbed value is given; m or rad.
  std::vector<std::function<double(const Occasion&, std::size_t channel, double value)>> reading;
};

}  // namespace volcal::sim
