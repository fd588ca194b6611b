#include "volcal/identify/result/error_unit.h"

#include "volcal/model/description/units.h"

namespace volcal {

ErrorUnit unit_of(const FitResult& result, const MachineError& error) {
  if (!error.has_symbol()) {
    if (const ParameterBlock* block = result.layout.find_block(error))
      return {block->units[0], block->si_per_unit[0]};
  }
  return {error.is_angle() ? "urad" : "um", kMicro};
}

}  // namespace volcal
