#include "volcal/identify/text/json_input.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "volcal/identify/text/nesting.h"
#include "volcal/identify/text/text_file.h"

namespace volcal {
namespace {

using Json = nlohmann::ordered_json;

/// "key 'rank' not found" of "[json.exception.out_of_range.403] key 'rank' not found".
std::string missing_entry(const std::string& message) {
  const std::size_t key = message.find("key '"), end = message.find('\'', key + 5);
  if (key == std::string::npos || end == std::string::npos) return "an entry of a list is missing";
  return "the key " + printable(message.substr(key + 5, end - key - 5)) + " is missing";
}

}  // namespace

Json parsed_json(const std::string& text, const std::string& file, const std::string& remedy) {
  require_shallow(text, NestedText::Json, file);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    throw InputError({file, static_cast<int>(line)}, "the file is not complete JSON", remedy);
  } catch (const Json::exception&) {
    throw InputError({file, 0}, "a number in it is too large", remedy);
  }
}

std::string json_problem(const std::exception& error) {
  if (dynamic_cast<const Json::out_of_range*>(&error) != nullptr) return missing_entry(error.what());
  if (dynamic_cast<const Json::exception*>(&error) != nullptr)
    return "a value is of another type than volcal writes";
  if (dynamic_cast<const std::out_of_range*>(&error) != nullptr ||
      dynamic_cast<const std::length_error*>(&error) != nullptr)
    return "a number or a name in it does not fit the rest";
  return printable(error.what());
}

}  // namespace volcal
