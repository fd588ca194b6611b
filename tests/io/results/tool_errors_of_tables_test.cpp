/// The identified error of a tool's offset goes into a folder of csv tables and comes back.

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/support/random_results.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/io/results/known_errors.h"
#include "volcal/identify/text/atomic_folder.h"

namespace volcal {
namespace {

constexpr double kBetweenRows = 0.2e-6;  // m

class ToolErrorsOfTables : public ::testing::Test {
 protected:
  ToolErrorsOfTables()
      : result_(testing_support::random_result(testing_support::machine_of("w X' b Z Y t"), random_)) {}

  std::string written(const FitResult& result, bool older = false) const {
    const std::string path = (folder_.path() / (older ? "older" : "tables")).string();
    AtomicFolder folder(path);
    for (TableFile file : write_tables(*find_table_format("csv"), result, options())) {
      if (older && file.name == "metadata.csv") file.content = without_tool_errors(file.content);
      folder.write(file);
    }
    folder.commit();
    return path;
  }

  static TableFormatOptions options() {
    TableFormatOptions options;
    options.type = CompensationType::volumetric();
    options.functions.positions = 201;
    options.grid_per_axis = 2;
    return options;
  }

  static std::string without_tool_errors(const std::string& metadata) {
    std::string kept;
    std::size_t begin = 0;
    while (begin < metadata.size()) {
      const std::size_t end = metadata.find('\n', begin) + 1;
      const std::string line = metadata.substr(begin, end - begin);
      if (line.find(".offset_error.") == std::string::npos) kept += line;
      begin = end;
    }
    return kept;
  }

  Eigen::Vector3d error_at(const FitResult& result, const std::string& tool) const {
    const Machine& machine = result.machine;
    return ErrorField(result, machine.tools[*machine.tool_index(tool)])
        .at(middle_of_travel(machine))
        .head<3>();
  }

  std::mt19937_64 random_{17};
  FitResult result_;

 private:
  testing::ScratchFolder folder_;
};

TEST_F(ToolErrorsOfTables, ComeBackForTheToolThatHasThem) {
  const FitResult read = read_known_errors(written(result_));
  for (const std::string tool : {"stated", "estimated"})
    EXPECT_LT((error_at(read, tool) - error_at(result_, tool)).norm(), kBetweenRows) << tool;
}

TEST_F(ToolErrorsOfTables, AreWrittenAgain) {
  const FitResult read = read_known_errors(written(read_known_errors(written(result_))));
  EXPECT_LT((error_at(read, "estimated") - error_at(result_, "estimated")).norm(), 2.0 * kBetweenRows);
}

TEST_F(ToolErrorsOfTables, OfOlderFoldersAreNone) {
  const FitResult read = read_known_errors(written(result_, true));
  const Eigen::Vector3d lost = result_.parameters.tail<3>();
  ASSERT_GT(lost.norm(), 10.0 * kBetweenRows);
  EXPECT_NEAR((error_at(read, "estimated") - error_at(result_, "estimated")).norm(), lost.norm(),
              kBetweenRows);
}

}  // namespace
}  // namespace volcal
