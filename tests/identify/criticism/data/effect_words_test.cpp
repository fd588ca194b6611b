// Words of effects' names: whatever is registered can be looked up in `volcal diagnose --list`.

#include "volcal/identify/criticism/data/effect_words.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/effect_campaign.h"
#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr NamePart kParts[] = {NamePart::Target, NamePart::Driver, NamePart::Shape};

void expect_known(const EffectName& name, std::set<const EffectWord*>& used) {
  for (const NamePart part : kParts) {
    const EffectWord* word = find_word(part, name);
    EXPECT_NE(word, nullptr) << full_name(name) << ": add the word to effect_words.cpp";
    used.insert(word);
  }
}

TEST(EffectWords, CoverEveryRegisteredEffectAndNothingElse) {
  std::set<const EffectWord*> used;
  for (const char* structure : {"w X' b Y Z t", "w C' X' b Y Z t"}) {
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
      EXPECT_TRUE(used.contains(&word)) << word.pattern << " is the word of no effect";
    }
  }
}

TEST(EffectWords, CapitalsStandForNamesOfTheFiles) {
  const auto target = [](const std::string& text) {
    const EffectWord* word = find_word(NamePart::Target, {"reversal", text, "x", "step"});
    return word == nullptr ? "none" : std::string(word->pattern);
  };
  EXPECT_EQ(target("EXX"), "SYMBOL");
  EXPECT_EQ(target("EC0Y"), "SYMBOL");
  EXPECT_EQ(target("EXQ"), "none");
  EXPECT_EQ(target("tool"), "tool");
  EXPECT_EQ(target("tool long probe"), "tool TOOL");
  EXPECT_EQ(target("readings of S (1)"), "readings of SETUP");
  EXPECT_EQ(target("EAX EBX"), "none") << "only for what a model leaves out";
  const EffectWord* shape = find_word(NamePart::Shape, {"servo-mismatch", "XY", "dir", "sin(2 phi)"});
  ASSERT_NE(shape, nullptr);
  EXPECT_EQ(shape->pattern, "sin(2 phi)");
  EXPECT_EQ(find_scan_word("nonsense"), nullptr);
  EXPECT_NE(find_scan_word("T_column 2"), nullptr);
  EXPECT_EQ(full_name({"reversal", "EXX", "dir_x", "step"}), "reversal:EXX:dir_x:step");
}

/// What scans see nearly alike is told in this order.
TEST(ScanWords, TheSimplestIsTheLeastFarFetched) {
  EXPECT_EQ(complexity_rank({"station P1"}, "X"), 0);
  EXPECT_EQ(complexity_rank({"instrument ball-bar"}, "beam"), 0);
  EXPECT_EQ(complexity_rank({"station P1"}, "beam"), 1) << "its dead path is a parameter of the model";
  EXPECT_EQ(complexity_rank({"x", "dir_x"}, "Y"), 1);
  EXPECT_EQ(complexity_rank({"station P1", "time"}, "X"), 1) << "a station drifts in time";
  EXPECT_EQ(complexity_rank({"station P1", "T_air"}, "X"), 2);
  EXPECT_EQ(complexity_rank({"length", "T_air"}, "beam"), 1) << "the wavelength follows the air";
  EXPECT_EQ(complexity_rank({"length", "time"}, "beam"), 2);
  EXPECT_EQ(complexity_rank({"x", "time"}, "X"), 1);
  EXPECT_EQ(complexity_rank({"time", "T_air"}, "X"), 3);
}

}  // namespace
}  // namespace volcal
