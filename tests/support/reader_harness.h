#pragma once
/// Every reader on any text: success or InputError, nothing else. Shared by the fuzzers and the mutation
/// test.

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/schema_samples.h"
#include "volcal/identify/io/campaign_checks.h"
#include "volcal/identify/io/campaign_reader.h"
#include "volcal/identify/io/control_tables.h"
#include "volcal/identify/io/csv_table.h"
#include "volcal/identify/io/machine_reader.h"
#include "volcal/identify/io/model_reader.h"
#include "volcal/identify/io/readings_reader.h"
#include "volcal/identify/io/result_json.h"
#include "volcal/identify/tables/table_format.h"
#include "volcal/model/description/errors.h"

namespace volcal::testing {

inline const Machine& harness_machine() {
  static const Machine machine = parse_machine(sample_machine(), "machine.toml");
  return machine;
}

/// True when the text was accepted. Other exceptions than InputError go through, and an InputError must carry
/// a problem and a remedy.
template <class Read>
bool accepts(Read read) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    if (error.problem().empty() || error.remedy().empty()) throw std::logic_error("an error without remedy");
    return false;
  }
}

inline bool accepts_machine(const std::string& text) {
  return accepts([&] { parse_machine(text, "machine.toml"); });
}

inline bool accepts_model(const std::string& text) {
  return accepts([&] { parse_model(text, "model.toml", harness_machine()); });
}

inline bool accepts_campaign(const std::string& text) {
  return accepts([&] { parse_campaign_description(text, "campaign.toml", harness_machine()); });
}

inline bool accepts_result(const std::string& text) {
  return accepts([&] { result_from_json(text, "result.json"); });
}

/// Files in one text: a line ">NAME" stands before the lines of each.
inline std::vector<TableFile> unpacked_files(const std::string& text) {
  std::vector<TableFile> files;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t stop = std::min(text.find('\n', from), text.size());
    const std::string line = text.substr(from, stop - from);
    if (line.starts_with('>')) {
      files.push_back({line.substr(1), ""});
    } else if (!files.empty()) {
      files.back().content += line + (stop < text.size() ? "\n" : "");
    }
    from = stop + 1;
  }
  return files;
}

inline std::string packed_files(const std::vector<TableFile>& files) {
  std::string text;
  for (const TableFile& file : files) text += ">" + file.name + "\n" + file.content;
  return text;
}

/// Tables of every format in turn; what is read must give finite corrections.
inline bool accepts_tables(const std::string& text, std::size_t format_index) {
  return accepts([&] {
    const auto formats = table_formats();
    const TableFormat& format = *formats[format_index % formats.size()];
    const std::vector<TableFile> files = unpacked_files(text);
    const CompensationTables tables = format.read(files);
    const auto control = sim::command_correction(
        {control_reads(format) ? control_tables(format, files) : sim::ControlTables{}, 0.0, {}});
    for (const int direction : {-1, 0, 1}) {
      ApproachDirection approach{};
      approach.fill(static_cast<std::int8_t>(direction));
      if (!tables.correction({0.1, -0.2, 0.3, 0.0, 0.0, 0.0}, approach).allFinite())
        throw std::logic_error("a correction is not finite");
      sim::MachineState state;
      state.position = {0.1, -0.2, 0.3, 0.0, 0.0, 0.0};
      state.direction = approach;
      if (!control(state).allFinite())
        throw std::logic_error("the simulated control adds what is not finite");
    }
  });
}

/// Readings of every instrument in turn, with all checks that a campaign undergoes.
inline bool accepts_readings(const std::string& text, std::size_t instrument_index, const CsvFormat& format) {
  return accepts([&] {
    static const Campaign declared =
        parse_campaign_description(sample_campaign(), "campaign.toml", harness_machine());
    Setup setup = declared.setups[instrument_index % declared.setups.size()];
    const InstrumentSchema& schema = find_instrument(setup.instrument)->schema();
    setup.readings = read_readings(CsvTable::parse(text, "data.csv", format), {}, declared.machine, schema);
    check_setup(declared, setup);
  });
}

}  // namespace volcal::testing
