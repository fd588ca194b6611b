#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace volcal::test {

/// The data of a page of a report's document.
inline nlohmann::json page_data(const nlohmann::json& document, const std::string& kind) {
  for (const nlohmann::json& page : document.at("pages")) {
    if (page.at("kind") == kind) return page.at("data");
  }
  ADD_FAILURE() << "no page " << kind;
  return {};
}

}  // namespace volcal::test
