// What every registered table format must keep.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "volcal/identify/solve/fit.h"
#include "volcal/identify/tables/table_format.h"
#include "volcal/sim/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

const FitResult& identified_machine() {
  static const FitResult result = [] {
    sim::Study study;
    study.machine = sim::reference_machines()[0];
    sim::Tracking tracking;
    tracking.grid = {4, 4, 4};
    study.measurements.emplace_back().settings = tracking;
    ModelSpec model;
    model.default_function.knots = KnotChoice::IntervalCount;
    model.default_function.intervals = 2;
    return fit(sim::simulate(study).campaign, model);
  }();
  return result;
}

class TableFormatContract : public ::testing::TestWithParam<const TableFormat*> {
 protected:
  static std::vector<TableFile> write(const FitResult& result) {
    return GetParam()->write(result, {.functions = {.positions = 11}, .grid_per_axis = 2});
  }
};

TEST_P(TableFormatContract, SaysWhatItIsAndIsFoundByItsName) {
  EXPECT_FALSE(GetParam()->summary.empty());
  EXPECT_FALSE(GetParam()->source.empty());
  EXPECT_EQ(find_table_format(GetParam()->name), GetParam());
  EXPECT_TRUE(std::ranges::all_of(GetParam()->name,
                                  [](char c) { return std::islower(c) || std::isdigit(c) || c == '-'; }));
}

TEST_P(TableFormatContract, FilesHavePlainNamesAndContent) {
  std::set<std::string> names;
  for (const TableFile& file : write(identified_machine())) {
    EXPECT_TRUE(names.insert(file.name).second) << file.name << " twice";
    EXPECT_EQ(file.name.find_first_of("/\\ "), std::string::npos) << file.name;
    EXPECT_FALSE(file.content.empty()) << file.name;
  }
  EXPECT_FALSE(names.empty());
}

TEST_P(TableFormatContract, SameResultSameBytesOtherResultOtherBytes) {
  const auto text = [](const FitResult& result) {
    std::string all;
    for (const TableFile& file : write(result)) all += file.content;
    return all;
  };
  EXPECT_EQ(text(identified_machine()), text(identified_machine()));
  FitResult other = identified_machine();
  other.parameters *= 2.0;
  EXPECT_NE(text(identified_machine()), text(other));
}

TEST_P(TableFormatContract, HoldsNumbersOnly) {
  for (const TableFile& file : write(identified_machine())) {
    for (const char* word : {"nan", "inf"}) {
      EXPECT_EQ(file.content.find(word), std::string::npos) << file.name << " holds " << word;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, TableFormatContract, ::testing::ValuesIn(table_formats()),
                         [](const auto& tested) {
                           std::string name(tested.param->name);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(TableFormats, UnknownNameIsNotFound) {
  EXPECT_EQ(find_table_format("?"), nullptr);
  const auto names = table_format_names();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), table_formats().size());
}

}  // namespace
}  // namespace volcal
