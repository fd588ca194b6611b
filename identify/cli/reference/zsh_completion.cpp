#include <CLI/CLI.hpp>
#include <algorithm>

#include "volcal/identify/cli/reference/completions.h"

namespace volcal::cli {
namespace {

/// Between single quotes.
std::string zsh_quoted(const std::string& text) {
  std::string quoted;
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return "'" + quoted + "'";
}

/// With a backslash before each of `characters`.
std::string zsh_escaped(const std::string& text, const std::string& characters) {
  std::string escaped;
  for (const char c : text) {
    if (characters.find(c) != std::string::npos) escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string zsh_function(const CommandEntry& command) {
  std::string name = "_" + command.name('_');
  std::ranges::replace(name, '-', '_');
  return name;
}

/// ":what:how" of a value.
std::string zsh_value(const OptionEntry& option, const std::string& what) {
  std::string action = takes_file(option) ? "_files" : " ";
  if (!option.choices.empty()) {
    action = "(";
    for (const std::string& choice : option.choices) action += (action.size() > 1 ? " " : "") + choice;
    action += ")";
  }
  return ":" + zsh_escaped(what, ":\\") + ":" + action;
}

std::string zsh_option(const OptionEntry& option) {
  const std::string help = "[" + zsh_escaped(brief_help(option.help), "[]\\") + "]";
  const std::string value = option.value.empty() ? "" : zsh_value(option, option.value);
  std::string others;
  for (const std::string& name : option.names) others += (others.empty() ? "" : " ") + name;
  const std::string before = option.repeated ? "*" : option.names.size() > 1 ? "(" + others + ")" : "";
  std::string text;
  for (const std::string& name : option.names) text += " \\\n    " + zsh_quoted(before + name + help + value);
  return text;
}

std::string zsh_command(const CommandEntry& command) {
  std::string text = zsh_function(command) + "() {\n";
  if (!command.commands.empty()) {
    text += "  if (( CURRENT > 2 )); then\n    case $words[2] in\n";
    for (const CommandEntry& sub : command.commands)
      text += "      " + sub.path.substr(sub.path.rfind(' ') + 1) + ") shift words; (( CURRENT-- )); " +
              zsh_function(sub) + "; return ;;\n";
    text += "    esac\n  fi\n  local -a volcal_commands=(\n";
    for (const CommandEntry& sub : command.commands)
      text += "    " + zsh_quoted(sub.path.substr(sub.path.rfind(' ') + 1) + ":" + brief_help(sub.summary)) +
              "\n";
    text += "  )\n  [[ $words[CURRENT] == -* ]] || _describe command volcal_commands\n";
  }
  text += "  _arguments -s";
  for (const OptionEntry& option : command.options) text += zsh_option(option);
  int place = 1;
  for (const OptionEntry& operand : command.operands)
    text += " \\\n    " +
            zsh_quoted((operand.repeated ? "*" : std::to_string(place++) + (operand.required ? "" : ":")) +
                       zsh_value(operand, operand.names.front()));
  return text + "\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandEntry& program) {
  std::string text =
      "#compdef volcal\n# zsh completion for volcal; written by `volcal help --completion zsh`.\n\n";
  for (const CommandEntry* command : all_commands(program)) text += zsh_command(*command);
  return text + "_volcal \"$@\"\n";
}

}  // namespace volcal::cli
