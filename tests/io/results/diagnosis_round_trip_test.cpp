// diagnosis.json: the keys that programs read, and back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/support/hand_made_diagnosis.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/results/diagnosis_json.h"
#include "volcal/identify/report/text/criticism/diagnosis_text.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

Json written() { return Json::parse(diagnosis_json(testing::hand_made_diagnosis())); }

TEST(DiagnosisJson, HoldsEveryKeyInEdgeUnits) {
  const Json document = written();
  EXPECT_EQ(document.at("verdict"), "NAMED_MORE_REMAINS");
  const Json& effect = document.at("effects").at(0);
  EXPECT_EQ(effect.at("kind"), "reversal");
  EXPECT_EQ(effect.at("target"), "EXX");
  EXPECT_EQ(effect.at("driver"), "dir_x");
  EXPECT_EQ(effect.at("shape"), "step");
  EXPECT_NEAR(effect.at("amplitude").get<double>(), 4.0, 1e-12);
  EXPECT_EQ(effect.at("unit"), "um");
  EXPECT_NEAR(effect.at("u").get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(effect.at("mdb").get<double>(), 0.5, 1e-12);
  EXPECT_EQ(effect.at("log10_p"), -12.5);
  EXPECT_EQ(effect.at("visible_fraction"), 0.75);
  EXPECT_EQ(document.at("one_of").at(0).at("target"), "EYY");
  EXPECT_EQ(document.at("further_one_of").at(0).at(0).at("target"), "EZZ");
  EXPECT_EQ(document.at("further_one_of").at(0).at(1).at("target"), "EYY");
  const auto& set = document.at("sets").at(1);
  EXPECT_EQ(set.at("chosen"), 1);
  EXPECT_EQ(set.at("matters"), true);
  EXPECT_EQ(set.at("members").at(0).at("difference_um"), 4.0);
  EXPECT_EQ(set.at("members").at(0).at("at_mm").at(2), 125.0);
  EXPECT_EQ(set.at("members").at(0).at("conditions").at("T_air_degC"), 21.5);
  EXPECT_EQ(set.at("members").at(0).at("model"), "alternative-2-1.toml");
  EXPECT_FALSE(set.at("members").at(1).contains("model"));
  const Json& unknown = document.at("unknown").at(0);
  EXPECT_EQ(unknown.at("variables"), (Json{"x", "time"}));
  EXPECT_EQ(unknown.at("direction"), "Z");
  EXPECT_EQ(unknown.at("rotation"), "EBX");
  EXPECT_NEAR(unknown.at("rms_um").get<double>(), 0.3, 1e-12);
  EXPECT_TRUE(unknown.at("period_mm").is_null());
  EXPECT_TRUE(unknown.at("with_one_of").empty());
  EXPECT_EQ(document.at("unknown").at(1).at("with_one_of"), (Json{"T_air", "T_column"}));
  EXPECT_NEAR(document.at("unknown").at(2).at("period_mm").get<double>(), 10.02, 1e-12);
  EXPECT_TRUE(document.at("not_visible").at(0).at("mdb").is_null());
  EXPECT_EQ(document.at("next_measurement").size(), 1U);
  EXPECT_EQ(document.at("next_measurement").at(0).at("separation_reached"), 7.5);
  EXPECT_EQ(document.at("next_measurement").at(0).at("separation_plain"), 3.125);
  EXPECT_EQ(document.at("confounding").at("effects").at(1), "reversal:EYY:dir_y:step");
  EXPECT_EQ(document.at("confounding").at("cosine").at(0), (Json{1.0, 0.96, nullptr}));
  const Json& step = document.at("ladder").at(1);
  EXPECT_EQ(step.at("model"), "1");
  EXPECT_EQ(step.at("added"), "reversal EXX");
  for (const auto& [key, value] : std::map<std::string, double>{{"rms_fit_um", 2.0},
                                                                {"rms_heldout_um", 2.0},
                                                                {"reduced_chi2", 1.5},
                                                                {"noise_floor_um", 2.0},
                                                                {"systematic_um", 0.0},
                                                                {"systematic_high_um", 0.5},
                                                                {"heldout_loglik_gain", 33.5}}) {
    EXPECT_NEAR(step.at(key).get<double>(), value, 1e-12) << key;
  }
  EXPECT_EQ(document.at("model_changes"), Json::array());
  EXPECT_EQ(document.at("noise").at(1).at("instrument"), "laser-tracer");
  ASSERT_EQ(document.at("removed_readings").size(), 3U);
  EXPECT_EQ(document.at("removed_readings").at(1).at("setup"), "S1");
  EXPECT_EQ(document.at("removed_readings").at(1).at("line"), 40);
  EXPECT_EQ(document.at("removed_readings").at(1).at("reading"), "length_mm");
  EXPECT_NEAR(document.at("detectable").at(1).at("volumetric_um").get<double>(), 0.375, 1e-12);
  EXPECT_TRUE(document.at("detectable").at(3).at("volumetric_um").is_null());
}

/// Same document again, numbers to rounding.
void expect_same_json(const Json& a, const Json& b, const std::string& place) {
  if (a.is_number_float() && b.is_number()) {
    EXPECT_NEAR(a.get<double>(), b.get<double>(), 1e-14 * (1.0 + std::abs(a.get<double>()))) << place;
    return;
  }
  ASSERT_EQ(a.type(), b.type()) << place;
  if (!a.is_structured()) {
    EXPECT_EQ(a, b) << place;
    return;
  }
  ASSERT_EQ(a.size(), b.size()) << place;
  for (const auto& [key, value] : a.items()) {
    const Json& other = b.is_array() ? b.at(std::stoul(key)) : b.at(key);
    expect_same_json(value, other, place + "/" + key);
  }
}

TEST(DiagnosisJson, RoundTrips) {
  const std::string text = diagnosis_json(testing::hand_made_diagnosis());
  const Diagnosis again = diagnosis_from_json(text, "diagnosis.json");
  expect_same_json(Json::parse(text), Json::parse(diagnosis_json(again)), "");
  EXPECT_EQ(again.effects[0].spec.options.number("amplitude"), 4e-6);
  EXPECT_EQ(again.effects[0].spec.options.text("symbol"), "EXX");
  EXPECT_TRUE(again.ranking[1].resolution);
  EXPECT_EQ(diagnosis_text(again), diagnosis_text(testing::hand_made_diagnosis()));
  EXPECT_THAT(diagnosis_text(again), HasSubstr("0.960  reversal EXX  reversal EYY"));
}

TEST(DiagnosisJson, WhatIsNotKnownOfHeldOutReadingsIsNoNumber) {
  Diagnosis diagnosis = testing::hand_made_diagnosis();
  for (LadderStep& step : diagnosis.ladder) {
    step.rms_heldout = step.noise_floor = step.systematic = step.systematic_low = step.systematic_high =
        step.heldout_loglik_gain = std::nan("");
  }
  const std::string text = diagnosis_json(diagnosis);
  for (const char* key : {"systematic_low_um", "systematic_high_um", "heldout_loglik_gain"})
    EXPECT_TRUE(Json::parse(text).at("ladder").at(0).at(key).is_null()) << key;
  const std::string said = diagnosis_text(diagnosis_from_json(text, "diagnosis.json"));
  const std::size_t from = said.find("Models compared");
  const std::string ladder = said.substr(from, said.find("\n\n", from) - from);
  EXPECT_EQ(ladder.find(" .. "), std::string::npos) << ladder;
  EXPECT_THAT(ladder, HasSubstr("-  "));
}

/// Diagnoses that were written before scans saw rotations.
TEST(DiagnosisJson, WhatOlderFilesLackMayBeMissing) {
  Json document = written();
  for (const char* key : {"rotation", "with_one_of", "period_mm"}) document.at("unknown").at(0).erase(key);
  const Diagnosis again = diagnosis_from_json(document.dump(), "old.json");
  EXPECT_EQ(again.unknown.at(0).rotation, std::nullopt);
  EXPECT_TRUE(again.unknown.at(0).with_one_of.empty());
  EXPECT_EQ(again.unknown.at(0).period, 0.0);
  EXPECT_EQ(again.unknown.at(0).direction, ScanDirection::Z);
}

/// Proposals keep their codes; of a file without them, their sentences.
TEST(DiagnosisJson, ProposalsComeBackAsCodes) {
  const Diagnosis diagnosis = testing::hand_made_diagnosis();
  Json document = written();
  EXPECT_EQ(findings_of(diagnosis_from_json(document.dump(), "diagnosis.json").proposals),
            findings_of(diagnosis.proposals));
  document.at("next_measurement").at(0).erase("finding");
  const Finding old = diagnosis_from_json(document.dump(), "old.json").proposals.at(0).finding;
  EXPECT_EQ(old, verbatim(sentence(diagnosis.proposals.at(0).finding)));
}

TEST(DiagnosisJson, UnknownEffectsComeBackInWords) {
  const Diagnosis again = diagnosis_from_json(written().dump(), "diagnosis.json");
  ASSERT_EQ(again.unknown.size(), 3U);
  EXPECT_EQ(again.unknown[0].dependence(), "x and time");
  EXPECT_EQ(again.unknown[0].action(), "Z, as EBX");
  EXPECT_EQ(again.unknown[1].dependence(), "dir_y and one of T_air, T_column");
  EXPECT_EQ(again.unknown[1].action(), "Y");
  EXPECT_EQ(again.unknown[2].action(), "Y, every 10.02 mm");
}

TEST(DiagnosisJson, UnitsWithDenominatorsComeBack) {
  Diagnosis diagnosis = testing::hand_made_diagnosis();
  diagnosis.effects[0].amplitudes[0] = {"expansion X", 2.5e-6, 1e-7, 2e-7, "um/m/K", 1e-6};
  diagnosis.one_of[0].amplitudes[0] = {"drift", 1e-6 / 3600.0, 1e-11, 2e-11, "urad/h", 1e-6 / 3600.0};
  const Diagnosis again = diagnosis_from_json(diagnosis_json(diagnosis), "d");
  EXPECT_NEAR(again.effects[0].amplitudes[0].value, 2.5e-6, 1e-18);
  EXPECT_NEAR(again.one_of[0].amplitudes[0].si_per_unit, 1e-6 / 3600.0, 1e-22);
}

TEST(DiagnosisJson, SaysWhatIsWrongWithAFile) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      diagnosis_from_json(text, "old.json");
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_THAT(message("{\"format\": "), HasSubstr("not complete JSON"));
  EXPECT_THAT(message("{\"format\": \"volcal-result-1\"}"), HasSubstr("volcal-result-1"));
  Json document = written();
  document["verdict"] = "PERHAPS";
  EXPECT_THAT(message(document.dump()), HasSubstr("PERHAPS"));
  const auto with = [](const char* key, const Json& value) {
    Json changed = written();
    changed.at("unknown").at(0)[key] = value;
    return changed.dump();
  };
  EXPECT_THAT(message(with("variables", {"x", "humour"})), HasSubstr("\"humour\" is not a variable"));
  EXPECT_THAT(message(with("direction", "upwards")), HasSubstr("\"upwards\" is not a direction of a scan"));
  EXPECT_THAT(message(with("rotation", "EQX")), HasSubstr("\"EQX\" is not an error motion"));
  const testing::ScratchFolder folder;
  EXPECT_THROW(read_diagnosis(folder.path().string()), InputError);
}

}  // namespace
}  // namespace volcal
