#include "volcal/identify/io/import/imported_campaign.h"

#include <filesystem>

#include "volcal/identify/io/campaign/campaign_checks.h"
#include "volcal/identify/io/campaign/campaign_notes.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/readings_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/text/text_file.h"

namespace volcal {
namespace {

std::string setup_text(const ImportedFile& file, const Machine& machine) {
  std::string text = "[[setups]]\nname = " + toml_text(file.setup) +
                     "\ninstrument = " + toml_text(file.readings.instrument->name) +
                     "\ndata = " + toml_text(std::filesystem::absolute(file.path).string()) + "\n";
  if (!machine.tools.empty()) text += "tool = " + toml_text(machine.tools.at(file.tool).name) + "\n";
  for (const auto& [key, value] : file.readings.keys) text += key + " = " + value + "\n";
  return text;
}

/// The setups without their readings. Lines of the text made here mean nothing to the user.
Campaign described(const std::vector<ImportedFile>& files, const Machine& machine) {
  std::string text = std::string("format = \"") + kCampaignFormat + "\"\n";
  for (const ImportedFile& file : files) text += setup_text(file, machine);
  try {
    return parse_campaign_description(text, "import", machine);
  } catch (const InputError& error) {
    throw InputError({}, error.problem(), error.remedy());
  }
}

/// Readings of `setup`; notes columns that its instrument does not read.
Readings read_columns(const ImportedFile& file, const Setup& setup, Campaign& campaign) {
  std::vector<NumberColumn> columns;
  for (const ImportedColumn& column : file.readings.columns) columns.push_back({column.name, column.values});
  const CsvTable table = CsvTable::of_columns(std::move(columns), file.path, file.readings.source_line);
  const InstrumentSchema& instrument = *file.readings.instrument;
  const ColumnChoice choice = choose_columns(table, {}, campaign.machine, instrument);
  note_unused_columns(choice.unused, setup, campaign);
  return read_readings(table, {}, choice, campaign.machine, instrument);
}

void require_noise(const ImportedFile& file, const Setup& setup) {
  if (setup.has_noise || !setup.readings.sigma.empty()) return;
  std::string keys;
  for (const KeySchema& key : file.readings.instrument->noise_keys)
    keys += (keys.empty() ? "" : ", ") + key.key + " = ...";
  throw InputError(
      {file.path, 0}, "the file does not say how uncertain its readings are",
      "give --set \"noise = { " + keys +
          " }\", standard uncertainties (k = 1), and --set \"repeatability_um = ...\" of the machine");
}

}  // namespace

Campaign imported_campaign(const std::vector<ImportedFile>& files, const Machine& machine) {
  Campaign campaign = described(files, machine);
  for (std::size_t i = 0; i < files.size(); ++i) {
    Setup& setup = campaign.setups[i];
    setup.readings = read_columns(files[i], setup, campaign);
    require_noise(files[i], setup);
    campaign.file = files[i].path;
    setup.source_line = 0;
    check_setup(campaign, setup);
  }
  note_doubtful_readings(campaign);
  note_assumed_centres(campaign);
  campaign.file = "campaign.toml";
  return campaign;
}

std::string import_comments(const std::vector<ImportedFile>& files) {
  std::string text;
  for (const ImportedFile& file : files) {
    const std::string name = std::filesystem::path(file.path).filename().string();
    text += "# " + printable(file.setup) + ": imported from " + printable(name) + "\n";
    for (const ImportFact& fact : file.readings.facts)
      text += "#   " + printable(fact.what) + ": " + printable(fact.value) + " (" + printable(fact.said_by) +
              ")\n";
  }
  return text;
}

}  // namespace volcal
