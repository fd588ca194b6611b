#include "volcal/studies/tables/exact_machine.h"

#include <algorithm>

#include "volcal/sim/machine/transforms.h"
#include "volcal/studies/files/control_tables.h"

namespace volcal::studies {
namespace {

sim::MachineState state_at(const JudgedMachine& judged, const VolumePoint& point) {
  sim::MachineState state = judged.surroundings;
  state.position = point.position;
  state.direction = point.direction;
  return state;
}

}  // namespace

bool is_wanted(const TableFormat& format, const std::vector<std::string>& names) {
  if (!control_reads(format)) return false;
  const bool as_linuxcnc = format.name == "linuxcnc-trt";  // tables of linear axes are those of linuxcnc
  return names.empty() ? !as_linuxcnc : std::ranges::find(names, format.name) != names.end();
}

TableFormatOptions study_table_options(const TableFormat& format, CompensationType type,
                                       const std::string& tool) {
  TableFormatOptions options;
  options.type = type;
  options.tool = tool;
  options.grid_per_axis = 2;
  for (const TableSetting& setting : format.settings)
    options.settings[std::string(setting.name)] = std::string(setting.example);
  return options;
}

std::vector<TableFile> study_table_files(const TableFormat& format, const FitResult& result,
                                         TableFormatOptions options) {
  options.step = choose_step(format, result, options, kStudyTableTolerance).step;
  return write_tables(format, result, options);
}

Eigen::Vector3d exact_error(const JudgedMachine& judged, const VolumePoint& point) {
  return judged.machine.point_error(state_at(judged, point), judged.tool);
}

double exact_rms(const JudgedMachine& judged, std::span<const VolumePoint> points) {
  std::vector<Eigen::Vector3d> places, errors;
  for (const VolumePoint& point : points) {
    places.push_back(judged.machine.nominal_point(state_at(judged, point), judged.tool));
    errors.push_back(exact_error(judged, point));
  }
  return sim::rms_after_alignment(places, errors);
}

}  // namespace volcal::studies
