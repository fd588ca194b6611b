#pragma once
/// What `volcal tables` is asked for.

#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/cli/options/alignment_options.h"
#include "volcal/identify/cli/options/certificate_options.h"
#include "volcal/identify/cli/options/conditions_options.h"

namespace CLI {
class App;
}

namespace volcal::cli {

struct TablesArguments {
  std::string result;
  std::string output;
  std::string format = "csv";
  std::string type;
  std::optional<std::string> zero;
  std::string lines;
  std::optional<int> positions;
  std::optional<int> grid;
  double step_mm = 0.0;
  double rotary_step_deg = 0.0;
  double tolerance_um = 0.0;
  std::vector<std::string> at;
  std::string tool;
  std::vector<std::string> settings;
  std::vector<std::string> records;
  AlignmentArguments alignment;
  ConditionsArguments conditions;
  CertificateArguments certificate;
  std::string approach;
  std::string superimpose;
  std::string picture;
  bool dry_run = false;
  bool list = false;
  bool json = false;
};

void add_tables_options(CLI::App& app, TablesArguments& arguments);

/// Throws InputError where nothing is asked for, or where an option says nothing to what is.
void require_options_that_say_something(const TablesArguments& arguments);

}  // namespace volcal::cli
