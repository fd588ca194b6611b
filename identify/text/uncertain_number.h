#pragma once
/// A value with its uncertainty as text.

#include <string>

namespace volcal {

/// "11.0 +- 2.1": U to two significant digits or to the unit where it is larger, the value to the same
/// decimals (GUM 7.2.6). Without a positive, finite U three digits of the value, two of U.
std::string value_with_u(double value, double u);

}  // namespace volcal
