#pragma once
/// Rules of the search in options of studies.

#include <string>
#include <vector>

namespace volcal::cli {

/// "one-cause", ... in their order.
std::vector<std::string> names_of_rules();
/// "rules of the search: one-cause (a curve takes the place of two names), ..."
std::string described_rules();

}  // namespace volcal::cli
