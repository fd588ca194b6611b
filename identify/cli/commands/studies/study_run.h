#pragma once
/// What every study's command does besides its own options: progress while it runs, its outcome printed.

#include <CLI/App.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "volcal/identify/cli/progress.h"

namespace volcal::cli {

/// Options --threads and --json.
void add_run_options(CLI::App& app, int& threads, bool& json);

/// Option --output, a folder that keeps what is finished in `file`, and --resume.
void add_archive_options(CLI::App& app, std::string& output, bool& resume, const std::string& file);

/// "3 of 8 campaigns" on the bar, which must outlive the study.
std::function<void(int done, int all)> counted_on(ProgressBar& bar, const std::string& what);

/// Prints one JSON document, or the text; the other is not made. Returns kDone.
int print_outcome(bool as_json, const std::function<nlohmann::ordered_json()>& json,
                  const std::function<std::string()>& text, int indent = 2);

}  // namespace volcal::cli
