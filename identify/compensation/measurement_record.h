#pragma once
/// What somebody records of a measurement beside its readings: which machine it was, who measured it with
/// what, and what ISO/TR 16907:2015, 9.1, asks to be documented. Texts, as they stand in the table [record]
/// of campaign.toml.

#include <map>
#include <span>
#include <string>
#include <string_view>

namespace volcal {

/// Names of the certificate in a folder of tables (report.h); they are no tables.
inline constexpr std::string_view kCertificatePage = "certificate.html";
inline constexpr std::string_view kCertificatePdf = "certificate.pdf";

struct RecordItem {
  std::string_view key;    ///< in [record]: "serial_number"
  std::string_view title;  ///< as a certificate prints it: "Serial number"
};
/// In the order of a certificate; among them what clause 9.1 asks for (recordable_conditions()).
std::span<const RecordItem> record_items();

struct MeasurementRecord {
  std::map<std::string, std::string> entries;      ///< by key of record_items()
  std::map<std::string, std::string> instruments;  ///< by kind: maker, serial number, calibration

  std::string entry(std::string_view key) const;  ///< empty = not recorded
};

}  // namespace volcal
