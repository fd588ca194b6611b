#pragma once
/// Effects that are written: a target and a formula.

#include <string>

#include "volcal/model/effects/effect.h"
#include "volcal/model/effects/expression.h"

namespace volcal {

/// Throws ExpressionError for a formula that a custom effect cannot use: it cannot be read, or names what no
/// reading has.
Expression custom_expression(const std::string& formula);
/// written_spec("EXX", "dir_x * x / 400"); its amplitude is unknown.
EffectSpec written_spec(const std::string& target, const std::string& expression);
/// "variables are x y z ...; functions are abs ...".
std::string custom_expression_names();

}  // namespace volcal
