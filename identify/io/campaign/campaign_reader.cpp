#include "volcal/identify/io/campaign/campaign_reader.h"

#include <algorithm>
#include <map>

#include "volcal/identify/io/campaign/campaign_checks.h"
#include "volcal/identify/io/campaign/campaign_notes.h"
#include "volcal/identify/io/campaign/left_out_readings.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/readings_reader.h"
#include "volcal/identify/io/campaign/record_reader.h"
#include "volcal/identify/text/csv_table.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/text/toml_document.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr std::int64_t kMostSkippedRows = 100000;
constexpr double kLargestRepeatability_um = 1e3;
constexpr const char* kNoSetups =
    "add a [[setups]] table for each measurement; in the file of volcal init, take the comment marks off one";

std::vector<std::string> instrument_names() {
  std::vector<std::string> names;
  for (const Instrument* instrument : instruments()) names.push_back(instrument->schema().name);
  return names;
}

/// A setup as declared: what to read from which file.
struct DeclaredSetup {
  Setup setup;
  const InstrumentSchema* instrument = nullptr;
  ColumnMapping mapping;
  CsvFormat format;
  bool directions_as_recorded = false;
  std::vector<LeaveOut> leave_out;
  SourcePlace data_place;
};

class CampaignReader {
 public:
  /// `in_memory`: the setups name no files.
  CampaignReader(TomlDocument document, const std::string& file, bool in_memory = false)
      : document_(std::move(document)), root_(document_.root()), in_memory_(in_memory) {
    campaign_.file = file;
    document_.require_format(kCampaignFormat);
  }

  Machine read_named_machine() {
    const std::string path = root_.required_text("machine");
    return read_machine(resolve_path(campaign_.file, path), root_.place("machine"));
  }

  /// Everything but the readings.
  void read_setups(Machine machine) {
    campaign_.machine = std::move(machine);
    root_.know("machine");
    root_.text("name");
    campaign_.active_compensations = root_.text("active_compensations").value_or("");
    read_record(root_);  // checked here, used by read_campaign_record()
    if (const auto encoding = root_.choice("encoding", encoding_names()))
      encoding_ = *encoding_of_name(*encoding);
    directions_as_recorded_ = as_recorded(root_).value_or(false);
    noise_ = root_.table("noise");
    if (noise_) repeatability_ = read_repeatability(*noise_).value_or(0.0);
    for (const TomlTable& table : root_.required_tables("setups", kNoSetups))
      declared_.push_back(read_setup(table));
    if (!in_memory_) reject_readings_given_twice();
    if (noise_) know_all_noise_keys();
    document_.reject_unknown();
  }

  Campaign description() {
    for (DeclaredSetup& declared : declared_) campaign_.setups.push_back(std::move(declared.setup));
    check_shared_stations(campaign_);
    return std::move(campaign_);
  }

  Campaign with_readings() {
    return with_readings([&](std::size_t setup) {
      const DeclaredSetup& declared = declared_[setup];
      return CsvTable::read(declared.setup.data, declared.format, declared.data_place);
    });
  }

  Campaign with_readings(const std::vector<std::vector<NumberColumn>>& readings) {
    return with_readings([&](std::size_t setup) {
      return CsvTable::of_columns(readings.at(setup), declared_[setup].setup.data);
    });
  }

 private:
  /// `table_of`: the readings of a setup by its place.
  template <class TableOf>
  Campaign with_readings(const TableOf& table_of) {
    std::vector<std::vector<UnusedColumn>> unused;
    for (std::size_t setup = 0; setup < declared_.size(); ++setup) {
      DeclaredSetup& declared = declared_[setup];
      const CsvTable table = table_of(setup);
      ColumnChoice choice = choose_columns(table, declared.mapping, campaign_.machine, *declared.instrument);
      declared.setup.readings =
          read_readings(table, declared.mapping, choice, campaign_.machine, *declared.instrument);
      declared.setup.left_out = left_out_readings(declared.leave_out, declared.setup);
      check_setup(campaign_, declared.setup);
      unused.push_back(std::move(choice.unused));
    }
    std::vector<bool> derive;
    for (const DeclaredSetup& declared : declared_) derive.push_back(!declared.directions_as_recorded);
    Campaign campaign = description();
    for (std::size_t i = 0; i < unused.size(); ++i)
      note_unused_columns(unused[i], campaign.setups[i], campaign);
    note_doubtful_readings(campaign);
    derive_directions(derive, campaign);
    note_assumed_centres(campaign);
    return campaign;
  }

  DeclaredSetup read_setup(const TomlTable& table) {
    DeclaredSetup declared;
    Setup& setup = declared.setup;
    setup.source_line = table.place().line;
    setup.name = read_name(table);
    declared.instrument = &read_instrument(table);
    setup.instrument = declared.instrument->name;
    if (in_memory_) {
      refuse_keys_of_files(table);
      setup.data = "readings of " + setup.name;
    } else {
      read_data(table, declared);
    }
    setup.tool = read_tool(table);
    setup.options = table.options(declared.instrument->keys);
    read_noise(table, *declared.instrument, setup);
    read_columns(table, declared.mapping);
    declared.format = read_format(table);
    declared.leave_out = read_leave_out(table);
    declared.directions_as_recorded = as_recorded(table).value_or(directions_as_recorded_);
    return declared;
  }

  static void refuse_keys_of_files(const TomlTable& table) {
    for (const char* key : {"data", "delimiter", "decimal", "encoding", "skip_rows"}) {
      if (table.has(key))
        table.fail(key, std::string(key) + " says how a file is read, and the readings are arrays",
                   std::string("leave ") + key + " out");
    }
  }

  void read_data(const TomlTable& table, DeclaredSetup& declared) const {
    const std::string data = table.required_text("data");
    if (data.empty()) table.fail("data", table.path() + ".data is empty", "name the file of the readings");
    declared.setup.data = resolve_path(campaign_.file, data);
    declared.data_place = table.place("data");
  }

  /// Two setups that read the same columns of the same file with the same instrument, tool and station would
  /// count every reading twice.
  void reject_readings_given_twice() const {
    for (auto one = declared_.begin(); one != declared_.end(); ++one) {
      const auto twin = std::find_if(declared_.begin(), one, [&](const DeclaredSetup& other) {
        return other.setup.data == one->setup.data && other.setup.instrument == one->setup.instrument &&
               other.setup.tool == one->setup.tool && other.mapping.file_name == one->mapping.file_name &&
               other.setup.options.text("station") == one->setup.options.text("station") &&
               other.setup.options.vector("station") == one->setup.options.vector("station");
      });
      if (twin == one) continue;
      throw InputError(
          one->data_place,
          "setup \"" + printable(one->setup.name) + "\" reads " + one->setup.data + ", as setup \"" +
              printable(twin->setup.name) + "\" (line " + std::to_string(twin->setup.source_line) +
              ") does with the same instrument, tool and station: its readings would count twice",
          "name the file of this setup, or remove one of the two setups");
    }
  }

  std::string read_name(const TomlTable& table) {
    std::string name = table.required_name("name");
    const auto [known, fresh] = setup_line_.emplace(name, table.place().line);
    if (!fresh) {
      table.fail("name",
                 "setup name \"" + printable(name) + "\" is used twice, first in line " +
                     std::to_string(known->second),
                 "give every setup its own name");
    }
    return name;
  }

  static const InstrumentSchema& read_instrument(const TomlTable& table) {
    const std::string name = table.required_text("instrument");
    const Instrument* instrument = find_instrument(name);
    if (!instrument) {
      table.fail("instrument", "instrument \"" + printable(name) + "\" is not known",
                 suggest_name(name, instrument_names(), "instruments"));
    }
    return instrument->schema();
  }

  std::size_t read_tool(const TomlTable& table) const {
    const Machine& machine = campaign_.machine;
    if (machine.tools.empty()) {
      table.fail("tool", "the machine " + machine.file + " has no tools",
                 "add [tools.NAME] with offset_mm to it");
    }
    if (!table.has("tool") && machine.tools.size() == 1) return 0;
    const std::string name = table.required_text("tool");
    const auto index = machine.tool_index(name);
    if (!index) {
      table.fail("tool", "tool \"" + printable(name) + "\" is not in the machine file",
                 suggest_name(name, tool_names(machine), "tools"));
    }
    return *index;
  }

  static std::optional<bool> as_recorded(const TomlTable& table) {
    const auto directions = table.choice("directions", {"from-order", "as-recorded"});
    return directions ? std::optional(*directions == "as-recorded") : std::nullopt;
  }

  static std::optional<double> read_repeatability(const TomlTable& table) {
    return table.number("repeatability_um", {0.0, kLargestRepeatability_um});
  }

  static Options noise_options(const TomlTable& table, const InstrumentSchema& instrument) {
    for (const KeySchema& key : instrument.noise_keys) table.number(key.key, kNotNegative);
    return table.options(instrument.noise_keys);
  }

  /// The setup's own noise table replaces the campaign's; repeatability is inherited unless stated.
  void read_noise(const TomlTable& table, const InstrumentSchema& instrument, Setup& setup) {
    setup.repeatability = repeatability_;
    if (const auto own = table.table("noise")) {
      setup.noise = noise_options(*own, instrument);
      if (const auto value = read_repeatability(*own)) setup.repeatability = *value;
    } else if (noise_) {
      setup.noise = noise_options(*noise_, instrument);
    }
    if (const auto value = read_repeatability(table)) setup.repeatability = *value;
    setup.has_noise = !setup.noise.all().empty();
  }

  /// A campaign-wide table may hold the keys of any instrument.
  void know_all_noise_keys() {
    for (const Instrument* instrument : instruments()) {
      for (const KeySchema& key : instrument->schema().noise_keys) noise_->number(key.key, kNotNegative);
    }
  }

  static void read_columns(const TomlTable& table, ColumnMapping& mapping) {
    mapping.place = table.place("columns");
    mapping.scale_place = table.place("scale");
    mapping.constant_place = table.place("constants");
    if (const auto constants = table.table("constants")) {
      for (const std::string& column : constants->keys())
        mapping.constant[column] = *constants->raw_number(column);
    }
    if (const auto columns = table.table("columns")) {
      for (const std::string& column : columns->keys())
        mapping.file_name[column] = columns->required_text(column);
    }
    const auto scale = table.table("scale");
    if (!scale) return;
    for (const std::string& column : scale->keys()) {
      const double factor = *scale->raw_number(column);
      if (factor == 0.0)
        scale->fail(column, scale->path() + "." + printable(column) + " is 0",
                    "give the factor from the file's unit to the column's");
      mapping.scale[column] = factor;
    }
  }

  CsvFormat read_format(const TomlTable& table) const {
    CsvFormat format;
    if (const auto delimiter = table.text("delimiter")) {
      if (delimiter->size() != 1 ||
          std::string_view("\n\r\"#").find((*delimiter)[0]) != std::string_view::npos) {
        table.fail("delimiter", table.path() + ".delimiter is \"" + printable(*delimiter) + "\"",
                   "give one character: \",\", \";\" or \"\\t\"");
      }
      format.delimiter = (*delimiter)[0];
    }
    format.encoding = encoding_;
    format.encoding_only_if_not_utf8 = true;
    if (const auto encoding = table.choice("encoding", encoding_names())) {
      format.encoding = *encoding_of_name(*encoding);
      format.encoding_only_if_not_utf8 = false;
    }
    if (const auto decimal = table.choice("decimal", {".", ","})) format.decimal = (*decimal)[0];
    if (format.decimal == format.delimiter) {
      table.fail(
          "decimal",
          table.path() + ": decimal sign and delimiter are both '" + std::string(1, format.decimal) + "'",
          "add delimiter = \";\", or whatever separates the cells");
    }
    format.skip_rows = static_cast<std::size_t>(table.integer("skip_rows", 0, kMostSkippedRows).value_or(0));
    return format;
  }

  TomlDocument document_;
  TomlTable root_;
  bool in_memory_;
  Campaign campaign_;
  std::optional<TomlTable> noise_;
  double repeatability_ = 0.0;
  TextEncoding encoding_ = TextEncoding::Utf8;  ///< of readings that are not UTF-8
  bool directions_as_recorded_ = false;
  std::map<std::string, int> setup_line_;
  std::vector<DeclaredSetup> declared_;
};

}  // namespace

Campaign read_campaign(const std::string& path) {
  CampaignReader reader(TomlDocument::read(path), path);
  reader.read_setups(reader.read_named_machine());
  return reader.with_readings();
}

Campaign read_campaign_description(const std::string& path) {
  CampaignReader reader(TomlDocument::read(path), path);
  reader.read_setups(reader.read_named_machine());
  return reader.description();
}

Campaign campaign_in_memory(const std::string& text, const std::string& name, const Machine& machine,
                            const std::vector<std::vector<NumberColumn>>& readings) {
  CampaignReader reader(TomlDocument::parse(text, name), name, true);
  reader.read_setups(machine);
  return reader.with_readings(readings);
}

Campaign parse_campaign_description(const std::string& text, const std::string& file,
                                    const Machine& machine) {
  CampaignReader reader(TomlDocument::parse(text, file), file);
  reader.read_setups(machine);
  return reader.description();
}

}  // namespace volcal
