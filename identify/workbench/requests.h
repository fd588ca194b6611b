#pragma once
/// What a request of the page holds, and how it is refused.

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "volcal/identify/workbench/frame.h"

namespace volcal::workbench {

/// What cannot be done now.
struct Refusal : std::runtime_error {
  int status;
  std::string remedy;
  Refusal(int code, const std::string& problem, std::string what_to_do);
};

/// Throw Refusal where the body holds no such value.
std::string text_of(const Json& body, const char* key);
std::size_t number_of(const Json& body, const char* key);
/// None where the key is not there.
std::vector<std::string> texts_of(const Json& body, const char* key);

Json error_json(const std::string& problem, const std::string& remedy);

}  // namespace volcal::workbench
