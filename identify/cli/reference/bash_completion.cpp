#include <CLI/CLI.hpp>

#include "volcal/identify/cli/reference/completions.h"

namespace volcal::cli {
namespace {

constexpr const char* kBashBegin =
    R"(# bash completion for volcal; written by `volcal help --completion bash`.
_volcal()
{
    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}
    local command="" options="" commands="" choices="" value=""
    # --option=value is three words.
    if [[ $cur == "=" ]]; then
        cur=""
    elif [[ $prev == "=" ]] && ((COMP_CWORD > 1)); then
        prev=${COMP_WORDS[COMP_CWORD-2]}
    fi
    ((COMP_CWORD > 1)) && command=${COMP_WORDS[1]}
    case $command in
)";

constexpr const char* kBashMiddle = R"(    esac
    case $command in
)";

constexpr const char* kBashEnd = R"(    esac
    compopt +o filenames 2>/dev/null
    if [[ -n $choices ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$cur")
    elif [[ $value == other ]]; then
        COMPREPLY=()
    elif [[ -z $value && $cur == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")
    elif [[ -z $value && -n $commands ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$commands" -- "$cur")
    else
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -- "$cur")
    fi
}
complete -F _volcal volcal
)";

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

std::string bash_value(const OptionEntry& option) {
  if (!option.choices.empty()) return "choices=\"" + joined(option.choices, " ") + "\"";
  return takes_file(option) ? "value=file" : "value=other";
}

std::string bash_command(const CommandEntry& command) {
  std::vector<std::string> options, commands;
  std::string values;
  for (const OptionEntry& option : command.options) {
    options.insert(options.end(), option.names.begin(), option.names.end());
    if (!option.value.empty())
      values += "                " + joined(option.names, "|") + ") " + bash_value(option) + " ;;\n";
  }
  for (const CommandEntry& sub : command.commands)
    commands.push_back(sub.path.substr(sub.path.rfind(' ') + 1));
  std::string text =
      "        \"" + command.path + "\")\n            options=\"" + joined(options, " ") + "\"\n";
  if (!commands.empty()) text += "            commands=\"" + joined(commands, " ") + "\"\n";
  if (!values.empty()) text += "            case $prev in\n" + values + "            esac\n";
  return text + "            ;;\n";
}

}  // namespace

bool takes_file(const OptionEntry& option) { return option.value == "TEXT" && option.choices.empty(); }

std::string bash_completion(const CommandEntry& program) {
  std::string nested, cases;
  for (const CommandEntry* command : all_commands(program)) {
    cases += bash_command(*command);
    if (command->path.empty() || command->commands.empty()) continue;
    std::vector<std::string> names;
    for (const CommandEntry& sub : command->commands)
      names.push_back(sub.path.substr(sub.path.rfind(' ') + 1));
    nested += "        " + command->path + ")\n            ((COMP_CWORD > 2)) && case ${COMP_WORDS[2]} in\n" +
              "                " + joined(names, "|") + ") command+=\" ${COMP_WORDS[2]}\" ;;\n" +
              "            esac\n            ;;\n";
  }
  return kBashBegin + nested + kBashMiddle + cases + kBashEnd;
}

}  // namespace volcal::cli
