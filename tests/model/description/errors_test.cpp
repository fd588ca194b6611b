// Bad input that names settings of the user, which each front end calls otherwise.

#include "volcal/model/description/errors.h"

#include <gtest/gtest.h>

#include <string>

namespace volcal {
namespace {

std::string as_argument(const std::string& setting) {
  return setting == "rotary-step" ? "rotary_step_deg" : "?";
}

TEST(SettingText, IsWordedByTheFrontEnd) {
  const SettingText text = "of " + (setting("rotary-step") + " 0.01" + " and " + std::string("--step"));
  EXPECT_EQ(text.as_options(), "of --rotary-step 0.01 and --step");
  EXPECT_EQ(text.in_words_of(as_argument), "of rotary_step_deg 0.01 and --step") << "text is no setting";
}

TEST(InputError, NamesSettingsAsOptionsUnlessAsked) {
  const InputError error({"a.toml", 3}, setting("rotary-step") + " 0 is out of range", "give 0.1 to 90 deg");
  EXPECT_EQ(error.problem(), "--rotary-step 0 is out of range");
  EXPECT_STREQ(error.what(), "a.toml:3: --rotary-step 0 is out of range (give 0.1 to 90 deg)");
  const InputError worded = error.in_words_of(as_argument);
  EXPECT_EQ(worded.problem(), "rotary_step_deg 0 is out of range");
  EXPECT_STREQ(worded.what(), "a.toml:3: rotary_step_deg 0 is out of range (give 0.1 to 90 deg)");
  EXPECT_EQ(worded.place().line, 3);
}

TEST(InputError, WithoutSettingsStaysAsItIs) {
  const InputError error({}, "--step is a text here", "remedy");
  EXPECT_EQ(error.in_words_of(as_argument).problem(), "--step is a text here");
}

}  // namespace
}  // namespace volcal
