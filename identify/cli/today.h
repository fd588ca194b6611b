#pragma once
#include <string>

namespace volcal::cli {

/// Local date, as in 2026-01-31.
std::string today();

}  // namespace volcal::cli
