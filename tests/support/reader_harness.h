#pragma once
/// Every reader on any text: success or InputError, nothing else. Shared by the fuzzers and the mutation
/// test.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/schema_samples.h"
#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/io/campaign/campaign_checks.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/readings_reader.h"
#include "volcal/identify/io/checkpoint_file.h"
#include "volcal/identify/io/import/imported_campaign.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/io/results/result_json.h"
#include "volcal/identify/montecarlo/draw_sums.h"
#include "volcal/identify/montecarlo/state_bytes.h"
#include "volcal/identify/text/csv_table.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/workbench/workbench.h"
#include "volcal/model/description/errors.h"
#include "volcal/studies/files/control_tables.h"
#include "volcal/studies/files/run_points.h"
#include "volcal/studies/files/study_reader.h"

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
      if (!tables.correction({0.1, -0.2, 0.3, 0.0, 0.0, 0.0}, approach).linear.allFinite())
        throw std::logic_error("a correction is not finite");
      sim::MachineState state;
      state.position = {0.1, -0.2, 0.3, 0.0, 0.0, 0.0};
      state.direction = approach;
      const sim::CommandMoves added = control(state);
      if (!added.linear.allFinite() || !added.rotary.allFinite())
        throw std::logic_error("the simulated control adds what is not finite");
    }
  });
}

inline bool accepts_study(const std::string& text) {
  return accepts([&] { parse_study(text, "study.toml", harness_machine()); });
}

inline bool accepts_diagnosis(const std::string& text) {
  return accepts([&] { diagnosis_from_json(text, "diagnosis.json"); });
}

/// What is read must be positions that a machine can be sent to.
inline bool accepts_points(const std::string& text) {
  return accepts([&] {
    for (const sim::CommandedPoint& point : parse_run_points(text, "points.csv")) {
      for (const double position : point.position) {
        if (!std::isfinite(position)) throw std::logic_error("a position is not finite");
      }
    }
  });
}

/// A line of a session reads back as it was written; a request, its first line the name, is answered or
/// refused.
inline bool accepts_workbench_request(const std::string& text) {
  static workbench::Workbench bench([] {
    workbench::WorkbenchOptions options;
    options.campaign = "/nowhere/campaign.toml";
    return options;
  }());
  accepts([&] {
    const std::string line = to_string(session_command_from(text));
    if (to_string(session_command_from(line)) != line)
      throw std::logic_error("another command was read back");
  });
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string name = text.substr(0, end);
  if (name == "quit") return true;
  const workbench::Answer answer = bench.answer(name, text.substr(std::min(end + 1, text.size())), "one");
  if (answer.status >= 500) throw std::logic_error("the workbench failed: " + answer.body);
  return answer.status == 200;
}

/// What an intact checkpoint holds, of a study of two quantities.
inline bool accepts_state(const std::string& state) {
  try {
    StateReader reader(state);
    StudySums(2).visit_state(reader);
    return reader.at_end();
  } catch (const std::invalid_argument&) {
    return false;
  }
}

/// The bytes as a file, and as the state in an intact one.
inline bool accepts_checkpoint(const std::string& bytes) {
  constexpr std::uint64_t kFingerprint = 7;
  const std::string file = checkpoint_bytes(kFingerprint, bytes);
  if (checkpoint_state(file, "checkpoint", kFingerprint) != bytes)
    throw std::logic_error("the state is not what was written");
  accepts_state(bytes);
  return accepts([&] { accepts_state(checkpoint_state(bytes, "checkpoint", kFingerprint)); });
}

/// error_tables.csv or metadata.csv.
inline bool accepts_error_tables(const std::string& text, unsigned choice) {
  return accepts([&] {
    const auto content = (choice & 4U) != 0 ? TableContent::Compensations : TableContent::Errors;
    const TableFile file{"table.csv", text};
    if (choice % 2U == 0) {
      read_function_table(file, content);
    } else {
      read_table_metadata(file);
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

/// Files of instruments: the first byte chooses the format, the second what is said of the file.
inline bool accepts_import(const std::string& bytes, unsigned format, unsigned said) {
  return accepts([&] {
    const auto encoding = (said & 1U) != 0 ? std::optional(TextEncoding::Cp1252) : std::nullopt;
    const ImportSource source{"file", foreign_text(bytes, "file", encoding, "give --encoding "),
                              (said & 128U) != 0 ? std::optional('.') : std::nullopt};
    const auto formats = import_formats();
    if (format % (formats.size() + 1) == formats.size()) import_format_of(source, std::nullopt);
    ImportAnswers answers;
    answers.unit = (said & 2U) != 0 ? "mm" : "um";
    if ((said & 4U) != 0) answers.runs = "alternating";
    if ((said & 8U) != 0) answers.axis = "X";
    if ((said & 16U) != 0) answers.measures = "EXX";
    answers.columns = (said & 32U) != 0 ? "hz,v,distance" : "x,y,z";
    if ((said & 64U) != 0) answers.instrument = "displacement";
    answers.nominal = {
        "nominal.csv",
        "name,x_mm,y_mm,z_mm\nP1,0,0,0\nP2,200,0,0\nP3,200,200,0\nP4,0,200,0\nP5,100,100,100\n"};
    answers.angle_unit = "gon";
    answers.horizontal = "clockwise";
    answers.vertical = "zenith";
    for (const Axis& axis : harness_machine().axes) answers.at[axis.name] = 0.0;
    ImportedFile file{"file", "S", 0,
                      formats[format % formats.size()]->read(source, answers, harness_machine(), 0)};
    file.readings.keys["noise"] = "{ constant_um = 1.0 }";
    imported_campaign({file}, harness_machine());
  });
}

}  // namespace volcal::testing
