#include "volcal/identify/words/finding_json.h"

#include <stdexcept>
#include <utility>

#include "volcal/identify/text/json_number.h"
#include "volcal/identify/words/sentences.h"

namespace volcal {
namespace {

using Json = nlohmann::ordered_json;

Json value_json(const FindingNumber& number) {
  Json json = {{"si", number_json(number.si)}};
  if (number.unit.empty() && number.si_per_unit == 1.0) return json;
  json["unit"] = number.unit;
  json["si_per_unit"] = number_json(number.si_per_unit);
  return json;
}

Json value_json(const std::vector<FindingNumber>& numbers) {
  Json json = Json::array();
  for (const FindingNumber& each : numbers) json.push_back(value_json(each));
  return json;
}

template <class T>
Json value_json(const T& value) {
  return value;
}

FindingNumber finding_number_from(const Json& json) {
  FindingNumber number{number_from(json.at("si"))};
  if (!json.contains("unit")) return number;
  number.unit = json.at("unit").get<std::string>();
  number.si_per_unit = number_from(json.at("si_per_unit"));
  return number;
}

FindingValue list_from(const Json& json) {
  if (json.at(0).is_string()) return json.get<std::vector<std::string>>();
  if (json.at(0).is_number()) return json.get<std::vector<std::int64_t>>();
  std::vector<FindingNumber> numbers;
  for (const Json& each : json) numbers.push_back(finding_number_from(each));
  return numbers;
}

FindingValue value_from(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_integer()) return json.get<std::int64_t>();
  if (json.is_string()) return json.get<std::string>();
  if (json.is_array()) return list_from(json);
  return finding_number_from(json);
}

}  // namespace

Json finding_json(const Finding& finding) {
  Json data = Json::object();
  for (const auto& [key, value] : finding.data)
    data[key] = std::visit([](const auto& each) { return value_json(each); }, value);
  return {{"code", to_string(finding.code)},
          {"severity", to_string(finding.severity())},
          {"data", std::move(data)}};
}

Json findings_json(const std::vector<Finding>& findings) {
  Json list = Json::array();
  for (const Finding& finding : findings) list.push_back(finding_json(finding));
  return list;
}

void add_findings(const std::string& key, const std::vector<Finding>& findings, Json& json) {
  json[key] = sentences(findings);
  json[key + "_findings"] = findings_json(findings);
}

void add_notes(const std::vector<Finding>& notes, Json& json) {
  if (!notes.empty()) add_findings("notes", notes, json);
}

Finding finding_from(const Json& json, const Finding& otherwise) {
  const auto code = finding_code(json.at("code").get<std::string>());
  if (!code) return otherwise;
  Finding finding{*code};
  for (const auto& [key, value] : json.at("data").items()) finding.data[key] = value_from(value);
  static_cast<void>(sentence(finding));
  return finding;
}

std::vector<Finding> findings_from(const Json& list, const std::vector<std::string>& sentences) {
  std::vector<Finding> findings;
  for (const std::string& each : sentences) findings.push_back(verbatim(each));
  if (list.is_null()) return findings;
  if (!list.is_array() || list.size() != sentences.size())
    throw std::invalid_argument("there is not one finding for each sentence");
  for (std::size_t i = 0; i < findings.size(); ++i) findings[i] = finding_from(list[i], findings[i]);
  return findings;
}

Json value_or_null(const Json& json, const std::string& key) {
  const auto found = json.find(key);
  return found == json.end() ? Json() : *found;
}

}  // namespace volcal
