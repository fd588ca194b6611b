#include "volcal/identify/session/session_command.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "volcal/identify/criticism/catalogue/written_effect.h"
#include "volcal/identify/criticism/data/effect_words.h"

namespace volcal {
namespace {

const std::string kCommands =
    "commands are add NAME, remove NAME, formula TARGET += EXPRESSION, refit, confirm, climb, draw N, "
    "leave-out OBSERVATIONS REASON, undo, redo, go N";

struct VerbWord {
  SessionCommand::Verb verb;
  const char* word;
};
constexpr VerbWord kVerbs[] = {{SessionCommand::Verb::Add, "add"},
                               {SessionCommand::Verb::Remove, "remove"},
                               {SessionCommand::Verb::Formula, "formula"},
                               {SessionCommand::Verb::Refit, "refit"},
                               {SessionCommand::Verb::Confirm, "confirm"},
                               {SessionCommand::Verb::Climb, "climb"},
                               {SessionCommand::Verb::Draw, "draw"},
                               {SessionCommand::Verb::LeaveOut, "leave-out"},
                               {SessionCommand::Verb::Undo, "undo"},
                               {SessionCommand::Verb::Redo, "redo"},
                               {SessionCommand::Verb::Go, "go"}};

[[noreturn]] void refuse_command(const std::string& problem, const std::string& remedy = kCommands) {
  throw InputError({}, problem, remedy);
}

/// What stands before the first blank, and what behind it.
std::pair<std::string, std::string> first_word(const std::string& line) {
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t end = std::min(line.find(' ', begin), line.size());
  const std::size_t rest = std::min(line.find_first_not_of(' ', end), line.size());
  const std::size_t last = line.find_last_not_of(' ');
  return {line.substr(begin, end - begin),
          last == std::string::npos ? "" : line.substr(rest, last + 1 - rest)};
}

std::size_t whole_number(const std::string& text, const std::string& what) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.empty())
    refuse_command("\"" + text + "\" is not the number of " + what, "give a whole number");
  return value;
}

std::size_t place_from_one(const std::string& text) {
  const std::size_t number = whole_number(text, "a finding");
  if (number == 0) refuse_command("findings are counted from 1", "draw 1");
  return number - 1;
}

/// "12-15,40"
std::vector<std::size_t> observations_from(const std::string& text) {
  constexpr std::size_t kMost = 100'000'000;
  std::vector<std::size_t> observations;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, end - at);
    const std::size_t dash = part.find('-');
    const std::size_t from = whole_number(part.substr(0, dash), "an observation");
    const std::size_t to =
        dash == std::string::npos ? from : whole_number(part.substr(dash + 1), "an observation");
    if (to < from || to > kMost)
      refuse_command("\"" + part + "\" is not a range of observations", "write 12-15");
    for (std::size_t each = from; each <= to; ++each) observations.push_back(each);
    at = end + 1;
  }
  std::ranges::sort(observations);
  observations.erase(std::unique(observations.begin(), observations.end()), observations.end());
  return observations;
}

std::string observations_text(const std::vector<std::size_t>& observations) {
  std::string text;
  for (std::size_t i = 0; i < observations.size();) {
    std::size_t last = i;
    while (last + 1 < observations.size() && observations[last + 1] == observations[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(observations[i]);
    if (last > i) text += "-" + std::to_string(observations[last]);
    i = last + 1;
  }
  return text;
}

void set_formula(const std::string& text, SessionCommand& command) {
  const std::size_t with = text.find(" with ");
  command.formula = text.substr(0, with);
  if (with == std::string::npos) return;
  std::string rest = text.substr(with + 6);
  while (!rest.empty()) {
    auto [word, after] = first_word(rest);
    if (!word.empty()) command.parameters.push_back(word);
    rest = after;
  }
}

void set_left_out(const std::string& text, SessionCommand& command) {
  const auto [observations, reason] = first_word(text);
  if (reason.empty())
    refuse_command("the reason for leaving out the readings is missing", "leave-out 12-15 cable moved");
  command.observations = observations_from(observations);
  command.reason = reason;
}

void set_rest(const std::string& rest, SessionCommand& command) {
  using Verb = SessionCommand::Verb;
  switch (command.verb) {
    case Verb::Add:
    case Verb::Remove:
      command.effect = effect_name_from(rest);
      return;
    case Verb::Formula:
      return set_formula(rest, command);
    case Verb::LeaveOut:
      return set_left_out(rest, command);
    case Verb::Go:
      command.number = whole_number(rest, "a model");
      return;
    case Verb::Refit:
    case Verb::Confirm:
      if (!rest.empty()) command.number = whole_number(rest, "a model");
      return;
    case Verb::Draw:
      command.number = rest.empty() ? 0 : place_from_one(rest);
      return;
    case Verb::Climb:
    case Verb::Undo:
    case Verb::Redo:
      if (!rest.empty()) refuse_command("\"" + rest + "\" stands behind a command that takes nothing");
  }
}

std::string rest_text(const SessionCommand& command) {
  using Verb = SessionCommand::Verb;
  switch (command.verb) {
    case Verb::Add:
    case Verb::Remove:
      return full_name(command.effect);
    case Verb::Formula: {
      std::string text = command.formula;
      for (std::size_t i = 0; i < command.parameters.size(); ++i)
        text += (i == 0 ? " with " : " ") + command.parameters[i];
      return text;
    }
    case Verb::LeaveOut:
      return observations_text(command.observations) + " " + command.reason;
    case Verb::Draw:
      return std::to_string(command.number.value_or(0) + 1);
    case Verb::Go:
    case Verb::Refit:
    case Verb::Confirm:
      return command.number ? std::to_string(*command.number) : "";
    case Verb::Climb:
    case Verb::Undo:
    case Verb::Redo:
      break;
  }
  return {};
}

std::vector<bool> marked(const Session& session, const std::vector<std::size_t>& observations) {
  std::vector<bool> selected(session.linear().size(), false);
  for (const std::size_t observation : observations) {
    if (observation >= selected.size())
      refuse_command("there is no observation " + std::to_string(observation),
                     "there are " + std::to_string(selected.size()) + ", numbered from 0");
    selected[observation] = true;
  }
  return selected;
}

bool is_drawn(const Session& session, const EffectName& effect) {
  return std::ranges::find(session.drawn(), effect, &SurfaceFinding::name) != session.drawn().end();
}

void require_model(const Session& session, std::size_t number) {
  if (number >= session.models().size())
    refuse_command("there is no model " + std::to_string(number),
                   "models are numbered from 0 to " + std::to_string(session.models().size() - 1));
}

std::optional<SessionWork> begin_command(Session& session, const SessionCommand& command) {
  using Verb = SessionCommand::Verb;
  switch (command.verb) {
    case Verb::Add:
      if (is_drawn(session, command.effect)) return session.surface(command.effect);
      session.add(command.effect);
      return std::nullopt;
    case Verb::Remove:
      if (!session.is_preview(command.effect)) return session.removal(command.effect);
      session.remove_preview(command.effect);
      return std::nullopt;
    case Verb::Formula:
      at_its_column(kFormulaLine, command.formula, [&] {
        session.formula(written_effect(kFormulaLine, command.formula, command.parameters).spec);
      });
      return std::nullopt;
    case Verb::Refit:
      if (command.number) require_model(session, *command.number);
      return session.refit(command.number.value_or(session.current().number));
    case Verb::Confirm:
      if (command.number) require_model(session, *command.number);
      return session.confirmation(command.number.value_or(session.current().number));
    case Verb::Climb:
      return session.climb();
    case Verb::Draw:
      if (*command.number >= session.unknown().size())
        refuse_command("there is no unknown " + std::to_string(*command.number + 1),
                       std::to_string(session.unknown().size()) + " findings have no name in this model");
      return session.drawing(*command.number);
    case Verb::LeaveOut:
      return session.leaving_out(marked(session, command.observations), command.reason);
    case Verb::Undo:
      if (!session.undo()) refuse_command("there is nothing to undo", "this is the model as given");
      return std::nullopt;
    case Verb::Redo:
      if (!session.redo()) refuse_command("there is nothing to do again", "undo comes before");
      return std::nullopt;
    case Verb::Go:
      require_model(session, *command.number);
      session.go_to(*command.number);
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

EffectName effect_name_from(const std::string& text) {
  std::optional<EffectName> name = EffectName::parse(text);
  if (!name)
    refuse_command("\"" + text + "\" is not the name of an effect", "write KIND:TARGET:DRIVER:SHAPE");
  return *std::move(name);
}

SessionCommand session_command_from(const std::string& line) {
  const auto [word, rest] = first_word(line);
  const auto known = std::ranges::find(kVerbs, word, &VerbWord::word);
  if (known == std::end(kVerbs)) refuse_command("\"" + word + "\" is not a command of a session");
  SessionCommand command;
  command.verb = known->verb;
  set_rest(rest, command);
  return command;
}

std::string to_string(const SessionCommand& command) {
  const std::string rest = rest_text(command);
  return std::ranges::find(kVerbs, command.verb, &VerbWord::verb)->word + (rest.empty() ? "" : " " + rest);
}

std::optional<SessionWork> begin(Session& session, const SessionCommand& command) {
  try {
    return begin_command(session, command);
  } catch (const std::invalid_argument& error) {
    throw InputError({}, error.what(), "choose one of the list of this model");
  }
}

}  // namespace volcal
