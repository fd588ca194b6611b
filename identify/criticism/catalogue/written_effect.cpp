#include "volcal/identify/criticism/catalogue/written_effect.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/kinds/open/custom.h"
#include "volcal/model/effects/kinds/open/empirical.h"
#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/written_target.h"

namespace volcal {
namespace {

const std::string kForm =
    "write \"TARGET: expression\" or \"TARGET += expression\", as in \"EZX: abs(x) / 400 * dir_x\"";

[[noreturn]] void refuse_effect(const std::string& option, const std::string& text, std::size_t column,
                                const std::string& problem, const std::string& remedy) {
  throw WrittenEffectError(option, text, column, problem, remedy);
}

/// Text between two indices with the spaces at its ends taken off; `at`: where it begins.
struct Piece {
  std::string text;
  std::size_t at = 0;
};

Piece trimmed_piece(const std::string& text, std::size_t begin, std::size_t end) {
  while (begin < end && text[begin] == ' ') ++begin;
  while (end > begin && text[end - 1] == ' ') --end;
  return {text.substr(begin, end - begin), begin};
}

struct TargetAndExpression {
  Piece target, expression;
};

/// The first ": " or "+=" parts the two; an expression may hold further colons, as in x > 0 ? 1 : 2.
TargetAndExpression parted(const std::string& option, const std::string& text) {
  const std::size_t colon = text.find(':'), plus = text.find("+=");
  const bool adds = plus < colon;
  const std::size_t end = adds ? plus : colon;
  if (end == std::string::npos) refuse_effect(option, text, text.size() + 1, "it names no target", kForm);
  TargetAndExpression parts{trimmed_piece(text, 0, end),
                            trimmed_piece(text, end + (adds ? 2 : 1), text.size())};
  if (parts.target.text.empty()) refuse_effect(option, text, 1, "it names no target", kForm);
  if (parts.expression.text.empty())
    refuse_effect(option, text, text.size() + 1, "the expression is missing", kForm);
  return parts;
}

/// A parameter's value and, where it is to be estimated, its standard uncertainty before the fit.
struct Parameter {
  std::string name;
  double value = 0.0;
  std::optional<double> sigma;
};

std::optional<double> finite_number(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return whole ? std::optional(value) : std::nullopt;
}

/// "--parameter p=250", or in a line of a session "with p=250".
std::string as_given(const std::string& option, const std::string& parameter) {
  if (option == kFormulaBox) return "start value " + parameter;
  return (option == kFormulaLine ? "with " : "--parameter ") + parameter;
}

std::string how_to_give(const std::string& option, const std::string& name) {
  if (option == kFormulaBox)
    return fmt::format("write {0}=250 (held) or {0}=250+-50 (estimated) as start values", name);
  const char* begin = option == kFormulaLine ? "end the line " : "add ";
  return fmt::format("{}{} (held) or {} (estimated)", begin, as_given(option, name + "=250"),
                     as_given(option, name + "=250+-50"));
}

Parameter parameter_of(const std::string& option, const std::string& text) {
  const std::size_t equals = text.find('='), spread = text.find("+-");
  const std::string remedy =
      "write p=250 (held) or p=250+-50 (estimated, from 250 with a standard uncertainty of 50)";
  const std::string what = as_given(option, text) + ": ";
  if (equals == std::string::npos) throw InputError({}, what + "it has no value", remedy);
  Parameter parameter{.name = text.substr(0, equals), .value = 0.0, .sigma = {}};
  if (parameter.name != "p" && parameter.name != "q")
    throw InputError({}, what + "parameters of an expression are p and q", remedy);
  const auto value =
      finite_number(text.substr(equals + 1, spread == std::string::npos ? spread : spread - equals - 1));
  if (!value) throw InputError({}, what + "its value is not a number", remedy);
  parameter.value = *value;
  if (spread == std::string::npos) return parameter;
  const auto sigma = finite_number(text.substr(spread + 2));
  if (!sigma || *sigma <= 0.0)
    throw InputError({}, what + "its standard uncertainty is not a number greater than 0", remedy);
  parameter.sigma = sigma;
  return parameter;
}

void set_parameters(const std::string& option, const std::string& text, const Piece& expression,
                    const std::vector<std::string>& given, EffectSpec& spec) {
  const Expression formula = custom_expression(expression.text);
  for (const std::string& each : given) {
    const Parameter parameter = parameter_of(option, each);
    if (spec.options.number(parameter.name))
      throw InputError({}, as_given(option, each) + ": " + parameter.name + " is given twice",
                       "leave one out");
    if (!formula.uses(parameter.name))
      throw InputError({}, as_given(option, each) + ": the expression does not use " + parameter.name,
                       "leave it out, or write " + parameter.name + " into the expression");
    spec.options.set(parameter.name, parameter.value);
    if (parameter.sigma) spec.options.set(parameter.name + "_sigma", *parameter.sigma);
  }
  for (const std::string name : {"p", "q"}) {
    if (!formula.uses(name) || spec.options.number(name)) continue;
    refuse_effect(option, text, expression.at + formula.character_of(name),
                  "the expression uses " + name + ", which has no value", how_to_give(option, name));
  }
}

}  // namespace

WrittenEffectError::WrittenEffectError(const std::string& option, const std::string& text, std::size_t column,
                                       const std::string& problem, const std::string& remedy)
    : InputError({}, fmt::format("{} \"{}\", column {}: {}", option, text, column, problem), remedy),
      column_(column),
      told_(problem) {}

EffectSpec written_surface(const std::string& option, const std::string& text) {
  const std::string form = "write \"TARGET: DRIVERS\", one to three drivers, as in \"EZX: x y\"";
  const std::size_t colon = text.find(':');
  const Piece target = trimmed_piece(text, 0, std::min(colon, text.size()));
  if (colon == std::string::npos || target.text.empty())
    throw InputError({}, fmt::format("{} \"{}\": it names no target", option, text), form);
  std::string drivers, factor;
  for (const std::string& word : words_in(text.substr(colon + 1))) {
    const auto variable = Variable::parse_written(word);
    std::string& list = variable && variable->kind == Variable::Kind::Direction ? factor : drivers;
    list += (list.empty() ? "" : " ") + word;
  }
  EffectSpec spec = surface_spec(target.text, drivers);
  if (!factor.empty()) spec.options.set("factor", factor);
  try {
    find_effect(spec.kind)->make(spec, {});
  } catch (const InputError& error) {
    throw InputError({}, fmt::format("{} \"{}\": {}", option, text, error.problem()),
                     error.remedy() + "; " + form);
  }
  return spec;
}

namespace {

bool is_target(const EffectSpec& spec) {
  try {
    written_target(EffectTable(spec, {}));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

WrittenEffect written_effect(const std::string& option, const std::string& text,
                             const std::vector<std::string>& parameters) {
  const auto [target, expression] = parted(option, text);
  WrittenEffect effect;
  effect.spec = written_spec(target.text, expression.text);
  try {
    set_parameters(option, text, expression, parameters, effect.spec);
  } catch (const ExpressionError& error) {
    const std::string token = error.token().empty() ? "at the end" : "\"" + error.token() + "\"";
    refuse_effect(option, text, expression.at + error.character(), error.problem() + ", " + token,
                  custom_expression_names());
  }
  try {
    effect.made = find_effect(effect.spec.kind)->make(effect.spec, {});
  } catch (const InputError& error) {
    refuse_effect(option, text, (is_target(effect.spec) ? expression.at : target.at) + 1, error.problem(),
                  error.remedy());
  }
  return effect;
}

void rethrow_at_its_column(const std::string& option, const std::string& text,
                           const CustomEffectError& error) {
  const auto [target, expression] = parted(option, text);
  if (expression.text != error.expression()) throw CustomEffectError(error);
  const std::size_t column = error.character() ? expression.at + *error.character() : target.at + 1;
  refuse_effect(option, text, column, error.told(), error.remedy());
}

namespace {

/// Whether an expression can be read and uses a name.
bool uses(const std::string& option, const std::string& text, const std::string& name) {
  try {
    return custom_expression(parted(option, text).expression.text).uses(name);
  } catch (const ExpressionError&) {
    return false;
  }
}

}  // namespace

std::vector<WrittenEffect> written_effects(const std::string& option, const std::vector<std::string>& texts,
                                           const std::vector<std::string>& parameters) {
  std::vector<std::vector<std::string>> of_text(texts.size());
  for (const std::string& each : parameters) {
    const std::string name = parameter_of(option, each).name;
    bool used = false;
    for (std::size_t i = 0; i < texts.size(); ++i) {
      if (texts.size() > 1 && !uses(option, texts[i], name)) continue;
      of_text[i].push_back(each);
      used = true;
    }
    if (!used)
      throw InputError({}, "--parameter " + each + ": no expression of " + option + " uses " + name,
                       "leave it out, or write " + name + " into one of the expressions");
  }
  std::vector<WrittenEffect> effects;
  for (std::size_t i = 0; i < texts.size(); ++i)
    effects.push_back(written_effect(option, texts[i], of_text[i]));
  return effects;
}

}  // namespace volcal
