#pragma once
/// States of a search over small simulated campaigns.

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/search/model_state.h"

namespace volcal::testing_support {

/// No reading held out.
inline std::shared_ptr<const SearchSetting> setting_of(const LinearModel& model) {
  return std::make_shared<SearchSetting>(model, std::vector<bool>(model.size(), false),
                                         std::vector<std::string>{}, 1);
}

/// Texts of a name; an empty part fits any.
struct WantedName {
  std::string kind, target, driver, shape;
};

inline const FamilyTest& test_of(const ModelState& tested, const WantedName& wanted) {
  const auto fits = [](const std::string& part, const std::string& own) {
    return part.empty() || part == own;
  };
  for (const FamilyTest& test : tested.tests().families) {
    const EffectName name = tested.setting().families[test.family].name();
    if (fits(wanted.kind, name.kind) && fits(wanted.target, name.target.name()) &&
        fits(wanted.driver, name.driver.name()) && fits(wanted.shape, name.shape))
      return test;
  }
  throw std::out_of_range(wanted.kind + ":" + wanted.target);
}

/// Tests with the given scans alone, all of which exceed the noise.
inline ModelState with_scans(const ModelState& tested, std::vector<GenericTest> scans) {
  ModelTests tests = tested.tests();
  tests.scan_exceeds.assign(scans.size(), true);
  tests.scans = std::move(scans);
  return tested.with_tests(std::move(tests));
}

}  // namespace volcal::testing_support
