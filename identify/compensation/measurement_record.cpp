#include "volcal/identify/compensation/measurement_record.h"

#include <array>

namespace volcal {
namespace {

constexpr std::array kItems = {
    RecordItem{"serial_number", "Serial number"},
    RecordItem{"manufacturer", "Manufacturer"},
    RecordItem{"control", "Numerical control"},
    RecordItem{"owner", "Owner"},
    RecordItem{"place", "Place"},
    RecordItem{"operator", "Operator"},
    RecordItem{"measured_on", "Measured on"},
    RecordItem{"remarks", "Remarks"},
    RecordItem{"machine_state", "Machine before the measurement, warm-up"},
    RecordItem{"load", "Load"},
    RecordItem{"feed", "Feed speeds and accelerations"},
    RecordItem{"ambient_temperature", "Ambient temperature"},
    RecordItem{"component_temperatures", "Temperatures of machine components"},
    RecordItem{"active_compensations", "Compensations active while it was measured"},
};

}  // namespace

std::span<const RecordItem> record_items() { return kItems; }

std::string MeasurementRecord::entry(std::string_view key) const {
  const auto found = entries.find(std::string(key));
  return found == entries.end() ? std::string() : found->second;
}

}  // namespace volcal
