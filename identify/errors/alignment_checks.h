#pragma once
/// What cannot be aligned, with its remedy.

#include "volcal/identify/errors/alignment.h"

namespace volcal {

/// Throws InputError as align_result() says, but for what depends on bases and lines of rotary axes.
void check_alignment(const FitResult& result, const Alignment& alignment);

}  // namespace volcal
