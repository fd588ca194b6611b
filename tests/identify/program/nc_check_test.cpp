// The check of rewritten programs on texts that were damaged by hand.

#include "volcal/identify/program/nc_check.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/nc_programs.h"

namespace volcal {
namespace {

/// Figures of the rewriting with `from` replaced in its line `number`, counted from 0.
PathErrors checked_without(const std::string& program, const ProgramErrors& errors, std::size_t number,
                           const std::string& from, const std::string& to) {
  const testing::Rewritten done = testing::rewritten(program, errors);
  const std::vector<std::string> lines = testing::program_lines(program);
  NcCheck check(errors, testing::simple_setup(), {});
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::vector<NcWrittenLine> written = done.groups.at(i);
    if (i == number) {
      std::string& text = written.front().text;
      const std::size_t at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from << " in " << text;
      if (at != std::string::npos) text.replace(at, from.size(), to);
    }
    check.add(lines[i], written);
  }
  return check.after();
}

/// 8 um along X throughout. The last motion leaves no other behind it that would begin at a wrong place.
TEST(NcCheck, SeesLinesThatAreLost) {
  const ProgramErrors errors = testing::errors_with(
      [](const AxisPosition&, const ApproachDirection&) { return Eigen::Vector3d(8e-6, 0.0, 0.0); });
  const std::string program = "G21 G90 G54\nG0 X0 Y0 Z0\nG1 X10 F500\nY30\n";
  EXPECT_LT(checked_without(program, errors, 3, "Y30", "Y30").max, 0.1e-6);
  EXPECT_NEAR(checked_without(program, errors, 3, "Y30", "").max, 30e-3, 1e-6) << "the last line";
  EXPECT_NEAR(checked_without(program, errors, 2, "X9.9920", "").max, 10e-3, 1e-6);
  EXPECT_NEAR(checked_without(program, errors, 2, "X9.9920", "X9.9930").max, 1e-6, 0.1e-6);
}

}  // namespace
}  // namespace volcal
