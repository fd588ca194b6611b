#pragma once
/// Tolerances of a machine at the design stage, in a file of their own or as [tolerances] of the machine
/// file.
///
///     format = "volcal-tolerances-1"
///     machine = "machine.toml"     # needed where the file is named alone
///     [tolerances]                 # widths of bands; one who states +-T writes 2 T
///     positioning_um = 10.0        # every EXX EYY EZZ, over the travel
///     straightness_um = 8.0        # every EYX EZX ...
///     angles_urad = 15.0           # every EAX EBX ECX ...
///     squareness_urad = 20.0       # every squareness of the datum
///     EXX_um = 6.0                 # one error, in place of its class
///     EC0Y_urad = 12.0
///
/// What has no tolerance is free of error. Rotary axes have none: the volume is that of the linear axes,
/// rotary axes at 0, where their errors are constant.

#include <string>

#include "volcal/identify/text/toml_document.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/tolerances.h"

namespace volcal {

inline constexpr const char* kTolerancesFormat = "volcal-tolerances-1";

/// A [tolerances] table. Throws InputError.
Tolerances read_tolerances(const TomlTable& table, const std::string& file, const Machine& machine);

struct DesignedMachine {
  Machine machine;
  Tolerances tolerances;
};

/// Whether a path and --tolerances mean a machine at the design stage: with tolerances, or a file of the
/// format of machines or tolerances.
bool is_design(const std::string& path, const std::string& tolerances);

/// `path`: machine.toml, with [tolerances] where `tolerances` is empty; a model.toml without values that
/// names a machine; or a file of tolerances that does. Throws InputError.
DesignedMachine read_design(const std::string& path, const std::string& tolerances);

}  // namespace volcal
