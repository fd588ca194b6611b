#include <fmt/format.h>

#include <map>
#include <memory>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/commands/studies/studies.h"

namespace volcal::cli {
namespace {

std::function<int()> define_study(CLI::App& app) {
  app.require_subcommand(0, 1);
  auto work = std::make_shared<std::map<CLI::App*, std::function<int()>>>();
  for (const Command* study : study_commands()) {
    CLI::App* sub = app.add_subcommand(std::string(study->name), std::string(study->summary));
    sub->footer("Examples:\n" + std::string(study->examples));
    (*work)[sub] = study->define(*sub);
  }
  return [&app, work] {
    if (!app.get_subcommands().empty()) return work->at(app.get_subcommands().front())();
    fmt::print(stderr, "volcal study: name a study\n\n{}", app.help("volcal"));
    return kBadInput;
  };
}

}  // namespace

const Command& study_command() {
  static const Command command = {"study", "count over many simulated campaigns what the program claims",
                                  "  volcal study closed-loop -n 20\n"
                                  "  volcal study closed-loop --help\n",
                                  define_study};
  return command;
}

}  // namespace volcal::cli
