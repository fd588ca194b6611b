#include "volcal/identify/cli/today.h"

#include <fmt/chrono.h>

#include <ctime>

namespace volcal::cli {

std::string today() { return fmt::format("{:%Y-%m-%d}", fmt::localtime(std::time(nullptr))); }

}  // namespace volcal::cli
