#pragma once
/// The formula of a custom effect.

#include <string>

#include "volcal/model/effects/expression.h"

namespace volcal {

/// Throws ExpressionError for a formula that a custom effect cannot use: it cannot be read, or names what no
/// reading has.
Expression custom_expression(const std::string& formula);
/// "variables are x y z ...; functions are abs ...".
std::string custom_expression_names();

}  // namespace volcal
