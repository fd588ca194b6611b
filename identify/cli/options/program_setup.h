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

}  // namespace volcal::cli
