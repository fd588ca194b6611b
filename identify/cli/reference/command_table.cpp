#include "volcal/identify/cli/reference/command_table.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

namespace volcal::cli {
namespace {

constexpr std::size_t kBriefLength = 80;

std::vector<std::string> lines_of_text(const std::string& text) {
  std::vector<std::string> lines = CLI::detail::split(text, '\n');
  std::erase(lines, "");
  return lines;
}

/// "TEXT:{a,b}" or "INT:INT in [2 - 9]", as the parser describes what a value is and what holds for it.
void set_value(const std::string& type, OptionEntry& entry) {
  const std::size_t colon = type.find(':');
  entry.value = type.substr(0, colon);
  if (colon == std::string::npos) return;
  const std::string rest = type.substr(colon + 1);
  if (rest.starts_with('{') && rest.ends_with('}')) {
    entry.choices = CLI::detail::split(rest.substr(1, rest.size() - 2), ',');
  } else {
    entry.limits = rest;
  }
}

OptionEntry option_entry(const CLI::Option& option) {
  OptionEntry entry;
  if (option.get_positional()) {
    entry.names.push_back(option.get_name());
  } else {
    for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  }
  const bool flag = option.get_items_expected_max() == 0;
  if (!flag) set_value(option.get_type_name(), entry);
  entry.default_value = option.get_default_str();
  entry.required = option.get_required();
  entry.repeated = !flag && (option.get_expected_max() > 1 ||
                             option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll);
  entry.help = option.get_description();
  return entry;
}

CommandEntry command_entry(const CLI::App& app, const std::string& path) {
  CommandEntry entry;
  entry.path = path;
  entry.summary = app.get_description();
  entry.examples = lines_of_text(app.get_footer());
  if (!entry.examples.empty() && entry.examples.front() == "Examples:")
    entry.examples.erase(entry.examples.begin());
  for (const CLI::Option* option : app.get_options()) {
    (option->get_positional() ? entry.operands : entry.options).push_back(option_entry(*option));
  }
  for (const CLI::App* sub : app.get_subcommands({})) {
    entry.commands.push_back(command_entry(*sub, path + (path.empty() ? "" : " ") + sub->get_name()));
  }
  return entry;
}

void add_with_subcommands(const CommandEntry& command, std::vector<const CommandEntry*>& all) {
  all.push_back(&command);
  for (const CommandEntry& sub : command.commands) add_with_subcommands(sub, all);
}

nlohmann::ordered_json option_json(const OptionEntry& option) {
  nlohmann::ordered_json json = {{"names", option.names}, {"help", option.help}};
  if (!option.value.empty()) json["value"] = option.value;
  if (!option.limits.empty()) json["limits"] = option.limits;
  if (!option.choices.empty()) json["choices"] = option.choices;
  if (!option.default_value.empty()) json["default"] = option.default_value;
  json["required"] = option.required;
  json["repeated"] = option.repeated;
  return json;
}

nlohmann::ordered_json options_json(const std::vector<OptionEntry>& options) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const OptionEntry& option : options) json.push_back(option_json(option));
  return json;
}

nlohmann::ordered_json command_json(const CommandEntry& command) {
  nlohmann::ordered_json json = {{"name", command.name()},
                                 {"summary", command.summary},
                                 {"operands", options_json(command.operands)},
                                 {"options", options_json(command.options)},
                                 {"examples", command.examples},
                                 {"commands", nlohmann::ordered_json::array()}};
  for (const CommandEntry& sub : command.commands) json["commands"].push_back(command_json(sub));
  return json;
}

}  // namespace

std::string CommandEntry::name(char separator) const {
  std::string name = path.empty() ? "volcal" : "volcal " + path;
  std::ranges::replace(name, ' ', separator);
  return name;
}

CommandEntry command_table(const CLI::App& app) {
  const CLI::App* top = &app;
  while (top->get_parent() != nullptr) top = top->get_parent();
  CommandEntry program = command_entry(*top, "");
  // As the summaries of commands: no name before it, no full stop behind it.
  program.summary.erase(0, program.summary.find(' ') + 1);
  while (program.summary.ends_with('.')) program.summary.pop_back();
  return program;
}

std::vector<const CommandEntry*> all_commands(const CommandEntry& program) {
  std::vector<const CommandEntry*> all;
  add_with_subcommands(program, all);
  return all;
}

nlohmann::ordered_json command_table_json(const CommandEntry& program) {
  nlohmann::ordered_json json = {{"format", "volcal-commands-1"}, {"version", VOLCAL_VERSION}};
  json.update(command_json(program));
  return json;
}

std::string brief_help(const std::string& help) {
  std::string brief = help.substr(0, help.find(';'));
  if (brief.size() <= kBriefLength) return brief;
  brief.resize(brief.rfind(' ', kBriefLength - 3));
  return brief + "...";
}

}  // namespace volcal::cli
