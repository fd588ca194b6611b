#pragma once
/// Findings in JSON: code, severity and data, beside their sentences. Numbers are SI.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "volcal/model/description/finding.h"

namespace volcal {

/// {"code": "station.guess-contradicted", "severity": "warning", "data": {"block": "station P1", "x": {"si":
/// 0.4, "unit": "mm", "si_per_unit": 0.001}}}
nlohmann::ordered_json finding_json(const Finding& finding);
nlohmann::ordered_json findings_json(const std::vector<Finding>& findings);

/// json[key] = a sentence each; json[key_findings] = the same as codes.
void add_findings(const std::string& key, const std::vector<Finding>& findings, nlohmann::ordered_json& json);

/// Adds "notes", a sentence each, and the same as "notes_findings"; nothing without notes.
void add_notes(const std::vector<Finding>& notes, nlohmann::ordered_json& json);

/// `otherwise` where the code is that of another version. Throws std::exception where the data are not those
/// of the code.
Finding finding_from(const nlohmann::ordered_json& json, const Finding& otherwise);

/// `sentences` with the codes that `list`, the array beside them, gives; all are verbatim where a file has no
/// codes (`list` null). Throws std::exception where there is not one finding per sentence.
std::vector<Finding> findings_from(const nlohmann::ordered_json& list,
                                   const std::vector<std::string>& sentences);

/// json[key], or null.
nlohmann::ordered_json value_or_null(const nlohmann::ordered_json& json, const std::string& key);

}  // namespace volcal
