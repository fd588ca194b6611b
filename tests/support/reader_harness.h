#pragma once
/// Every reader on any text: success or InputError, nothing else. Shared by the fuzzers and the mutation
/// test.

#include <string>

#include "tests/support/schema_samples.h"
#include "volcal/identify/io/campaign_checks.h"
#include "volcal/identify/io/campaign_reader.h"
#include "volcal/identify/io/csv_table.h"
#include "volcal/identify/io/machine_reader.h"
#include "volcal/identify/io/model_reader.h"
#include "volcal/identify/io/readings_reader.h"
#include "volcal/identify/io/result_json.h"
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
