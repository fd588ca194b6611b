#pragma once
/// A formula that a user writes, read by muParser: numbers, + - * / ^, comparisons, && ||, condition ? a : b,
/// the functions of function_names(), the constant pi, and variables.

#include <Eigen/Core>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace volcal {

/// Why a formula cannot be used; `what()` names the character (from 1) and what stands there.
class ExpressionError : public std::runtime_error {
 public:
  ExpressionError(const std::string& problem, std::size_t character, std::string token);
  const std::string& problem() const { return problem_; }  ///< without the place
  std::size_t character() const { return character_; }
  const std::string& token() const { return token_; }

 private:
  std::string problem_;
  std::size_t character_;
  std::string token_;
};

/// Immutable, so thread-safe.
class Expression {
 public:
  using IsVariable = std::function<bool(const std::string& name)>;

  /// Throws ExpressionError when the formula cannot be read, or uses a name that is no variable.
  Expression(std::string text, const IsVariable& is_variable);

  const std::string& text() const { return text_; }
  /// Variables of the formula, each once, in the order in which they first appear.
  const std::vector<std::string>& variables() const { return variables_; }
  bool uses(const std::string& variable) const;
  /// Where a variable first stands, from 1; 0 when the formula does not use it.
  std::size_t character_of(const std::string& variable) const;
  /// One value per row; columns of `values` are the variables(). A value may be infinite or not a number.
  Eigen::VectorXd evaluate(const Eigen::MatrixXd& values) const;

  /// "abs", "sin" ... that a formula may call.
  static std::vector<std::string> function_names();

 private:
  std::string text_;
  std::vector<std::string> variables_;
  std::vector<std::size_t> characters_;  ///< of the variables
};

}  // namespace volcal
