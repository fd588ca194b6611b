#pragma once
/// In which unit the values of an error are shown.

#include <string>

#include "volcal/identify/result/result.h"

namespace volcal {

struct ErrorUnit {
  std::string name;  ///< "um", "urad", "um/m/K"
  double si_per_unit = 1.0;
};
/// Of an error motion or a location error by what it is; of an effect that of its amplitude.
ErrorUnit unit_of(const FitResult& result, const MachineError& error);

}  // namespace volcal
