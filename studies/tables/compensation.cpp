#include "volcal/studies/tables/compensation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/measurement/paths.h"
#include "volcal/sim/study.h"
#include "volcal/studies/files/control_tables.h"
#include "volcal/studies/tables/exact_machine.h"

namespace volcal::studies {
namespace {

constexpr double kReversal = 4e-6;         // m, largest
constexpr double kAngularReversal = 3e-6;  // rad, largest
constexpr double kLeastIncrement = 1e-6;   // m
constexpr double kLongerTool = 50e-3;      // m
constexpr std::uint64_t kOtherSeed = 7919;

/// Reversal of everything that the simulated machine has it in.
ModelSpec model_with_reversal() {
  ModelSpec model;
  for (const AxisName axis : kLinearAxes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis};
      if (is_rotation(component) || symbol.is_positioning())
        model.effects.push_back(effect_spec("reversal", {{"symbol", symbol.name()}}));
    }
  }
  return model;
}

/// One machine from its first measurement to its last.
class CompensatedMachine {
 public:
  CompensatedMachine(const CompensationStudyOptions& options, int number)
      : options_(options),
        study_(first_study(options, number)),
        truth_(sim::true_machine(study_)),
        tool_(study_.machine.tools[*study_.machine.tool_index(kCompensatedTool)].offset),
        points_(fresh_points()),
        before_(rms_of(truth_, tool_)) {}

  std::vector<CompensationStudyRow> rows() {
    const FitResult result = identify(study_);
    std::vector<CompensationStudyRow> rows;
    for (const TableFormat* format : table_formats()) {
      if (!is_wanted(*format, options_.formats)) continue;
      for (const CompensationType type : types_of(*format)) rows.push_back(row_of(*format, type, result));
    }
    add_variants(result, rows);
    return rows;
  }

 private:
  static sim::Study first_study(const CompensationStudyOptions& options, int number) {
    const std::vector<Machine> machines = sim::reference_machines();
    sim::Study study;
    study.machine = machines[static_cast<std::size_t>(number) % machines.size()];
    study.seed = options.seed + static_cast<std::uint64_t>(number);
    study.truth.random.reversal_max = kReversal;
    study.truth.random.angular_reversal_max = kAngularReversal;
    sim::Tracking tracking;
    tracking.grid = options.small ? Eigen::Vector3i(6, 5, 4) : Eigen::Vector3i(9, 7, 6);
    study.measurements.emplace_back().settings = tracking;
    return study;
  }

  std::vector<VolumePoint> fresh_points() const {
    sim::RandomStream random(study_.seed, "fresh points");
    std::vector<VolumePoint> points;
    for (const sim::CommandedPoint& place :
         sim::random_points(study_.machine, options_.small ? 40 : 150, random)) {
      for (unsigned signs = 0; signs < 8; ++signs) {
        VolumePoint point{place.position, {}};
        for (std::size_t i = 0; i < 3; ++i) point.direction[i] = ((signs >> i) & 1U) != 0 ? 1 : -1;
        points.push_back(point);
      }
    }
    return points;
  }

  /// Each alone where the format can do that, and all together, which comes last.
  static std::vector<CompensationType> types_of(const TableFormat& format) {
    std::vector<CompensationType> types;
    for (const CompensationTypeInfo& info : compensation_types()) {
      if (!format.indivisible && info.type != format.supported && format.supported.contains(info.type))
        types.push_back(info.type);
    }
    types.push_back(format.supported);
    return types;
  }

  static FitResult identify(const sim::Study& study) {
    FitOptions options;
    options.threads = 1;
    options.noise = NoisePolicy::White;
    return fit(sim::simulate(study).campaign, model_with_reversal(), options);
  }

  static TableFormatOptions table_options(const TableFormat& format, CompensationType type) {
    return study_table_options(format, type, kCompensatedTool);
  }

  /// Of the exact machine with a tool, against the point that the program asks for.
  double rms_of(const sim::TruthMachine& machine, const Eigen::Vector3d& tool) const {
    return exact_rms({machine, {}, tool}, points_);
  }

  double applied_rms(const sim::ActiveCompensation& compensation, const Eigen::Vector3d& tool) const {
    sim::TruthMachine machine = truth_;
    machine.set_correction(sim::command_correction(compensation));
    return rms_of(machine, tool);
  }

  double ideal_rms(CompensationType type, bool both_directions) const {
    const Compensation ideal(study_.machine, middle_of_travel(study_.machine), type,
                             [this](const AxisPosition& position, const ApproachDirection& direction) {
                               sim::MachineState state;
                               state.position = position;
                               state.direction = direction;
                               return truth_.point_error(state, tool_);
                             });
    sim::TruthMachine machine = truth_;
    machine.set_correction([&ideal, both_directions](const sim::MachineState& state) {
      return ideal.correction(state.position, both_directions ? state.direction : ApproachDirection{});
    });
    return rms_of(machine, tool_);
  }

  /// The same machine, measured otherwise and with a compensation.
  sim::Study again(const sim::ActiveCompensation& compensation) const {
    sim::Study study = study_;
    study.seed = study_.seed + kOtherSeed;
    study.truth.alter = [this](sim::TruthMachine& machine) { machine = truth_; };
    study.compensation = compensation;
    return study;
  }

  /// RMS of the readings of other setups against the nominal machine: diagonals, circles and a point grid.
  double read_rms(const sim::ActiveCompensation& compensation) const {
    sim::Study study = again(compensation);
    study.measurements.clear();
    sim::Diagonals diagonals;
    diagonals.tool = kCompensatedTool;
    diagonals.points = 17;
    study.measurements.emplace_back().settings = diagonals;
    sim::BallBarCircles circles;
    circles.tool = kCompensatedTool;
    circles.at = {0.4, 0.6, 0.5};
    circles.points_per_turn = 60;
    study.measurements.emplace_back().settings = circles;
    sim::PointGrid grid;
    grid.tool = kCompensatedTool;
    study.measurements.emplace_back().settings = grid;
    const Evaluation evaluation = evaluate_model(sim::simulate(study).campaign, nominal_model(), nullptr, 1);
    double squares = 0.0;
    for (const ResidualRecord& record : evaluation.residuals) squares += std::pow(record.residual(), 2);
    return std::sqrt(squares / static_cast<double>(evaluation.residuals.size()));
  }

  CompensationStudyRow row_of(const TableFormat& format, CompensationType type,
                              const FitResult& result) const {
    const std::vector<TableFile> files = study_table_files(format, result, table_options(format, type));
    const sim::ActiveCompensation compensation{control_tables(format, files), 0.0, {}};
    CompensationStudyRow row = empty_row(format, type);
    row.applied = applied_rms(compensation, tool_);
    if (type == format.supported) {
      row.read_before = read_rms({});
      row.read_after = read_rms(compensation);
    }
    return row;
  }

  CompensationStudyRow empty_row(const TableFormat& format, CompensationType type) const {
    constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
    return {study_.machine.structure.code,
            std::string(format.name),
            type.name(),
            {},
            before_,
            ideal_rms(type, true),
            ideal_rms(type, format.limits.both_directions),
            kNotMeasured,
            kNotMeasured,
            kNotMeasured};
  }

  /// Least increment, a tool that the control knows wrongly, and L-VOL superimposed on active L-POS.
  void add_variants(const FitResult& result, std::vector<CompensationStudyRow>& rows) const {
    const TableFormat& format = *find_table_format("neutral-csv");
    if (!is_wanted(format, options_.formats)) return;
    const CompensationType all = CompensationType::volumetric();
    CompensationStudyRow row = empty_row(format, all);
    sim::ActiveCompensation compensation{
        control_tables(format, study_table_files(format, result, table_options(format, all))), 0.0, {}};
    row.variant = "tool 50 mm longer than stated";
    row.applied = applied_rms(compensation, tool_ - Eigen::Vector3d(0.0, 0.0, kLongerTool));
    rows.push_back(row);
    compensation.least_increment = kLeastIncrement;
    row.variant = "least increment 1 um";
    row.applied = applied_rms(compensation, tool_);
    rows.push_back(row);
    row.variant = "superimposed on L-POS";
    row.applied = superimposed_rms(format, result);
    rows.push_back(row);
  }

  double superimposed_rms(const TableFormat& format, const FitResult& result) const {
    const std::vector<TableFile> active =
        study_table_files(format, result, table_options(format, CompensationPart::Positioning));
    sim::Study measured = again({control_tables(format, active), 0.0, {}});
    TableFormatOptions options = table_options(format, CompensationType::volumetric());
    options.active = format.read(active);
    const std::vector<TableFile> files = study_table_files(format, identify(measured), options);
    return applied_rms({control_tables(format, files), 0.0, {}}, tool_);
  }

  const CompensationStudyOptions& options_;
  sim::Study study_;
  sim::TruthMachine truth_;
  Eigen::Vector3d tool_;
  std::vector<VolumePoint> points_;
  double before_ = 0.0;
};

}  // namespace

std::vector<CompensationStudyRow> compensation_study(const CompensationStudyOptions& options) {
  std::vector<std::vector<CompensationStudyRow>> machines(static_cast<std::size_t>(options.machines));
  int done = 0;
  std::mutex reporting;
  run_parallel(machines.size(), thread_count(options.threads), [&](std::size_t i) {
    machines[i] = CompensatedMachine(options, static_cast<int>(i)).rows();
    const std::lock_guard lock(reporting);
    ++done;
    if (options.progress) options.progress(done, options.machines);
  });
  std::vector<CompensationStudyRow> rows;
  for (const auto& machine : machines) rows.insert(rows.end(), machine.begin(), machine.end());
  return rows;
}

}  // namespace volcal::studies
