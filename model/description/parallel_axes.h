#pragma once
/// What a parallel axis U, V, W cannot be used for is refused here, in one form of words.

#include <string>

#include "volcal/model/description/machine.h"

namespace volcal {

/// Throws InputError for a machine with U, V or W. `what`: what cannot hold it, as the beginning of a
/// sentence: "the format fanuc". `remedy`: what else to do; leaving the axis out of the structure when empty.
void require_no_parallel_axes(const Machine& machine, const std::string& what,
                              const std::string& remedy = {});

}  // namespace volcal
