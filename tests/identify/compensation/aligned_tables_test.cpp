// Tables and corrections of an aligned result, on the machine whose control knows the tools as they were.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/five_axis.h"
#include "tests/support/identified_machines.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/compensation/checks/made_tables.h"
#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/errors/alignment.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/volume/volumetric.h"
#include "volcal/identify/program/tcp/tcp_rewriter.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal {
namespace {

FitResult result_with_tables(const char* code) {
  const Machine machine = testing_support::five_axis_machine(code);
  testing::GivenErrors given{.functions = {{"EYX", [](double q) { return 30e-6 * q; }},
                                           {"EBZ", [](double q) { return 60e-6 * q; }},
                                           {"EAY", [](double q) { return 50e-6 * q; }}}};
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name))
      given.functions[ErrorSymbol{Component::X, axis.name}.name()] = [](double q) {
        return 3e-6 * std::sin(q);
      };
  }
  double value = 20e-6;
  for (const LocationSymbol symbol : independent_locations(machine))
    given.locations[symbol.name()] = value = -1.1 * value;
  return testing::result_with(machine, given, 36);
}

/// RMS of what corrections leave of all errors of the machine as it was described first, after the best rigid
/// motion of the workpiece, m.
double left_on_machine(const FitResult& machine, const Tool& tool, const CorrectionTerm& correction) {
  FiveAxisSettings settings;
  settings.tool_offset = tool.offset;
  const FiveAxisCompensation exact(machine.machine, settings,
                                   joint_errors(machine, tool, default_conditions(machine)));
  std::vector<Eigen::Vector3d> places, errors;
  for (const AxisPosition& pose : poses_of_all_axes(machine.machine, 100)) {
    places.push_back(exact.nominal_point_w(pose));
    errors.push_back(exact.left_by(correction(pose, {}), pose).displacement_w);
  }
  const RigidMotion motion = best_rigid_motion(places, errors);
  double square = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) square += (errors[i] - motion.at(places[i])).squaredNorm();
  return std::sqrt(square / static_cast<double>(places.size()));
}

class AlignedTables : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    Alignment alignment;
    alignment.datum = {AxisName::Z, AxisName::X};
    aligned_ = align_result(raw_, alignment).result;
  }
  FitResult raw_ = result_with_tables(GetParam());
  FitResult aligned_;
};

/// The offset of a turned frame is some 5 um aside, which turns with the table. Levers of a tilted head are
/// left by every table.
TEST_P(AlignedTables, LeaveOnTheMachineWhatIsPrinted) {
  const CorrectionTerm none = [](const AxisPosition&, const ApproachDirection&) { return Correction{}; };
  const Tool& tool = raw_.machine.tools.back();
  const double before = left_on_machine(raw_, tool, none);
  EXPECT_GT(before, 5e-6);
  for (const char* name : {"neutral-csv", "csv", "isg-csv", "linuxcnc-grid"}) {
    const TableFormat& format = *find_table_format(name);
    TableFormatOptions options;
    options.type = default_type(format, raw_);
    options.tool = tool.name;
    options.step = 0.2;
    options.grid_per_axis = 2;
    options.rotary_step = 10.0 * kRadianPerDegree;
    options.settings = testing::example_settings(format);
    const MadeTables made = make_tables(format, aligned_, options);
    const double printed = made.all_axes->exported.rms;
    EXPECT_NEAR(made.all_axes->before.rms, before, 0.1 * before) << name;
    EXPECT_LT(printed, made.all_axes->levers.rms + 0.5e-6) << name;
    const auto by_tables = [&](const AxisPosition& pose, const ApproachDirection& direction) {
      return made.read_back.correction(pose, direction);
    };
    EXPECT_NEAR(left_on_machine(raw_, tool, by_tables), printed, 0.2e-6 + 0.03 * printed) << name;
  }
}

/// A rewritten program may carry a tool that the machine file does not name.
TEST_P(AlignedTables, ProgramsTakeTheSpindleWithEveryTool) {
  const ErrorsOfOffset errors = tcp_errors_of(aligned_, "", default_conditions(aligned_));
  for (const Eigen::Vector3d& offset :
       {Eigen::Vector3d(0.0, 0.0, -0.31), Eigen::Vector3d(0.05, -0.08, -0.1)}) {
    FiveAxisSettings settings;
    settings.type = CompensationType::volumetric() | CompensationType::rotary_volumetric();
    settings.tool_offset = offset;
    const FiveAxisCompensation ideal(aligned_.machine, settings, errors(offset));
    const auto by_program = [&](const AxisPosition& pose, const ApproachDirection& direction) {
      return ideal.correction(pose, direction);
    };
    EXPECT_LT(left_on_machine(raw_, {"other", offset, 0.0}, by_program), 0.05e-6) << offset.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(All, AlignedTables,
                         ::testing::Values("w A' b X Y Z t", "w C' A' b X Y Z t", "w C' A' Y' b X Z t",
                                           "w C' X' b Y Z B t"));

}  // namespace
}  // namespace volcal
