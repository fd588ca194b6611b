#include "volcal/model/effects/expression.h"

#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <numbers>
#include <utility>

namespace volcal {
namespace {

/// Letters outside ASCII as well: all bytes of them.
bool starts_name(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x80 || std::isalpha(byte) != 0 || c == '_';
}
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool continues_name(char c) { return starts_name(c) || is_digit(c); }

/// A name in a formula; `called`: a parenthesis follows.
struct Name {
  std::string text;
  std::size_t at = 0;
  bool called = false;
};

/// Index after a number such as 2, .5 or 1.5e-3 that begins at `at`.
std::size_t after_number(const std::string& text, std::size_t at) {
  while (at < text.size() && (is_digit(text[at]) || text[at] == '.')) ++at;
  if (at == text.size() || (text[at] != 'e' && text[at] != 'E')) return at;
  std::size_t exponent = at + 1;
  if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
  if (exponent == text.size() || !is_digit(text[exponent])) return at;
  while (exponent < text.size() && is_digit(text[exponent])) ++exponent;
  return exponent;
}

std::vector<Name> names_of(const std::string& text) {
  std::vector<Name> names;
  for (std::size_t at = 0; at < text.size();) {
    if (is_digit(text[at]) || text[at] == '.') {
      at = after_number(text, at);
    } else if (starts_name(text[at])) {
      const std::size_t begin = at;
      while (at < text.size() && continues_name(text[at])) ++at;
      const std::size_t next = text.find_first_not_of(' ', at);
      names.push_back(
          {text.substr(begin, at - begin), begin, next != std::string::npos && text[next] == '('});
    } else {
      ++at;
    }
  }
  return names;
}

constexpr std::size_t kLongestExpression = 4000;  // characters; muParser takes less than 5000
constexpr int kDeepestParentheses = 100;

void refuse_size(const std::string& text) {
  if (text.size() > kLongestExpression)
    throw ExpressionError("it is longer than " + std::to_string(kLongestExpression) +
                              " characters; write a shorter one, or several effects",
                          kLongestExpression + 1, text.substr(kLongestExpression, 1));
  int depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == ')') --depth;
    if (text[at] == '(' && ++depth > kDeepestParentheses)
      throw ExpressionError("its parentheses are nested more than " + std::to_string(kDeepestParentheses) +
                                " deep; write it with fewer",
                            at + 1, "(");
  }
}

std::string name_characters() {
  std::string all;
  for (int byte = 1; byte < 256; ++byte) {
    if (continues_name(static_cast<char>(byte))) all += static_cast<char>(byte);
  }
  return all;
}

mu::Parser parser_of(const std::string& text) {
  static const std::string names = name_characters();
  mu::Parser parser;
  parser.DefineNameChars(names.c_str());
  parser.DefineConst("pi", std::numbers::pi);
  parser.SetExpr(text);
  return parser;
}

std::string problem_of(const mu::ParserError& error) {
  switch (error.GetCode()) {
    case mu::ecUNEXPECTED_OPERATOR:
      return "an operator stands where a value is expected";
    case mu::ecUNEXPECTED_EOF:
      return "it ends where a value is expected";
    case mu::ecUNEXPECTED_ARG_SEP:
      return "a comma stands outside of a function";
    case mu::ecUNEXPECTED_PARENS:
    case mu::ecMISSING_PARENS:
      return "its parentheses do not match";
    case mu::ecUNEXPECTED_VAL:
    case mu::ecUNEXPECTED_VAR:
    case mu::ecUNEXPECTED_FUN:
      return "an operator is missing";
    case mu::ecTOO_MANY_PARAMS:
      return "a function has too many arguments";
    case mu::ecTOO_FEW_PARAMS:
      return "a function has too few arguments";
    default:
      return "it cannot be read";
  }
}

[[noreturn]] void fail_to_read(const std::string& text, const mu::ParserError& error) {
  const auto at = static_cast<std::size_t>(std::max(0, error.GetPos()));
  const std::string token = error.GetToken().substr(0, error.GetToken().find_last_not_of(' ') + 1);
  throw ExpressionError(problem_of(error), std::min(at, text.size()) + 1, at < text.size() ? token : "");
}

/// `=` that is not part of a comparison: in muParser it would assign.
void refuse_assignment(const std::string& text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] != '=') continue;
    const bool compares = at > 0 && (text[at - 1] == '<' || text[at - 1] == '>' || text[at - 1] == '!');
    const bool equals = at + 1 < text.size() && text[at + 1] == '=';
    if (!compares && !equals) throw ExpressionError("a comparison is written ==, <, >", at + 1, "=");
    if (equals) ++at;
  }
}

}  // namespace

ExpressionError::ExpressionError(const std::string& problem, std::size_t character, std::string token)
    : std::runtime_error(problem + ", at character " + std::to_string(character) +
                         (token.empty() ? " (the end)" : ", \"" + token + "\"")),
      problem_(problem),
      character_(character),
      token_(std::move(token)) {}

Expression::Expression(std::string text, const IsVariable& is_variable) : text_(std::move(text)) {
  refuse_size(text_);
  try {
    mu::Parser parser = parser_of(text_);
    for (const Name& name : names_of(text_)) {
      if (name.called && parser.GetFunDef().contains(name.text)) continue;
      if (!name.called && parser.GetConst().contains(name.text)) continue;
      if (name.called) throw ExpressionError("a function of this name is not known", name.at + 1, name.text);
      if (!is_variable(name.text))
        throw ExpressionError("a variable of this name is not known", name.at + 1, name.text);
      if (uses(name.text)) continue;
      variables_.push_back(name.text);
      characters_.push_back(name.at + 1);
    }
    refuse_assignment(text_);
    double anything = 1.0;
    for (const std::string& variable : variables_) parser.DefineVar(variable, &anything);
    int results = 0;
    parser.Eval(results);
    if (results != 1) {
      throw ExpressionError("a comma stands outside of a function", text_.find(',') + 1, ",");
    }
  } catch (const mu::ParserError& error) {
    fail_to_read(text_, error);
  }
}

bool Expression::uses(const std::string& variable) const {
  return std::ranges::find(variables_, variable) != variables_.end();
}

std::size_t Expression::character_of(const std::string& variable) const {
  const auto found = std::ranges::find(variables_, variable);
  return found == variables_.end() ? 0 : characters_[static_cast<std::size_t>(found - variables_.begin())];
}

Eigen::VectorXd Expression::evaluate(const Eigen::MatrixXd& values) const try {
  mu::Parser parser = parser_of(text_);
  std::vector<double> current(variables_.size());
  for (std::size_t k = 0; k < variables_.size(); ++k) parser.DefineVar(variables_[k], &current[k]);
  Eigen::VectorXd result(values.rows());
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    for (std::size_t k = 0; k < current.size(); ++k) current[k] = values(row, static_cast<Eigen::Index>(k));
    result[row] = parser.Eval();
  }
  return result;
} catch (const mu::ParserError& error) {
  fail_to_read(text_, error);
}

std::vector<std::string> Expression::function_names() {
  const mu::Parser parser;
  std::vector<std::string> names;
  for (const auto& [name, callback] : parser.GetFunDef()) names.push_back(name);
  return names;
}

}  // namespace volcal
