// Words of effects' names: whatever is registered can be looked up in `volcal diagnose --list`.

#include "volcal/identify/criticism/data/effect_words.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "tests/support/find_word.h"
#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using testing_support::find_word;

constexpr NamePart kParts[] = {NamePart::Target, NamePart::Driver, NamePart::Shape};

using UsedWords = std::set<std::pair<NamePart, std::string>>;

/// A pattern stands once in each part, whatever its kind.
void expect_known(const EffectName& name, UsedWords& used) {
  for (const NamePart part : kParts) {
    const auto word = find_word(part, name);
    ASSERT_TRUE(word) << full_name(name) << ": add the word to the schema of its kind";
    used.emplace(part, std::string(word->pattern) + std::string(word->kind));
  }
}

TEST(EffectWords, CoverEveryRegisteredEffectAndNothingElse) {
  UsedWords used;
  for (const char* structure : {"w X' b Y Z t", "w C' X' b Y Z t", "w C' A' X' b Y Z t"}) {
    const Campaign campaign = testing_support::effect_campaign(structure);
    for (const EffectKind* kind : effect_kinds()) {
      for (const EffectSpec& spec : kind->examples(campaign))
        expect_known(kind->make(spec, {})->name(), used);
    }
    ModelSpec nothing;
    nothing.default_function.basis = "zero";
    for (const LocationSymbol& each : campaign.machine.datum.squareness())
      nothing.locations_off.push_back(each);
    const MeasurementModel model(campaign, nothing);
    for (const LeftOutError& error : left_out_errors(model)) expect_known(error.effect->name(), used);
  }
  expect_known(resolution_name({Component::A, AxisName::X}), used);
  for (const NamePart part : kParts) {
    for (const EffectWord& word : effect_words(part)) {
      EXPECT_TRUE(used.contains({part, std::string(word.pattern) + std::string(word.kind)}))
          << word.pattern << " is the word of no effect";
    }
  }
}

TEST(EffectWords, CapitalsStandForNamesOfTheFiles) {
  const auto target = [](const std::string& text) {
    const auto word = find_word(NamePart::Target, EffectName::of_parts("reversal", text, "x", "step"));
    return word ? std::string(word->pattern) : "none";
  };
  EXPECT_EQ(target("EXX"), "SYMBOL");
  EXPECT_EQ(target("EC0Y"), "SYMBOL");
  EXPECT_EQ(target("EXQ"), "none");
  EXPECT_EQ(target("tool"), "tool");
  EXPECT_EQ(target("tool long probe"), "tool TOOL");
  EXPECT_EQ(target("readings of S (1)"), "readings of SETUP");
  EXPECT_EQ(target("EAX EBX"), "none") << "only for what a model leaves out, and one cause in several places";
  const auto several =
      find_word(NamePart::Driver, EffectName::of_parts("common-reversal", "EXX EYY", "dir_x dir_y", "step"));
  ASSERT_TRUE(several);
  EXPECT_EQ(several->pattern, "dir_AXIS dir_AXIS ...");
  EXPECT_TRUE(
      find_word(NamePart::Target, EffectName::of_parts("common-reversal", "EXX EYY", "dir_x dir_y", "step")));
  const auto shape =
      find_word(NamePart::Shape, EffectName::of_parts("servo-mismatch", "XY", "dir", "sin(2 phi)"));
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->pattern, "sin(2 phi)");
  EXPECT_EQ(full_name(EffectName::of_parts("reversal", "EXX", "dir_x", "step")), "reversal:EXX:dir_x:step");
}

/// A pattern and a meaning for every variable that scans go through, by which its name is found.
TEST(ScanWords, StandForTheVariablesOfTheScans) {
  using Kind = Variable::Kind;
  ASSERT_EQ(scan_words().size(), static_cast<std::size_t>(Kind::TravelSinceTurning));
  EXPECT_EQ(scan_words()[static_cast<std::size_t>(Kind::Run)].pattern, "run");
  EXPECT_EQ(scan_words()[static_cast<std::size_t>(Kind::Run)].meaning, "number of the run");
  EXPECT_EQ(scan_words()[static_cast<std::size_t>(Kind::Station)].pattern, "station STATION");
  EXPECT_EQ(scan_words()[static_cast<std::size_t>(Kind::Station)].meaning,
            "whether the reading was taken from this station");
}

/// What scans see nearly alike is reported in this order.
TEST(ScanWords, TheSimplestIsTheLeastFarFetched) {
  const auto rank = [](const std::vector<std::string>& names, ScanDirection direction) {
    return complexity_rank(testing_support::variables_named(names), direction);
  };
  EXPECT_EQ(rank({"station P1"}, ScanDirection::X), 0);
  EXPECT_EQ(rank({"instrument ball-bar"}, ScanDirection::Beam), 0);
  EXPECT_EQ(rank({"station P1"}, ScanDirection::Beam), 1) << "its dead path is a parameter of the model";
  EXPECT_EQ(rank({"x", "dir_x"}, ScanDirection::Y), 1);
  EXPECT_EQ(rank({"station P1", "time"}, ScanDirection::X), 1) << "a station drifts in time";
  EXPECT_EQ(rank({"station P1", "T_air"}, ScanDirection::X), 2);
  EXPECT_EQ(rank({"length", "T_air"}, ScanDirection::Beam), 1) << "the wavelength follows the air";
  EXPECT_EQ(rank({"length", "time"}, ScanDirection::Beam), 2);
  EXPECT_EQ(rank({"x", "time"}, ScanDirection::X), 1);
  EXPECT_EQ(rank({"time", "T_air"}, ScanDirection::X), 3);
}

}  // namespace
}  // namespace volcal
