#pragma once
/// JSON as it leaves the program. JSON is UTF-8, names of files and columns need not be: bytes that are not
/// UTF-8 become U+FFFD, so that a name never costs the result.

#include <nlohmann/json.hpp>
#include <string>

namespace volcal {

/// `indent`: spaces a level; -1: all on one line.
template <class Json>
std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

/// `text` with what is not UTF-8 replaced alike.
inline std::string utf8_text(const std::string& text) {
  return nlohmann::json::parse(json_text(nlohmann::json(text), -1)).get<std::string>();
}

}  // namespace volcal
