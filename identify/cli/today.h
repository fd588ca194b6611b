#pragma once
#include <ctime>
#include <string>

namespace volcal::cli {

/// Now, or the time that the environment fixes by SOURCE_DATE_EPOCH. Throws InputError when that is no time.
std::time_t present_time();

/// Local date, as in 2026-01-31; that of SOURCE_DATE_EPOCH in UTC.
std::string today();

}  // namespace volcal::cli
