#pragma once
/// What names can explain of a model: added, compared with their rivals, and rejected where they are no
/// names.

#include "volcal/identify/criticism/search/reached.h"

namespace volcal {

/// A climb (climb.h), the comparison with rivals (rivals.h), the climb again after every change; then what is
/// no name is rejected (rejection.h), or a rival that stands takes its place. Tested.
Reached explained(Reached from, const SearchOptions& options);

}  // namespace volcal
