#pragma once
/// The present time, as what is written states it.

#include <ctime>
#include <string>

namespace volcal {

/// Now, or the time that the environment fixes by SOURCE_DATE_EPOCH. Throws InputError when that is no time.
std::time_t present_time();

/// That in UTC by ISO 8601, as in 2026-01-31T14:05:09Z.
std::string present_time_text();

/// Local date, as in 2026-01-31; that of SOURCE_DATE_EPOCH in UTC.
std::string today();

}  // namespace volcal
