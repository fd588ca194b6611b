#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/outcome.h"
#include "volcal/identify/cli/process.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/today.h"

namespace {

/// Nothing when `word` is one of the names.
std::string unknown_word(const std::string& what, const std::string& word, const std::string& where,
                         const std::vector<std::string>& names) {
  if (std::ranges::find(names, word) != names.end()) return "";
  return "there is no " + what + " \"" + where + word + "\"; " +
         volcal::suggest_name(word, names, what + "s");
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
  return names;
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// What is wrong with a command line, and a remedy: the first command, study or long option that does not
/// exist, or else what the parser says.
std::string explain(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  const CLI::App* current = &app;
  std::string path;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--") break;
    if (word.starts_with("--")) {
      std::string problem =
          unknown_word("option", word.substr(0, word.find('=')), "", names_of_options(*current));
      if (!problem.empty()) return problem;
    } else if (const auto names = names_of_commands(*current); !word.starts_with("-") && !names.empty()) {
      std::string problem = unknown_word("command", word, path, names);
      if (!problem.empty()) return problem;
      current = current->get_subcommand(word);
      path += word + " ";
    }
  }
  return error.what();
}

int run(int argc, char** argv) {
  using volcal::cli::commands;
  CLI::App app{
      "volcal: identify the geometric errors of a machine tool from indirect measurements, with "
      "uncertainty.",
      "volcal"};
  app.set_version_flag("--version", VOLCAL_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  std::map<CLI::App*, std::function<int()>> work;
  for (const auto* command : commands()) {
    CLI::App* sub = app.add_subcommand(std::string(command->name), std::string(command->summary));
    sub->footer("Examples:\n" + std::string(command->examples));
    work[sub] = command->define(*sub);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return app.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return app.exit(version);
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "volcal: %s\nRun `volcal --help` or `volcal COMMAND --help` to see what there is.\n",
                 volcal::cli::shown(explain(app, error, argc, argv)).c_str());
    return volcal::cli::kBadInput;
  }
  volcal::present_time();  // a wrong SOURCE_DATE_EPOCH is refused before the work, not after it
  volcal::cli::set_current_work(app.get_subcommands().front()->get_name());
  return work.at(app.get_subcommands().front())();
}

}  // namespace

int main(int argc, char** argv) {
  volcal::cli::start_with_better_kernels(argv);
  volcal::cli::remember_command_line(argc, argv);
  FLAGS_minloglevel = google::GLOG_FATAL;  // what Ceres warns of, the status of the result says
  volcal::cli::prepare_process();
  return volcal::cli::outcome_of([&] { return run(argc, argv); });
}
