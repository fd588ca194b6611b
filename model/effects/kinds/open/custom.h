#pragma once
/// Effects that are written: a target and a formula.

#include <optional>
#include <string>

#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect.h"
#include "volcal/model/effects/expression.h"

namespace volcal {

/// Throws ExpressionError for a formula that a custom effect cannot use: it cannot be read, or names what no
/// reading has.
Expression custom_expression(const std::string& formula);
/// written_spec("EXX", "dir_x * x / 400"); its amplitude is unknown.
EffectSpec written_spec(const std::string& target, const std::string& expression);
/// A campaign cannot have what an effect of kind custom names, or its expression has no value somewhere.
class CustomEffectError : public InputError {
 public:
  /// `character`: of the expression, from 1; none: the target is wrong.
  CustomEffectError(const InputError& error, std::string expression, std::optional<std::size_t> character);

  const std::string& expression() const { return expression_; }
  std::optional<std::size_t> character() const { return character_; }
  const std::string& told() const { return told_; }  ///< problem() without the place in the expression

 private:
  std::string expression_, told_;
  std::optional<std::size_t> character_;
};
/// "variables are x y z ...; functions are abs ...".
std::string custom_expression_names();

}  // namespace volcal
