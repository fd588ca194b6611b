#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "volcal/identify/cli/command.h"
#include "volcal/identify/cli/options/import_options.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign_writer.h"
#include "volcal/identify/io/import/imported_campaign.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/text/atomic_folder.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/words/finding_json.h"

namespace volcal::cli {
namespace {

struct ImportArguments {
  std::vector<std::string> files;
  std::string machine;
  std::string output;
  ImportOptions options;
  bool yes = false;
  bool force = false;
  bool json = false;
};

std::size_t tool_of(const ImportArguments& arguments, const std::string& file, const Machine& machine) {
  const auto name = value_for(file, arguments.files, "--tool", arguments.options.tool);
  std::vector<std::string> names;
  for (const Tool& tool : machine.tools) names.push_back(tool.name);
  if (names.empty())
    throw InputError({machine.file, 0}, "the machine has no tools", "add [tools.NAME] with offset_mm to it");
  if (!name && names.size() == 1) return 0;
  if (!name)
    throw InputError({file, 0}, "the file does not say at which tool was measured",
                     "give --tool NAME: " + join_names(names));
  const auto index = machine.tool_index(*name);
  if (!index)
    throw InputError({}, "--tool " + printable(*name) + " is not in the machine file",
                     suggest_name(*name, names, "tools"));
  return *index;
}

/// The stem of a file's name, unless another setup has it, or one whose readings would go to the same file.
std::string new_setup_name(const std::string& file, std::set<std::string>& taken) {
  const std::string stem = utf8_text(std::filesystem::path(file).stem().string());
  for (int number = 1;; ++number) {
    Setup setup;
    setup.name = number == 1 ? stem : stem + "-" + std::to_string(number);
    if (taken.insert(readings_file_name(setup)).second) return setup.name;
  }
}

std::string facts_text(const ImportedFile& file) {
  TextTable table({{"", Align::Left}, {"", Align::Left}, {"source", Align::Left}}, file.path);
  for (const ImportFact& fact : file.readings.facts)
    table.add_row({printable(fact.what), printable(fact.value), printable(fact.said_by)});
  return table.text();
}

/// Where something is guessed the user confirms it: by --yes, or by an answer on a terminal.
void require_confirmation(const ImportArguments& arguments, const ImportedFile& file) {
  if (!file.readings.guessed || arguments.yes) return;
  if (!arguments.json && ::isatty(STDIN_FILENO) == 1 && ::isatty(STDOUT_FILENO) == 1) {
    fmt::print("is that right? [y/n] ");
    std::cout.flush();
    std::string answer;
    std::getline(std::cin, answer);
    if (answer == "y" || answer == "yes") return;
  }
  throw InputError({file.path, 0}, "what is marked as guessed is not confirmed",
                   "see whether it is right, and add --yes; rename columns in the file where it is wrong");
}

ImportedFile import_file(const ImportArguments& arguments, const std::string& path, const Machine& machine) {
  const ImportAnswers answers = import_answers(path, arguments.files, arguments.options);
  const ImportSource source{path, read_foreign_text(path, answers.encoding, "give --encoding "),
                            decimal_of(path, arguments.files, arguments.options)};
  const ImportFormat& format = import_format_of(source, arguments.options.format);
  ImportedFile file{path, "", tool_of(arguments, path, machine), {}};
  file.readings = format.read(source, answers, machine, file.tool);
  for (const auto& [key, value] : answers.keys) file.readings.keys[key] = value;
  return file;
}

nlohmann::ordered_json file_json(const ImportedFile& file) {
  nlohmann::ordered_json facts = nlohmann::ordered_json::array();
  for (const ImportFact& fact : file.readings.facts)
    facts.push_back({{"what", fact.what}, {"value", fact.value}, {"said_by", fact.said_by}});
  return {{"file", file.path},
          {"setup", file.setup},
          {"instrument", file.readings.instrument->name},
          {"readings", file.readings.source_line.size()},
          {"facts", facts}};
}

void print_imported(const ImportArguments& arguments, const std::vector<ImportedFile>& files,
                    const Campaign& campaign) {
  if (arguments.json) {
    nlohmann::ordered_json json = {{"folder", arguments.output}, {"files", nlohmann::ordered_json::array()}};
    for (const ImportedFile& file : files) json["files"].push_back(file_json(file));
    add_findings("notes", campaign.notes, json);
    fmt::print("{}\n", json_text(json, 2));
    return;
  }
  fmt::print("{}written: {}/campaign.toml, {} {}\n", findings_text(campaign.notes), arguments.output,
             files.size(), files.size() == 1 ? "setup" : "setups");
  fmt::print("next: volcal compare {0}/campaign.toml nominal, volcal fit {0}/campaign.toml -o result\n",
             arguments.output);
}

int run_import(const ImportArguments& arguments) {
  const Machine machine = read_machine(arguments.machine);
  const Replaceable replaceable = arguments.force ? Replaceable::Anything : Replaceable::Unedited;
  std::vector<std::string> inputs = arguments.files;
  inputs.push_back(arguments.machine);
  require_output_folder(arguments.output, inputs, replaceable);
  std::vector<ImportedFile> files;
  std::set<std::string> taken;
  for (const std::string& path : arguments.files) {
    files.push_back(import_file(arguments, path, machine));
    files.back().setup = new_setup_name(path, taken);
    if (!arguments.json) fmt::print("{}", facts_text(files.back()));
    require_confirmation(arguments, files.back());
  }
  const Campaign campaign = imported_campaign(files, machine);
  AtomicFolder folder(arguments.output, replaceable);
  folder.write("machine.toml", read_text_file(arguments.machine));
  folder.write("campaign.toml", import_comments(files) + campaign_toml(campaign, "machine.toml"));
  for (const Setup& setup : campaign.setups)
    folder.write(readings_file_name(setup), readings_csv(setup, machine));
  folder.commit_to_be_edited();
  print_imported(arguments, files, campaign);
  return kDone;
}

std::function<int()> define_import(CLI::App& app) {
  auto arguments = std::make_shared<ImportArguments>();
  app.add_option("FILE", arguments->files, "files of instruments; each becomes a setup of its name")
      ->required();
  app.add_option("--machine", arguments->machine, "machine.toml; volcal init writes one to start from")
      ->required();
  app.add_option("-o,--output", arguments->output, "folder of the campaign, new or empty")->required();
  add_import_options(app, arguments->options);
  app.add_flag("--yes", arguments->yes, "what is guessed of a table is right");
  app.add_flag("--force", arguments->force, "overwrite files that were edited, and those of other origin");
  app.add_flag("--json", arguments->json, "print one JSON document on standard output and nothing else");
  return [arguments] { return run_import(*arguments); };
}

}  // namespace

const Command& import_command() {
  static const Command command = {
      "import", "make a campaign of files that instruments write: .rtl, point lists of trackers, tables",
      "  volcal import import/x.rtl --machine import/machine.toml --unit um --at Y=250,Z=150 \\\n"
      "      --set \"noise = { constant_um = 0.3, per_metre_um = 0.5 }\" -o from-laser\n"
      "  volcal import import/x.rtl import/y.rtl --machine import/machine.toml --unit um \\\n"
      "      --at x:Y=250,Z=150 --at y:X=100,Z=150 --set \"noise = { constant_um = 0.3 }\" -o from-two\n"
      "  volcal import import/points.txt --machine import/machine.toml --nominal import/commanded.csv \\\n"
      "      --horizontal clockwise --vertical zenith --set \"noise = { constant_um = 5, angle_urad = 5 }\" "
      "-o "
      "from-tracker\n"
      "  volcal import import/table.csv --machine import/machine.toml --instrument displacement \\\n"
      "      --at Y=250,Z=150 --set \"noise = { constant_um = 0.3 }\" --yes -o from-table   after a look at "
      "the guess\n",
      define_import};
  return command;
}

}  // namespace volcal::cli
