#pragma once
/// What is done in a session as lines of text: the page of the workbench, `volcal session` and a kept list of
/// commands do the same by the same words.
///
///   add reversal:EYY:dir_y:step       a linear preview with the effect; of a drawn surface or of several
///                                     effects that cannot be previewed, a full fit
///   remove reversal:EYY:dir_y:step
///   formula EXX += dir_x * (T_column - 20) with p=250+-50
///   refit  |  refit 2                 a preview with its noise found again, of the current model or another
///   confirm  |  confirm 2             a full fit of the current model, or of another one
///   climb                             the search of a diagnosis, to its end
///   draw 1                            a surface for the first of what has no name
///   leave-out 12-15,40 cable moved    observations, from 0, and the reason
///   undo  |  redo  |  go 2

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/session/session.h"

namespace volcal {

struct SessionCommand {
  enum class Verb { Add, Remove, Formula, Refit, Confirm, Climb, Draw, LeaveOut, Undo, Redo, Go };
  Verb verb = Verb::Undo;
  EffectName effect = {};    ///< Add, Remove
  std::string formula = {};  ///< as written, with its target
  std::vector<std::string> parameters = {};
  std::optional<std::size_t> number = {};  ///< Refit, Confirm, Go: a model; Draw: from 0
  std::vector<std::size_t> observations = {};
  std::string reason = {};
};

/// Throws InputError.
SessionCommand session_command_from(const std::string& line);
std::string to_string(const SessionCommand& command);

/// "kind:target:driver:shape"; the last part may hold colons. Throws InputError.
EffectName effect_name_from(const std::string& text);

/// Does the command at once, or gives the work that it takes. Throws InputError where the session has nothing
/// that the command could act on.
std::optional<SessionWork> begin(Session& session, const SessionCommand& command);

}  // namespace volcal
