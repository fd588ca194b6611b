#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/provenance.h"
#include "volcal/identify/cli/today.h"
#include "volcal/identify/io/nearest_name.h"
#include "volcal/identify/io/text_encoding.h"
#include "volcal/model/description/errors.h"

namespace {

/// What a message quotes from files and the command line must not steer the terminal.
std::string shown(std::string_view message) {
  std::string text;
  while (!message.empty()) {
    const std::size_t length = std::max<std::size_t>(volcal::utf8_length(message), 1);
    const std::string_view character = message.substr(0, length);
    text += character != "\n" && volcal::is_control(character) ? std::string_view("?") : character;
    message.remove_prefix(length);
  }
  return text;
}

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
                 shown(explain(app, error, argc, argv)).c_str());
    return volcal::cli::kBadInput;
  }
  volcal::cli::present_time();  // a wrong SOURCE_DATE_EPOCH is refused before the work, not after it
  return work.at(app.get_subcommands().front())();
}

int fail(const std::exception& error, int code) {
  std::fprintf(stderr, "error: %s\n", shown(error.what()).c_str());
  return code;
}

/// A full disk or a closed pipe shows at the end: an output that is cut off must not pass for a whole one.
int flushed(int code) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  std::fprintf(stderr, "error: standard output cannot be written%s%s: what was printed is not complete\n",
               errno != 0 ? ": " : "", errno != 0 ? std::strerror(errno) : "");
  return code == volcal::cli::kDone ? volcal::cli::kIncomplete : code;
}

}  // namespace

int main(int argc, char** argv) {
  volcal::cli::remember_command_line(argc, argv);
  FLAGS_minloglevel = google::GLOG_FATAL;  // what Ceres warns of, the status of the result says
  try {
    return flushed(run(argc, argv));
  } catch (const volcal::InputError& error) {
    return fail(error, volcal::cli::kBadInput);
  } catch (const std::exception& error) {
    return fail(error, volcal::cli::kIncomplete);
  }
}
