#include "volcal/identify/compensation/measurement_record.h"

#include <array>

namespace volcal {
namespace {

constexpr bool kOfClause = true;

constexpr std::array kItems = {
    RecordItem{"serial_number", "Serial number"},
    RecordItem{"manufacturer", "Manufacturer"},
    RecordItem{"control", "Numerical control"},
    RecordItem{"owner", "Owner"},
    RecordItem{"place", "Place"},
    RecordItem{"operator", "Operator"},
    RecordItem{"measured_on", "Measured on"},
    RecordItem{"remarks", "Remarks"},
    RecordItem{"machine_state", "Machine before the measurement, warm-up", kOfClause},
    RecordItem{"load", "Load", kOfClause},
    RecordItem{"feed", "Feed speeds and accelerations", kOfClause},
    RecordItem{"ambient_temperature", "Ambient temperature", kOfClause},
    RecordItem{"component_temperatures", "Temperatures of machine components", kOfClause},
    RecordItem{"active_compensations", "Compensations active while it was measured", kOfClause},
};

}  // namespace

std::span<const RecordItem> record_items() { return kItems; }

std::string MeasurementRecord::entry(std::string_view key) const {
  const auto found = entries.find(std::string(key));
  return found == entries.end() ? std::string() : found->second;
}

}  // namespace volcal
