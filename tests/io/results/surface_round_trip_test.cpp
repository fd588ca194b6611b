// What a diagnosis has drawn, in diagnosis.json and back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/hand_made_diagnosis.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/report/text/criticism/diagnosis_text.h"

namespace volcal {
namespace {

Diagnosis with_a_drawn_surface() {
  Diagnosis diagnosis = testing::hand_made_diagnosis();
  SurfaceFinding surface;
  surface.name = EffectName::of_parts("empirical", "EAY", "y z", "surface");
  surface.label = "surface EAY by y z";
  surface.spec.kind = "empirical";
  surface.spec.options.set("target", std::string("EAY"));
  surface.spec.options.set("drivers", std::string("y z"));
  surface.spec.options.set("from", std::vector<double>{0.0, -300.0});
  surface.spec.options.set("to", std::vector<double>{400.0, 0.0});
  surface.spec.options.set("pieces", std::vector<double>{1.0, 1.0});
  surface.spec.options.set("coefficients", std::vector<double>(16, 2.5e-6));
  surface.drivers = variables_in("y z");
  surface.unit = "urad";
  surface.si_per_unit = 1e-6;
  surface.log_evidence = 88.5;
  surface.effective_parameters = 12.25;
  surface.rms = 1.25e-6;
  surface.largest = -4.5e-6;
  surface.largest_u = 0.5e-6;
  surface.at = {310.0, -120.0};
  surface.free = {"any function of y alone: the error functions hold it"};
  FormulaFinding law;
  law.label = "EAY by y * z^2";
  law.spec.kind = "custom";
  law.spec.options.set("target", std::string("EAY"));
  law.spec.options.set("expression", std::string("y * z^2"));
  law.spec.options.set("amplitude", 1e-12);
  law.amplitude = 1e-12;
  law.u = 1e-13;
  law.unit = "urad/mm3";
  law.si_per_unit = 1e-6;
  law.log_evidence = 90.0;
  law.gain = 189.5;
  law.log10_p = -41.25;
  surface.formulas = {law};
  diagnosis.surfaces = {surface};
  diagnosis.asked_laws = {{surface.label, 88.5, 121, {law, law}}};
  diagnosis.asked_laws.front().laws.back().log_evidence = 80.0;
  diagnosis.tried = {diagnosis.effects.front()};
  diagnosis.tried_errors = {{.rms_heldout = 0.7e-6, .systematic = 0.25e-6}};
  diagnosis.unknown.insert(
      diagnosis.unknown.begin(),
      {variables_in("y z"), {}, ScanDirection::Z, ErrorSymbol{Component::A, AxisName::Y}, 0.4e-6, -60.0});
  return diagnosis;
}

TEST(SurfaceJson, HoldsEveryKeyInEdgeUnits) {
  const auto json = nlohmann::json::parse(diagnosis_json(with_a_drawn_surface())).at("surfaces").at(0);
  EXPECT_EQ(json.at("label"), "surface EAY by y z");
  EXPECT_EQ(json.at("unit"), "urad");
  EXPECT_DOUBLE_EQ(json.at("largest").get<double>(), -4.5);
  EXPECT_DOUBLE_EQ(json.at("u").get<double>(), 0.5);
  EXPECT_EQ(json.at("at"), (nlohmann::json{310.0, -120.0}));
  EXPECT_THAT(json.at("model_toml").get<std::string>(),
              ::testing::HasSubstr("coefficients_urad = [2.5, 2.5"));
  EXPECT_THAT(json.at("formulas").at(0).at("model_toml").get<std::string>(),
              ::testing::HasSubstr("expression = \"y * z^2\""));
}

TEST(SurfaceJson, HoldsLawsThatWereAskedForAndWhatIsLeftWithAGuess) {
  const Diagnosis diagnosis = with_a_drawn_surface();
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis));
  const auto& asked = json.at("asked_laws").at(0);
  EXPECT_EQ(asked.at("tried"), 121);
  EXPECT_EQ(asked.at("laws").at(0).at("gain"), 189.5);
  EXPECT_EQ(asked.at("laws").at(0).at("log10_p"), -41.25);
  EXPECT_DOUBLE_EQ(json.at("tried_errors").at(0).at("systematic_um").get<double>(), 0.25);
  EXPECT_TRUE(json.at("tried_errors").at(0).at("systematic_low_um").is_null());
  EXPECT_EQ(diagnosis.asked_laws.front().sufficient(), 1u);
  EXPECT_THAT(diagnosis_text(diagnosis),
              ::testing::HasSubstr("Laws of the surface EAY by y z: 121 were tried, 1 explain as much as it "
                                   "does (log evidence 88.5)"));
}

TEST(SurfaceJson, ComesBack) {
  const testing::ScratchFolder scratch;
  const Diagnosis diagnosis = with_a_drawn_surface();
  std::ofstream(scratch.path() / "diagnosis.json") << diagnosis_json(diagnosis);
  const Diagnosis again = read_diagnosis((scratch.path() / "diagnosis.json").string());
  ASSERT_EQ(again.surfaces.size(), 1u);
  const SurfaceFinding &before = diagnosis.surfaces.front(), &after = again.surfaces.front();
  EXPECT_EQ(after.name, before.name);
  EXPECT_EQ(after.spec.options.all(), before.spec.options.all());
  EXPECT_EQ(after.drivers, before.drivers);
  EXPECT_DOUBLE_EQ(after.largest, before.largest);
  EXPECT_DOUBLE_EQ(after.largest_u, before.largest_u);
  EXPECT_EQ(after.at, before.at);
  EXPECT_EQ(after.free, before.free);
  EXPECT_DOUBLE_EQ(after.log_evidence, before.log_evidence);
  EXPECT_DOUBLE_EQ(after.effective_parameters, before.effective_parameters);
  ASSERT_EQ(after.formulas.size(), 1u);
  EXPECT_EQ(after.formulas.front().spec.options.all(), before.formulas.front().spec.options.all());
  EXPECT_EQ(after.formulas.front().unit, "urad/mm3");
  EXPECT_DOUBLE_EQ(after.formulas.front().amplitude, 1e-12);
  EXPECT_EQ(after.accepted_spec().kind, "custom");
  EXPECT_EQ(diagnosis_text(again), diagnosis_text(diagnosis));
}

/// What a surface was drawn for is in the model; only the rest is still seen.
TEST(SurfaceJson, TheRestAloneIsStillSeen) {
  const Diagnosis diagnosis = with_a_drawn_surface();
  EXPECT_EQ(remaining_unknown(diagnosis).size(), diagnosis.unknown.size() - 1);
  EXPECT_EQ(names_of(remaining_unknown(diagnosis).front().variables),
            (std::vector<std::string>{"x", "time"}));
}

/// Without any effect of a name, too.
TEST(SurfaceJson, WhatWasDrawnIsListedWithItsRankAndSize) {
  Diagnosis diagnosis = with_a_drawn_surface();
  diagnosis.effects.clear();
  diagnosis.one_of.clear();
  diagnosis.further_one_of.clear();
  EXPECT_THAT(diagnosis_text(diagnosis),
              ::testing::ContainsRegex(
                  "1 +EAY by y \\* z\\^2 +custom +-4.50 \\+- 0.98 +urad +y = 310 mm, z = -120 mm"));
}

/// Residuals of 5 um before and 4 um after: what is removed is 3 um.
TEST(SurfaceJson, WhatASurfaceRemovesIsTheFallOfTheSquares) {
  Diagnosis diagnosis = with_a_drawn_surface();
  diagnosis.ladder.assign(2, {});
  diagnosis.ladder[0].rms_fit = 5e-6;
  diagnosis.ladder[1].rms_fit = 4e-6;
  EXPECT_EQ(removed_rms(diagnosis, diagnosis.surfaces.front()), std::nullopt);
  diagnosis.ladder[1].added = diagnosis.surfaces.front().label;
  EXPECT_NEAR(removed_rms(diagnosis, diagnosis.surfaces.front()).value(), 3e-6, 1e-15);
  const auto json = nlohmann::json::parse(diagnosis_json(diagnosis));
  EXPECT_NEAR(json.at("surfaces").at(0).at("removed_um").get<double>(), 3.0, 1e-9);
}

/// After what was named or could not be separated, before what was not added.
TEST(SurfaceJson, WhatWasDrawnHasARank) {
  Diagnosis diagnosis = with_a_drawn_surface();
  diagnosis.ranking.push_back(diagnosis.effects.front());
  diagnosis.ranking.back().name = EffectName::of_parts("dead-path", "readings", "time", "linear");
  const std::vector<EffectFinding> ranked = ranked_effects(diagnosis);
  const auto drawn = std::ranges::find(ranked, "EAY by y * z^2", &EffectFinding::label);
  ASSERT_NE(drawn, ranked.end());
  EXPECT_EQ(drawn->spec.kind, "custom");
  const auto place = [&](const EffectName& name) {
    return std::ranges::find(ranked, name, &EffectFinding::name);
  };
  for (const EffectFinding& added : diagnosis.effects) EXPECT_LT(place(added.name), drawn) << added.label;
  for (const auto* set : sets_of_alternatives(diagnosis)) {
    for (const EffectFinding& member : *set) EXPECT_LT(place(member.name), drawn) << member.label;
  }
  EXPECT_LT(drawn, place(diagnosis.ranking.back().name));
  EXPECT_NE(place(diagnosis.ranking.back().name), ranked.end());
}

}  // namespace
}  // namespace volcal
