#pragma once
/// A result with what it was made from.

#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/python/shared/arrays.h"

namespace volcal::python {

struct Result {
  FitResult result;
  std::shared_ptr<const Campaign> campaign;  ///< null where it was read from files
  std::string path = {};                     ///< of these files
};

/// A text as HTML shows it.
std::string escaped(const std::string& text);

/// A table of its errors with small plots, self-contained: what a notebook shows.
std::string result_html(const Result& result);

/// Residuals without a copy: one record per observation, of memory that `owner` keeps alive.
py::array residual_view(const std::vector<ResidualRecord>& residuals, const py::handle& owner);

/// Version of volcal, the present time, and the Python that does the same.
Provenance provenance_of(const std::string& python);

}  // namespace volcal::python
