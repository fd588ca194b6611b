#pragma once
/// Findings of the library as Python objects.

#include <vector>

#include "volcal/model/description/finding.h"
#include "volcal/python/shared/bindings.h"

namespace volcal::python {

/// A list of volcal.Finding.
py::list findings_of(const std::vector<Finding>& findings);

}  // namespace volcal::python
