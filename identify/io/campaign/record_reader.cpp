#include "volcal/identify/io/campaign/record_reader.h"

#include <algorithm>
#include <vector>

#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr const char* kActiveCompensations = "active_compensations";

void read_entry(const TomlTable& table, const std::string& key, std::map<std::string, std::string>& entries) {
  const auto text = table.text(key);
  if (!text) return;
  if (text->find_first_not_of(" \t\r\n") == std::string::npos)
    table.fail(key, table.path() + "." + printable(key) + " is empty",
               "state it, or leave the key out: the certificate then says \"not recorded\"");
  entries[key] = *text;
}

void read_instruments(const TomlTable& table, MeasurementRecord& record) {
  std::vector<std::string> known;
  for (const Instrument* instrument : instruments()) known.push_back(instrument->schema().name);
  for (const std::string& name : table.keys()) {
    if (find_instrument(name) == nullptr)
      table.fail(name, table.path() + ": instrument \"" + printable(name) + "\" is not known",
                 suggest_name(name, known, "instruments"));
    read_entry(table, name, record.instruments);
  }
}

}  // namespace

MeasurementRecord read_record(const TomlTable& campaign) {
  MeasurementRecord record;
  if (const auto text = campaign.text(kActiveCompensations); text && !text->empty())
    record.entries[kActiveCompensations] = *text;
  const auto table = campaign.table("record");
  if (!table) return record;
  if (std::ranges::count(table->keys(), kActiveCompensations) > 0)
    table->fail(kActiveCompensations, "active_compensations stands in [record]",
                "move it to the top of campaign.toml, before the first table: the result states it too");
  for (const RecordItem& item : record_items()) {
    if (item.key != kActiveCompensations) read_entry(*table, std::string(item.key), record.entries);
  }
  if (const auto instruments = table->table("instruments")) read_instruments(*instruments, record);
  return record;
}

MeasurementRecord read_campaign_record(const std::string& path) {
  const TomlDocument document = TomlDocument::read(path);
  document.require_format(kCampaignFormat);
  return read_record(document.root());
}

std::string record_toml(const MeasurementRecord& record) {
  std::string text;
  for (const auto& [key, entry] : record.entries) {
    if (key != kActiveCompensations) text += key + " = " + toml_text(entry) + "\n";
  }
  if (!record.instruments.empty()) text += "[record.instruments]\n";
  for (const auto& [name, entry] : record.instruments)
    text += toml_text(name) + " = " + toml_text(entry) + "\n";
  return text.empty() ? text : "\n[record]\n" + text;
}

MeasurementRecord parse_record(const std::string& text, const std::string& name) {
  const TomlDocument document = TomlDocument::parse(text, name);
  MeasurementRecord record = read_record(document.root());
  document.reject_unknown();
  return record;
}

}  // namespace volcal
