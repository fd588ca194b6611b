#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/io/nearest_name.h"
#include "volcal/model/description/errors.h"

namespace {

/// What is wrong with a command line, and a remedy.
std::string explain(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  if (first.empty() || first.front() == '-') return error.what();
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
  if (std::ranges::find(names, first) != names.end()) return error.what();
  return "there is no command \"" + first + "\"; " + volcal::suggest_name(first, names, "commands");
}

int run(int argc, char** argv) {
  using volcal::cli::commands;
  CLI::App app{
      "volcal: identify the geometric errors of a machine tool from indirect measurements, with "
      "uncertainty."};
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
                 explain(app, error, argc, argv).c_str());
    return volcal::cli::kBadInput;
  }
  return work.at(app.get_subcommands().front())();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const volcal::InputError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return volcal::cli::kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return volcal::cli::kIncomplete;
  }
}
