/// Of which machine, by whom and with what; which tables; and the figures that a reader looks for first.

#include <fmt/format.h>

#include <map>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {
namespace {

class CertifiedFacts {
 public:
  /// `value` empty: not recorded.
  void add(std::string_view name, const std::string& value) { facts_.push_back({name, value}); }
  void add_recorded(const MeasurementRecord& record, std::initializer_list<std::string_view> keys) {
    for (const RecordItem& item : record_items()) {
      if (std::ranges::find(keys, item.key) != keys.end()) add(item.title, record.entry(item.key));
    }
  }
  Json json() const { return facts_; }

 private:
  Json facts_ = Json::array();
};

std::string tool_with_offset(const Tool& tool) {
  const Eigen::Vector3d offset = tool.offset * kPerMilli;
  return fmt::format("{}, offset ({:g}, {:g}, {:g}) mm", tool.name, offset[0], offset[1], offset[2]);
}

std::string temperature_of_tables(const FitResult& result, const Conditions& conditions) {
  const double temperature = stated_reference_temperature(result, conditions);
  if (std::isnan(temperature)) return "that of the measurement; the campaign records none";
  const std::string_view origin = reference_temperature_origin(result);
  const bool is_reduced = !result.temperature_is_campaign_mean && origin != "assumed";
  return fmt::format("{:.2f} °C{}{}", temperature, is_reduced ? "" : ", ", is_reduced ? "" : origin);
}

Json certified_machine(const CertificateView& certificate) {
  const Machine& machine = certificate.result.machine;
  CertifiedFacts facts;
  facts.add("Machine", machine.name);
  facts.add_recorded(certificate.record, {"serial_number", "manufacturer", "control", "owner", "place"});
  facts.add("Structure (ISO 10791-6)", machine.structure.code);
  for (const Axis& axis : machine.axes) {
    const double factor = position_factor(axis.name);
    facts.add(fmt::format("Travel {}", letter_of(axis.name)),
              fmt::format("{:g} to {:g} {}", axis.travel_min * factor, axis.travel_max * factor,
                          position_unit(axis.name).suffix));
  }
  return facts.json();
}

Json certified_measurement(const CertificateView& certificate) {
  const FitResult& result = certificate.result;
  std::size_t readings = 0;
  for (const SetupSummary& setup : result.setups) readings += setup.observations;
  CertifiedFacts facts;
  facts.add_recorded(certificate.record, {"operator", "measured_on", "remarks"});
  facts.add("Campaign", certificate.before.campaign);
  facts.add("Readings", fmt::format("{} in {} setups", count_number(static_cast<long long>(readings)),
                                    result.setups.size()));
  if (!result.provenance.version.empty())
    facts.add("Identified by",
              fmt::format("volcal {}, {}", result.provenance.version, result.provenance.date));
  return facts.json();
}

Json certified_compensation(const CertificateView& certificate) {
  const FitResult& result = certificate.result;
  const MadeTables& tables = certificate.tables;
  CertifiedFacts facts;
  facts.add("Type (ISO/TR 16907, 8.2)", tables.options.type.name());
  facts.add("Format", fmt::format("{}: {}", tables.format->name, tables.format->summary));
  facts.add("Holds for tool", tool_with_offset(tool_of(result.machine, tables.options)));
  if (tables.options.step > 0.0)
    facts.add("Step of the tables", fmt::format("{:g} mm", tables.options.step * kPerMilli));
  facts.add("Holds at", temperature_of_tables(result, conditions_of(result, tables.options)));
  facts.add("Frame", result.alignment.empty()
                         ? fmt::format("primary axis {}, secondary {}, every error zero at home",
                                       letter_of(result.machine.datum.primary),
                                       letter_of(result.machine.datum.secondary))
                         : result.alignment);
  facts.add("Verified on", std::string(tables.format->verified));
  return facts.json();
}

/// Instruments with what the record says of each: maker, serial number, calibration.
Json certified_instruments(const CertificateView& certificate) {
  struct Use {
    std::size_t setups = 0, readings = 0;
  };
  std::map<std::string, Use> used;
  for (const SetupSummary& setup : certificate.result.setups) {
    ++used[setup.instrument].setups;
    used[setup.instrument].readings += setup.observations;
  }
  Json rows = Json::array();
  for (const auto& [instrument, use] : used) {
    const auto recorded = certificate.record.instruments.find(instrument);
    rows.push_back({{"instrument", instrument},
                    {"recorded", recorded == certificate.record.instruments.end() ? "" : recorded->second},
                    {"setups", use.setups},
                    {"readings", use.readings}});
  }
  return rows;
}

Json certified_figures(const CertificateView& certificate) {
  const VolumeCheck& check = certificate.tables.check;
  Json list = Json::array();
  const auto add = [&](const char* label, double metres, const std::string& note) {
    list.push_back({{"label", label},
                    {"value", fmt::format("{:.2f}", metres * kPerMicro)},
                    {"unit", "µm RMS"},
                    {"note", note}});
  };
  add("Error in the volume before", check.before.rms,
      fmt::format("largest {:.1f} µm", check.before.max * kPerMicro));
  add("With these tables", check.exported.rms,
      fmt::format("largest {:.1f} µm, computed", check.exported.max * kPerMicro));
  if (check.identification_u > 0.0)
    add("Expected on the machine", check.expected_rms(),
        fmt::format("with u = {:.2f} µm of what was identified", check.identification_u * kPerMicro));
  if (certificate.after && certificate.after->sizes.lengths.count > 0)
    add("Measured with the tables", certificate.after->sizes.lengths.rms,
        fmt::format("{:.2f} µm before, deviations of readings",
                    certificate.before.sizes.lengths.rms * kPerMicro));
  return list;
}

/// What a reader must know before the tables are relied on.
Json certified_reservations(const CertificateView& certificate) {
  const FitResult& result = certificate.result;
  Json list = Json::array();
  if (result.status != FitStatus::Ok)
    list.push_back(fmt::format("The identification ended with status {}.", to_string(result.status)));
  for (const auto* findings :
       {&result.rank.invisible, &certificate.tables.effects_left_out, &certificate.tables.cautions}) {
    for (const std::string& text : sentences(*findings)) list.push_back(text);
  }
  for (const std::string& text : sentences(unmeasured_travel(result))) list.push_back(text);
  if (certificate.after && !names_compensations(certificate.after->active_compensations))
    list.push_back("The campaign measured afterwards does not state that compensations were active.");
  return list;
}

}  // namespace

Json certified_page(const CertificateInput& input) {
  const CertificateView& certificate = input.certificate;
  return {{"figures", certified_figures(certificate)},
          {"reservations", certified_reservations(certificate)},
          {"machine", certified_machine(certificate)},
          {"measurement", certified_measurement(certificate)},
          {"instruments", certified_instruments(certificate)},
          {"compensation", certified_compensation(certificate)}};
}

}  // namespace volcal::report
