#pragma once
/// The command line as data: every command with its operands and options, as the parser knows them. Manual
/// pages and completions are made of it.

#include <CLI/App.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace volcal::cli {

/// An option, or an operand (then `names` holds its one name).
struct OptionEntry {
  std::vector<std::string> names;    ///< "-o", "--output"
  std::string value;                 ///< kind of value: "TEXT", "INT", "FLOAT"; empty = a flag
  std::string limits;                ///< "POSITIVE", "INT in [2 - 100]"; empty = none
  std::vector<std::string> choices;  ///< the words that are taken; empty = any
  std::string default_value;
  bool required = false;
  bool repeated = false;  ///< takes several values
  std::string help;
};

struct CommandEntry {
  std::string path;  ///< "fit", "study planning"; empty for the program itself
  std::string summary;
  std::vector<std::string> examples;  ///< lines
  std::vector<OptionEntry> operands;
  std::vector<OptionEntry> options;
  std::vector<CommandEntry> commands;

  /// "volcal fit", or with '-' in place of spaces: "volcal-fit".
  std::string name(char separator = ' ') const;
};

/// Of the whole program, from any of its apps.
CommandEntry command_table(const CLI::App& app);

/// The program, its commands and theirs, in the order of the help.
std::vector<const CommandEntry*> all_commands(const CommandEntry& program);

nlohmann::ordered_json command_table_json(const CommandEntry& program);

/// What a list of completions says of an option or a command: its help up to the first ';', at most 80
/// characters.
std::string brief_help(const std::string& help);

}  // namespace volcal::cli
