#include <CLI/CLI.hpp>
#include <algorithm>

#include "volcal/identify/cli/reference/completions.h"

namespace volcal::cli {
namespace {

/// Between single quotes, where fish knows \' and \\.
std::string fish_quoted(const std::string& text) {
  std::string quoted;
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return "'" + quoted + "'";
}

std::string fish_option(const std::string& condition, const OptionEntry& option) {
  std::string text = "complete -c volcal -n " + condition;
  for (const std::string& name : option.names)
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.choices.empty()) {
    std::string choices;
    for (const std::string& choice : option.choices) choices += (choices.empty() ? "" : " ") + choice;
    text += " -x -a " + fish_quoted(choices);
  } else if (!option.value.empty()) {
    text += takes_file(option) ? " -r -F" : " -x";
  }
  return text + " -d " + fish_quoted(brief_help(option.help)) + "\n";
}

/// The words of the first operand that has fixed ones.
std::string fish_operands(const std::string& condition, const CommandEntry& command) {
  const bool files = std::ranges::any_of(command.operands, takes_file);
  return files ? "complete -c volcal -n " + condition + " -F\n" : "";
}

std::string fish_command(const CommandEntry& command) {
  const std::string condition = fish_quoted("test (__volcal_command) = \"" + command.path + "\"");
  std::string text;
  for (const CommandEntry& sub : command.commands)
    text += "complete -c volcal -n " + condition + " -a " + sub.path.substr(sub.path.rfind(' ') + 1) +
            " -d " + fish_quoted(brief_help(sub.summary)) + "\n";
  for (const OptionEntry& option : command.options) text += fish_option(condition, option);
  return text + fish_operands(condition, command) + "\n";
}

}  // namespace

std::string fish_completion(const CommandEntry& program) {
  std::string text =
      "# fish completion for volcal; written by `volcal help --completion fish`.\n\n"
      "# The command before the cursor, with a command of it behind it.\n"
      "function __volcal_command\n    set -l words (commandline -opc)\n    set -l command $words[2]\n    "
      "switch \"$command $words[3]\"\n";
  for (const CommandEntry* command : all_commands(program)) {
    if (command->path.find(' ') != std::string::npos)
      text += "        case \"" + command->path + "\"\n            set command \"" + command->path + "\"\n";
  }
  text += "    end\n    echo \"$command\"\nend\n\ncomplete -c volcal -f\n\n";
  for (const CommandEntry* command : all_commands(program)) text += fish_command(*command);
  return text;
}

}  // namespace volcal::cli
