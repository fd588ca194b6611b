#pragma once
/// What a control holds beside an NC program, as it is given on the command line.

#include <string>
#include <vector>

#include "volcal/identify/program/program_errors.h"

namespace volcal::cli {

struct ProgramSetupArguments {
  std::vector<std::string> work_offsets;  ///< G54=X10,Y20,Z-300 in mm
  std::vector<std::string> tool_lengths;  ///< H1=150 in mm
  std::string start;                      ///< X0,Y0,Z0 in mm, machine coordinates
  std::string units;                      ///< "mm", "inch", or empty
  std::string block_delete;               ///< "on", "off", or empty
};

/// Throws InputError naming the option.
NcSetup program_setup(const ProgramSetupArguments& arguments, const Machine& machine);

/// The functional point while no tool length is active: that of `tool`, by default the machine's first one;
/// tool lengths count from the spindle reference, or are differences to the tool `lengths_from`. Throws
/// InputError.
FunctionalPoint functional_point(const Machine& machine, const std::string& tool,
                                 const std::string& lengths_from);

}  // namespace volcal::cli
