#pragma once
/// Effects as the user writes them: a target and an expression.

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect.h"
#include "volcal/model/effects/kinds/open/custom.h"

namespace volcal {

struct WrittenEffect {
  EffectSpec spec;
  std::unique_ptr<Effect> made;
};

/// Wrong at a place of the text. `what()` names the option, the text and the column; told() is the problem
/// alone.
class WrittenEffectError : public InputError {
 public:
  WrittenEffectError(const std::string& option, const std::string& text, std::size_t column,
                     const std::string& problem, const std::string& remedy);

  std::size_t column() const { return column_; }  ///< from 1
  const std::string& told() const { return told_; }

 private:
  std::size_t column_;
  std::string told_;
};

/// "EZX: x y" or "EXX: dir_x T_column" as an effect of kind empirical, directions as its factors. Throws
/// InputError that names `option`.
EffectSpec written_surface(const std::string& option, const std::string& text);

/// The `option` of a line of a session, in which parameters stand behind `with`.
inline constexpr const char* kFormulaLine = "formula";
/// The same of the page, which has a field "Start values".
inline constexpr const char* kFormulaBox = "formula box";

/// "EZX: abs(x) / 400 * dir_x" or "EXX += dir_x * (T_column - 20)" as an effect of kind custom; `parameters`:
/// "p=250" (held) or "p=250+-50" (estimated). Throws InputError that names `option`, WrittenEffectError where
/// the text is wrong.
WrittenEffect written_effect(const std::string& option, const std::string& text,
                             const std::vector<std::string>& parameters);
/// What a campaign cannot have of a text that written_effect() took, as WrittenEffectError; an error of
/// another effect as it is.
[[noreturn]] void rethrow_at_its_column(const std::string& option, const std::string& text,
                                        const CustomEffectError& error);
/// What `work` gives that has to do with the text.
template <class Work>
auto at_its_column(const std::string& option, const std::string& text, const Work& work) {
  try {
    return work();
  } catch (const CustomEffectError& error) {
    rethrow_at_its_column(option, text, error);
  }
}
/// Several of them. A parameter goes to those that use it; throws InputError where none does.
std::vector<WrittenEffect> written_effects(const std::string& option, const std::vector<std::string>& texts,
                                           const std::vector<std::string>& parameters);

}  // namespace volcal
