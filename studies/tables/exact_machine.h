#pragma once
/// What studies of compensations share: files of a format, and the exact machine judged at points.

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/sim/machine/control.h"
#include "volcal/sim/machine/truth_machine.h"

namespace volcal::studies {

/// Of tables against the ideal compensation, as volcal tables has it, m.
inline constexpr double kStudyTableTolerance = 0.2e-6;

/// Whether the simulated control reads the format and it is among the names; no names = all.
bool is_wanted(const TableFormat& format, const std::vector<std::string>& names);

/// For a tool, the format's settings as in their examples.
TableFormatOptions study_table_options(const TableFormat& format, CompensationType type,
                                       const std::string& tool);
/// With the step that the tolerance of `volcal tables` asks for.
std::vector<TableFile> study_table_files(const TableFormat& format, const FitResult& result,
                                         TableFormatOptions options);

/// A machine, what surrounds it and the tool that it really carries.
struct JudgedMachine {
  const sim::TruthMachine& machine;
  sim::MachineState surroundings;  ///< position and direction apart
  Eigen::Vector3d tool;            ///< offset, m
};

/// Actual less programmed functional point, m.
Eigen::Vector3d exact_error(const JudgedMachine& judged, const VolumePoint& point);
/// sqrt(mean |e|^2) after the best rigid motion, m.
double exact_rms(const JudgedMachine& judged, std::span<const VolumePoint> points);

}  // namespace volcal::studies
