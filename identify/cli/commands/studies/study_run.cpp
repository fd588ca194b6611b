#include "volcal/identify/cli/commands/studies/study_run.h"

#include <fmt/format.h>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/number_checks.h"
#include "volcal/identify/text/json_text.h"

namespace volcal::cli {

void add_run_options(CLI::App& app, int& threads, bool& json) {
  app.add_option("--threads", threads, "0 = all; results do not depend on it")->check(number_of_threads());
  app.add_flag("--json", json, "print one JSON document and nothing else");
}

void add_archive_options(CLI::App& app, std::string& output, bool& resume, const std::string& file) {
  app.add_option("-o,--output", output, fmt::format("folder that keeps every finished campaign ({})", file));
  app.add_flag("--resume", resume, "do not run again what the output folder holds");
}

std::function<void(int done, int all)> counted_on(ProgressBar& bar, const std::string& what) {
  return [&bar, what](int done, int all) {
    bar.update(fmt::format("{} of {} {}", done, all, what), static_cast<double>(done) / all);
  };
}

int print_outcome(bool as_json, const std::function<nlohmann::ordered_json()>& json,
                  const std::function<std::string()>& text, int indent) {
  if (as_json) {
    fmt::print("{}\n", json_text(json(), indent));
  } else {
    fmt::print("{}", text());
  }
  return kDone;
}

}  // namespace volcal::cli
