// Lines of text for a session.

#include "volcal/identify/session/session_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;

TEST(SessionCommandText, IsReadAndWrittenAlike) {
  for (const char* line :
       {"add reversal:EYY:dir_y:step", "remove thermal-drift:station P1 x:T_air:linear",
        "add custom:EXX:dir_x T_column:dir_x * (T_column > 20 ? 1 : 2)",
        "formula EXX += dir_x * (T_column - 20)", "formula EXX += sin(x / p) with p=10+-1 q=3", "refit",
        "refit 1", "confirm", "confirm 3", "climb", "draw 2", "leave-out 3,7-9,12 cable moved", "undo",
        "redo", "go 4"})
    EXPECT_EQ(to_string(session_command_from(line)), line);
}

TEST(SessionCommandText, HoldsWhatItSays) {
  const SessionCommand command = session_command_from("  leave-out 9-11,3,10  the cable moved ");
  EXPECT_EQ(command.verb, SessionCommand::Verb::LeaveOut);
  EXPECT_THAT(command.observations, ElementsAre(3U, 9U, 10U, 11U));
  EXPECT_EQ(command.reason, "the cable moved");
  const SessionCommand formula = session_command_from("formula EXX += x^p with p=2+-0.1");
  EXPECT_EQ(formula.formula, "EXX += x^p");
  EXPECT_THAT(formula.parameters, ElementsAre("p=2+-0.1"));
  EXPECT_EQ(session_command_from("draw").number, 0U);
  EXPECT_EQ(session_command_from("add a:b:c:d:e").effect.shape, "d:e");
}

TEST(SessionCommandText, IsRefusedWithARemedy) {
  for (const char* line : {"", "jump", "add", "add reversal", "add reversal:EXX::step", "go", "go -1",
                           "go 1x", "leave-out 3", "leave-out 5-3 why", "leave-out a why",
                           "leave-out 1-999999999999 why", "undo twice", "draw 0x", "draw 0"}) {
    try {
      session_command_from(line);
      ADD_FAILURE() << "taken: " << line;
    } catch (const InputError& error) {
      EXPECT_FALSE(error.remedy().empty()) << line;
    }
  }
}

}  // namespace
}  // namespace volcal
