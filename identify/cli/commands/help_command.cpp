#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/reference/command_table.h"
#include "volcal/identify/cli/reference/completions.h"
#include "volcal/identify/cli/reference/manual_pages.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/today.h"
#include "volcal/model/description/errors.h"

namespace volcal::cli {
namespace {

struct HelpArguments {
  std::vector<std::string> command;
  std::string completion;
  std::string output;
  bool manual = false;
  bool json = false;
};

/// The app of the command that the words name.
const CLI::App& named_app(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* app = &program;
  for (const std::string& word : words) {
    std::vector<std::string> names;
    const CLI::App* next = nullptr;
    for (const CLI::App* sub : app->get_subcommands({})) {
      names.push_back(sub->get_name());
      if (sub->get_name() == word) next = sub;
    }
    if (next == nullptr)
      throw InputError({}, "there is no command \"" + fmt::format("{}", fmt::join(words, " ")) + "\"",
                       names.empty() ? "leave out \"" + word + "\"" : suggest_name(word, names, "commands"));
    app = next;
  }
  return *app;
}

const CommandEntry& named_entry(const CommandEntry& program, const std::vector<std::string>& words) {
  const std::string path = fmt::format("{}", fmt::join(words, " "));
  for (const CommandEntry* command : all_commands(program)) {
    if (command->path == path) return *command;
  }
  return program;
}

std::string completion_for(const std::string& shell, const CommandEntry& program) {
  if (shell == "bash") return bash_completion(program);
  return shell == "zsh" ? zsh_completion(program) : fish_completion(program);
}

void write_reference(const CommandEntry& program, const std::string& target) {
  AtomicFolder folder(target);
  for (const CommandEntry* command : all_commands(program))
    folder.write(command->name('-') + ".1", manual_page(program, *command, today()));
  folder.write("volcal.bash", bash_completion(program));
  folder.write("_volcal", zsh_completion(program));
  folder.write("volcal.fish", fish_completion(program));
  folder.commit();
}

/// As its --help prints it.
std::string help_text(const CLI::App& app, const std::vector<std::string>& words) {
  std::string name = "volcal";
  for (const std::string& word : words) name += " " + word;
  return app.get_formatter()->make_help(&app, name, CLI::AppFormatMode::Normal);
}

int run_help(const CLI::App& app, const HelpArguments& arguments) {
  const CLI::App& named = named_app(*app.get_parent(), arguments.command);
  const CommandEntry program = command_table(app);
  if (!arguments.output.empty()) {
    write_reference(program, arguments.output);
    if (!arguments.json)
      fmt::print("written to {}: manual pages, and completions for bash, zsh, fish\n", arguments.output);
  }
  if (arguments.json) {
    fmt::print("{}\n", json_text(command_table_json(program), 2));
  } else if (arguments.manual) {
    fmt::print("{}", manual_page(program, named_entry(program, arguments.command), today()));
  } else if (!arguments.completion.empty()) {
    fmt::print("{}", completion_for(arguments.completion, program));
  } else if (arguments.output.empty()) {
    fmt::print("{}", help_text(named, arguments.command));
  }
  return kDone;
}

std::function<int()> define_help(CLI::App& app) {
  auto arguments = std::make_shared<HelpArguments>();
  app.add_option("COMMAND", arguments->command, "command to print the help of; default: the program");
  app.add_flag("--man", arguments->manual, "print the manual page of COMMAND");
  app.add_option("--completion", arguments->completion,
                 "print the completion of the command line for a shell")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  app.add_option("-o,--output", arguments->output, "folder for all manual pages and completions");
  app.add_flag("--json", arguments->json, "print every command with its options as one JSON document");
  return [&app, arguments] { return run_help(app, *arguments); };
}

}  // namespace

const Command& help_command() {
  static const Command command = {"help", "the help of a command, manual pages, completions for shells",
                                  "  volcal help fit\n"
                                  "  volcal help --man fit\n"
                                  "  volcal help --completion bash\n"
                                  "  volcal help --json\n",
                                  define_help};
  return command;
}

}  // namespace volcal::cli
