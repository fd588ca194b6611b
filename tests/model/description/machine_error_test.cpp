#include "volcal/model/description/machine_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace volcal {
namespace {

TEST(MachineError, ANameLeadsBackToItsKind) {
  const ErrorSymbol motion{Component::A, AxisName::Z};
  const LocationSymbol location{Component::C, AxisName::Y};
  EXPECT_EQ(MachineError::parse("EAZ"), MachineError{motion});
  EXPECT_EQ(MachineError::parse("EC0Y"), MachineError{location});
  EXPECT_EQ(MachineError::parse("reversal EXX"), MachineError{"reversal EXX"});
  for (const char* name : {"EAZ", "EC0Y", "EX0C", "reversal EXX", "station P1", ""})
    EXPECT_EQ(MachineError::parse(name).name(), name);
}

TEST(MachineError, AMotionHasASymbolOfItsAxisAndComponent) {
  const MachineError error{ErrorSymbol{Component::X, AxisName::C}};
  EXPECT_EQ(error.motion(), (ErrorSymbol{Component::X, AxisName::C}));
  EXPECT_FALSE(error.location());
  EXPECT_TRUE(error.has_symbol());
  EXPECT_EQ(error.axis(), AxisName::C);
  EXPECT_EQ(error.component(), Component::X);
  EXPECT_FALSE(error.is_angle());
}

TEST(MachineError, ASquarenessIsALocationErrorAndAnAngle) {
  const MachineError error{LocationSymbol{Component::C, AxisName::Y}};
  EXPECT_FALSE(error.motion());
  EXPECT_EQ(error.location(), (LocationSymbol{Component::C, AxisName::Y}));
  EXPECT_TRUE(error.has_symbol());
  EXPECT_EQ(error.axis(), AxisName::Y);
  EXPECT_EQ(error.component(), Component::C);
  EXPECT_TRUE(error.is_angle());
}

TEST(MachineError, AMereNameHasNeitherAxisNorComponent) {
  const MachineError error{"reversal EAX"};
  EXPECT_FALSE(error.motion() || error.location() || error.has_symbol());
  EXPECT_FALSE(error.axis() || error.component() || error.is_angle());
}

TEST(MachineError, ErrorsWithOneNameAreOne) {
  const std::set<MachineError> errors = {MachineError{ErrorSymbol{Component::A, AxisName::Z}},
                                         MachineError{LocationSymbol{Component::A, AxisName::Z}},
                                         MachineError::parse("EAZ"), MachineError::parse("EA0Z")};
  EXPECT_EQ(errors.size(), 2U);
}

TEST(MachineError, NamesStandInTheirOrder) {
  EXPECT_THAT(names_of({MachineError::parse("EC0Y"), MachineError::parse("EXX")}),
              ::testing::ElementsAre("EC0Y", "EXX"));
}

}  // namespace
}  // namespace volcal
