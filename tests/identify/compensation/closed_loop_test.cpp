// Tables of every format on simulated machines: written, read back as the controller reads them, added to the
// commands of the exact machine of sim, which knows nothing of model/.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/long_tests.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

using LinearCorrection = std::function<Eigen::Vector3d(const AxisPosition&, const ApproachDirection&)>;

// Largest ratio and volumetric error allowed are those that were asked of the exporters.
constexpr double kStepTolerance = 0.5e-6;  // m, of the chosen step
constexpr double kVolumetricGoal = 1e-6;   // m
constexpr double kRatioToIdeal = 1.2;
constexpr double kUncompensated = 15e-6;  // m

Eigen::Vector3d no_correction(const AxisPosition&, const ApproachDirection&) {
  return Eigen::Vector3d::Zero();
}

sim::TruthMachine machine_with_errors(std::size_t structure, bool reversal) {
  sim::RandomTruthOptions options;
  if (reversal) {
    options.reversal_max = 4e-6;
    options.angular_reversal_max = 3e-6;
  }
  return sim::random_truth(sim::reference_machines()[structure], 40 + structure, options);
}

/// sqrt(mean |v|^2) over the volume, after alignment, of a vector that is given by state and nominal point.
double aligned_rms(
    const sim::TruthMachine& truth, const Eigen::Vector3d& tool,
    const std::function<Eigen::Vector3d(const sim::MachineState&, const Eigen::Vector3d&)>& of) {
  std::vector<Eigen::Vector3d> points, vectors;
  for (const VolumePoint& point : volume_points(truth.machine(), 5)) {
    sim::MachineState state;
    state.position = point.position;
    state.direction = point.direction;
    points.push_back(truth.nominal_point(state, tool));
    vectors.push_back(of(state, points.back()));
  }
  return sim::rms_after_alignment(points, vectors);
}

/// Of the exact machine under corrected commands.
double remaining_rms(const sim::TruthMachine& truth, const Eigen::Vector3d& tool,
                     const LinearCorrection& correction) {
  return aligned_rms(truth, tool, [&](sim::MachineState state, const Eigen::Vector3d& nominal) {
    const Eigen::Vector3d added = correction(state.position, state.direction);
    for (std::size_t i = 0; i < 3; ++i) state.position[i] += added[static_cast<Eigen::Index>(i)];
    return Eigen::Vector3d(truth.point(state, tool) - nominal);
  });
}

/// Of the corrections alone: what they move the functional point by.
double correction_rms(const sim::TruthMachine& truth, const Eigen::Vector3d& tool,
                      const LinearCorrection& correction) {
  return aligned_rms(truth, tool, [&](const sim::MachineState& state, const Eigen::Vector3d&) {
    return correction(state.position, state.direction);
  });
}

/// The ideal compensation of the exact machine itself.
Compensation ideal_of(const sim::TruthMachine& truth, const Eigen::Vector3d& tool, CompensationType type) {
  return {truth.machine(), middle_of_travel(truth.machine()), type,
          [&truth, tool](const AxisPosition& position, const ApproachDirection& direction) {
            sim::MachineState state;
            state.position = position;
            state.direction = direction;
            return truth.point_error(state, tool);
          }};
}

/// Of a format that tells no directions apart, the mean of both.
LinearCorrection corrections_of(const Compensation& ideal, bool both_directions) {
  return [&ideal, both_directions](const AxisPosition& at, const ApproachDirection& direction) {
    return ideal.correction(at, both_directions ? direction : ApproachDirection{});
  };
}

TableFormatOptions options_for(const TableFormat& format, CompensationType type) {
  TableFormatOptions options;
  options.type = type;
  options.tool = "side_x";
  options.settings = testing::example_settings(format);
  return options;
}

/// Types that a format can do, each alone, and all together.
std::vector<CompensationType> types_of(const TableFormat& format) {
  std::vector<CompensationType> types;
  for (const CompensationTypeInfo& info : compensation_types()) {
    if (testing::holds(format, info.type)) types.push_back(info.type);
  }
  if (std::ranges::find(types, format.supported) == types.end()) types.push_back(format.supported);
  return types;
}

struct Left {
  double before = 0.0, ideal = 0.0, exported = 0.0;
};

class TablesInTheLoop : public ::testing::TestWithParam<std::tuple<const TableFormat*, std::size_t>> {
 protected:
  static const TableFormat& format() { return *std::get<0>(GetParam()); }
  static std::size_t structure() { return std::get<1>(GetParam()); }

  static CompensationTables exported(const sim::TruthMachine& truth, CompensationType type) {
    const FitResult result = testing::result_of(truth);
    TableFormatOptions options = options_for(format(), type);
    options.grid_per_axis = 2;
    options.step = choose_step(format(), result, options, kStepTolerance).step;
    return format().read(write_tables(format(), result, options));
  }

  static Left loop(const sim::TruthMachine& truth, CompensationType type) {
    const Eigen::Vector3d tool = truth.machine().tools[1].offset;
    const Compensation ideal = ideal_of(truth, tool, type);
    const CompensationTables tables = exported(truth, type);
    return {remaining_rms(truth, tool, no_correction),
            remaining_rms(truth, tool, corrections_of(ideal, format().limits.both_directions)),
            remaining_rms(truth, tool, [&](const AxisPosition& at, const ApproachDirection& direction) {
              return tables.correction(at, direction).linear;
            })};
  }
};

TEST_P(TablesInTheLoop, LeaveWhatTheIdealCompensationLeaves) {
  for (const bool reversal : {true, false}) {
    if (!reversal && format().limits.both_directions) continue;
    const sim::TruthMachine truth = machine_with_errors(structure(), reversal);
    for (const CompensationType type : types_of(format())) {
      const Left result = loop(truth, type);
      const std::string what = std::string(format().name) + " " + type.name() +
                               (reversal ? " with reversal" : " without reversal") + ": before " +
                               std::to_string(result.before * 1e6) + ", ideal " +
                               std::to_string(result.ideal * 1e6) + ", exported " +
                               std::to_string(result.exported * 1e6) + " um";
      EXPECT_GE(result.before, kUncompensated) << what;
      EXPECT_LT(result.ideal, result.before) << what;
      const bool exact = type.is_volumetric() && (!reversal || format().limits.both_directions);
      EXPECT_LE(result.exported, exact ? kVolumetricGoal : kRatioToIdeal * result.ideal) << what;
    }
  }
}

/// A wrong sign, unit, axis or tool must not pass as a compensation: it moves the exact machine away from
/// what the ideal compensation gives.
TEST_P(TablesInTheLoop, MistakesAreSeen) {
  using Vector = Eigen::Vector3d;
  const sim::TruthMachine truth = machine_with_errors(structure(), true);
  const CompensationType type = format().supported;
  const CompensationTables tables = exported(truth, type);
  const auto deviation = [&](const Vector& tool, const std::function<Vector(const Vector&)>& mistake) {
    const Compensation ideal = ideal_of(truth, tool, type);
    const LinearCorrection right = corrections_of(ideal, format().limits.both_directions);
    return correction_rms(truth, tool, [&](const AxisPosition& at, const ApproachDirection& direction) {
      const bool both = format().limits.both_directions;  // else the mean, without lists of reversal
      return Vector(mistake(tables.correction(at, both ? direction : ApproachDirection{}).linear) -
                    right(at, direction));
    });
  };
  const Vector tool = truth.machine().tools[1].offset;
  const double none = deviation(tool, [](const Vector& c) { return c; });
  EXPECT_LT(none, kStepTolerance + 0.5 * format().limits.resolution);
  const double noticeable = kStepTolerance + 3.0 * none;
  EXPECT_GT(deviation(tool, [](const Vector& c) { return Vector(-c); }), noticeable) << "sign";
  EXPECT_GT(deviation(tool, [](const Vector& c) { return Vector(c / 25.4); }), noticeable) << "unit";
  EXPECT_GT(deviation(tool, [](const Vector& c) { return Vector(c.y(), c.z(), c.x()); }), noticeable)
      << "axis";
  for (int i = 0; i < 3; ++i) {
    const bool moves = type != CompensationPart::Squareness || i < 2;  // the third axis of the datum stays
    const auto turned = [i](Vector c) {
      c[i] = -c[i];
      return c;
    };
    if (!moves) continue;
    EXPECT_GT(deviation(tool, turned), noticeable) << "sign of axis " << i;
  }
  if (!type.has(CompensationPart::Angular)) return;
  const Vector other_tool = truth.machine().tools[2].offset;
  EXPECT_GT(deviation(other_tool, [](const Vector& c) { return c; }), noticeable) << "tool";
}

TEST(ReversalLists, TakeWhatVolumetricTablesLeaveOfAReversalAlongTheAxes) {
  const TableFormat& format = *find_table_format("isg-csv");
  for (std::size_t structure = 0; structure < 3; ++structure) {
    const sim::TruthMachine truth = machine_with_errors(structure, true);
    const Eigen::Vector3d tool = truth.machine().tools[1].offset;
    std::map<std::string, double> left;
    for (const char* reversal : {"none", "lists"}) {
      TableFormatOptions options = options_for(format, CompensationType::volumetric());
      options.settings["reversal"] = reversal;
      options.step = 20e-3;
      const CompensationTables tables = format.read(write_tables(format, testing::result_of(truth), options));
      left[reversal] =
          remaining_rms(truth, tool, [&](const AxisPosition& at, const ApproachDirection& direction) {
            return tables.correction(at, direction).linear;
          });
    }
    EXPECT_LT(left["lists"], 0.75 * left["none"]) << structure;
    EXPECT_LT(left["lists"], 1.2e-6) << structure;
  }
}

/// Measured by a laser tracer, fitted, written, read back, and judged on the machine that was measured.
TEST(TablesOfAFit, CompensateTheMachineThatWasMeasured) {
  sim::Study study;
  study.machine = sim::reference_machines()[1];
  study.seed = 3;
  study.truth.random.reversal_max = 4e-6;
  sim::Tracking tracking;
  tracking.grid = {9, 7, 6};
  study.measurements.emplace_back().settings = tracking;
  const sim::SimulatedCampaign simulated = sim::simulate(study);
  ModelSpec model;
  for (const char* symbol : {"EXX", "EYY", "EZZ"})
    model.effects.push_back(effect_spec("reversal", {{"symbol", std::string(symbol)}}));
  FitOptions fit_options;
  fit_options.noise = NoisePolicy::White;
  const FitResult result = fit(simulated.campaign, model, fit_options);

  const Eigen::Vector3d tool = study.machine.tools[1].offset;
  EXPECT_GE(remaining_rms(simulated.truth, tool, no_correction), kUncompensated);
  for (const char* name : {"csv", "neutral-csv"}) {
    const TableFormat& format = *find_table_format(name);
    TableFormatOptions options = options_for(format, CompensationType::volumetric());
    options.step = 20e-3;
    const CompensationTables tables = format.read(write_tables(format, result, options));
    EXPECT_LE(remaining_rms(simulated.truth, tool,
                            [&](const AxisPosition& at, const ApproachDirection& direction) {
                              return tables.correction(at, direction).linear;
                            }),
              kVolumetricGoal)
        << name;
  }
}

/// Every format on one of the three structures, in turn; on all of them for the night.
std::vector<std::tuple<const TableFormat*, std::size_t>> formats_and_structures() {
  std::vector<std::tuple<const TableFormat*, std::size_t>> all;
  std::size_t turn = 0;
  for (const TableFormat* format : table_formats()) {
    for (std::size_t structure = 0; structure < 3; ++structure)
      if (testing::long_tests() || structure == turn % 3) all.emplace_back(format, structure);
    ++turn;
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, TablesInTheLoop, ::testing::ValuesIn(formats_and_structures()),
                         [](const auto& tested) {
                           std::string name(std::get<0>(tested.param)->name);
                           std::ranges::replace(name, '-', '_');
                           return name + "_structure_" + std::to_string(std::get<1>(tested.param));
                         });

}  // namespace
}  // namespace volcal
