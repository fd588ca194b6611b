#pragma once
/// What studies say of their campaigns.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"

namespace volcal::testing {

/// `volcal study STUDY OPTIONS`.
inline nlohmann::json campaigns_of_study(const std::string& study, const std::string& options) {
  const auto run = run_program("study " + study + " --json " + options);
  EXPECT_EQ(run.exit_code, 0) << run.errors;
  return nlohmann::json::parse(run.output).at("campaigns");
}

}  // namespace volcal::testing
