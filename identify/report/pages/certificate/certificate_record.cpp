/// What ISO/TR 16907:2015, 9.1, asks to be documented: by the record of the campaign, by its readings, by the
/// tables.

#include <fmt/format.h>

#include <set>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/page.h"

namespace volcal::report {
namespace {

/// Rows of (item, said by the record, said by readings and files).
class RecordRows {
 public:
  explicit RecordRows(const MeasurementRecord& record) : record_(record) {}
  void add(std::string_view title, const std::string& recorded, const std::string& known) {
    rows_.push_back({{"item", title}, {"recorded", recorded}, {"known", known}});
  }
  void add_item(std::string_view key, const std::string& known = {}) {
    for (const RecordItem& item : record_items()) {
      if (item.key == key) add(item.title, record_.entry(key), known);
    }
  }
  Json json() const { return rows_; }

 private:
  const MeasurementRecord& record_;
  Json rows_ = Json::array();
};

std::string measured_travel_text(const FitResult& result) {
  std::string text;
  for (const Axis& axis : result.machine.axes) {
    const double factor = position_factor(axis.name);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const FunctionSummary& function : result.functions) {
      if (function.symbol.axis != axis.name) continue;
      low = std::min(low, function.measured_min);
      high = std::max(high, function.measured_max);
    }
    if (low > high) continue;
    text += fmt::format("{}{} {:g} to {:g} {}", text.empty() ? "" : "; ", letter_of(axis.name), low * factor,
                        high * factor, position_unit(axis.name).suffix);
  }
  return text;
}

std::string used_tools_text(const FitResult& result) {
  std::set<std::string> used;
  for (const SetupSummary& setup : result.setups) used.insert(setup.tool);
  std::string text;
  for (const Tool& tool : result.machine.tools) {
    if (!used.contains(tool.name)) continue;
    const Eigen::Vector3d offset = tool.offset * kPerMilli;
    text += fmt::format("{}{} ({:g}, {:g}, {:g}) mm", text.empty() ? "" : "; ", tool.name, offset[0],
                        offset[1], offset[2]);
  }
  return text;
}

std::string feeds_text(const FitResult& result) {
  if (!result.conditions.feed) return {};
  const double to_mm_min = kPerMilli * kSecondsPerMinute;
  return fmt::format("{:g} to {:g} mm/min", result.conditions.feed->min * to_mm_min,
                     result.conditions.feed->max * to_mm_min);
}

std::string temperatures_text(const FitResult& result) {
  std::string text;
  for (const auto& [channel, range] : result.conditions.temperature_degC)
    text += fmt::format("{}{} {:.2f} to {:.2f} °C, mean {:.2f} °C", text.empty() ? "" : "; ", channel,
                        range.min, range.max, range.mean);
  return text;
}

}  // namespace

Json certificate_record_page(const CertificateInput& input) {
  const CertificateView& certificate = input.certificate;
  const FitResult& result = certificate.result;
  const MadeTables& tables = certificate.tables;
  RecordRows rows(certificate.record);
  rows.add(
      "Values (a, b)", "",
      fmt::format(
          "Errors are actual minus nominal, tool relative to workpiece; a compensation is its negative. The "
          "files hold what {} reads: {}",
          tables.format->name, tables.format->source));
  rows.add(
      "Kinematic chain, datum and signs (c)", "",
      fmt::format("{}; primary axis {}, secondary {}; ISO 841 and ISO 230-1", result.machine.structure.code,
                  letter_of(result.machine.datum.primary), letter_of(result.machine.datum.secondary)));
  rows.add_item("machine_state");
  rows.add("Positions of the axes", "", measured_travel_text(result));
  rows.add("Tool lengths and offsets", "", used_tools_text(result));
  rows.add_item("load");
  rows.add_item("feed", feeds_text(result));
  rows.add_item("ambient_temperature");
  rows.add_item("component_temperatures", temperatures_text(result));
  rows.add_item("active_compensations");
  return {{"rows", rows.json()}};
}

}  // namespace volcal::report
