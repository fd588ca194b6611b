// What every registered table format must keep.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <regex>
#include <set>
#include <stdexcept>

#include "tests/support/identified_machines.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/reference_machines.h"
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
  static TableFormatOptions options() {
    TableFormatOptions options;
    options.grid_per_axis = 2;
    options.type = GetParam()->supported;
    options.step = 50e-3;
    options.settings = testing::example_settings(*GetParam());
    return options;
  }
  static std::vector<TableFile> write(const FitResult& result) {
    return write_tables(*GetParam(), result, options());
  }
};

TEST_P(TableFormatContract, SaysWhatItIsAndIsFoundByItsName) {
  EXPECT_FALSE(GetParam()->summary.empty());
  EXPECT_FALSE(GetParam()->source.empty());
  EXPECT_FALSE(GetParam()->verified.empty());
  EXPECT_FALSE(GetParam()->refusal.empty());
  EXPECT_FALSE(GetParam()->supported.empty());
  for (const TableSetting& setting : GetParam()->settings) {
    EXPECT_FALSE(setting.help.empty()) << setting.name;
    EXPECT_FALSE(setting.example.empty()) << setting.name;
  }
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
      const std::regex whole_word(std::string("\\b-?") + word + "\\b");
      EXPECT_FALSE(std::regex_search(file.content, whole_word)) << file.name << " holds " << word;
    }
  }
}

/// Between its positions a table is off by less than a tenth of the error, at them by its resolution.
TEST_P(TableFormatContract, ReadBackItIsTheIdealCompensation) {
  const FitResult& result = identified_machine();
  const CompensationTables tables = GetParam()->read(write(result));
  const VolumeCheck check = check_in_volume(result, options(), tables);
  EXPECT_GT(check.before.rms, 10e-6);
  EXPECT_LT(check.ideal.rms, check.before.rms);
  EXPECT_NEAR(check.exported.rms, check.ideal.rms, 0.3e-6);
  EXPECT_LE(check.exported.rms, check.exported.max);
  ASSERT_EQ(check.parts.size(), kLinearCompensationParts.size());
  for (const PartLeft& left : check.parts) {
    EXPECT_GT(left.before.rms, 0.1e-6);
    if (GetParam()->supported.has(left.part)) {
      EXPECT_LT(left.exported.rms, 0.1 * left.before.rms) << CompensationType(left.part).name();
    } else {
      EXPECT_NEAR(left.exported.rms, left.before.rms, 0.2e-6) << CompensationType(left.part).name();
    }
  }
}

/// With a reversal tables of both directions are zero where home is approached towards +, others are anyway.
TEST_P(TableFormatContract, IsZeroAtHomeApproachedTowardsPlus) {
  const FitResult result = testing::result_with(sim::reference_machines()[0],
                                                {.functions = {{"EXX", [](double q) { return 20e-6 * q; }}},
                                                 .reversals = {{"EXX", 6e-6}, {"EYX", 4e-6}}},
                                                10);
  const CompensationTables tables = GetParam()->read(write(result));
  const Eigen::Vector3d at_home = tables.correction(home_of(result.machine), {1, 1, 1, 1, 1, 1}).linear;
  EXPECT_LT(at_home.norm(), 1e-9 + GetParam()->limits.resolution);
}

TEST_P(TableFormatContract, RefusesOtherTypesSettingsAndToolsWithAReason) {
  const auto refusal = [&](const TableFormatOptions& wrong) {
    try {
      write_tables(*GetParam(), identified_machine(), wrong);
    } catch (const InputError& error) {
      EXPECT_FALSE(error.remedy().empty());
      return std::string(error.what());
    }
    return std::string();
  };
  for (const CompensationTypeInfo& info : compensation_types()) {
    TableFormatOptions wrong = options();
    wrong.type = info.type;
    if (testing::holds(*GetParam(), info.type)) continue;
    EXPECT_NE(refusal(wrong).find(GetParam()->refusal), std::string::npos) << info.name;
  }
  TableFormatOptions wrong = options();
  wrong.settings["no_such"] = "1";
  EXPECT_NE(refusal(wrong).find("no_such"), std::string::npos);
  wrong = options();
  wrong.tool = "no such tool";
  EXPECT_NE(refusal(wrong).find("no such tool"), std::string::npos);
}

/// Cut anywhere, or with one line damaged, a file is read or refused with a file and a remedy, nothing else.
TEST_P(TableFormatContract, DamagedFilesAreRefusedWithFileAndRemedy) {
  const std::vector<TableFile> whole = write(identified_machine());
  int refused = 0;
  const auto try_reading = [&](const std::vector<TableFile>& files) {
    try {
      GetParam()->read(files);
    } catch (const InputError& error) {
      ++refused;
      EXPECT_FALSE(error.place().file.empty()) << error.what();
      EXPECT_FALSE(error.remedy().empty()) << error.what();
    }
  };
  for (std::size_t which = 0; which < whole.size(); ++which) {
    std::vector<TableFile> files = whole;
    std::string& content = files[which].content;
    const std::string original = content;
    for (std::size_t cut = 0; cut < std::min<std::size_t>(original.size(), 400); cut += 7) {
      content = original.substr(0, cut);
      try_reading(files);
      content = original;
      content[cut] = 'x';
      try_reading(files);
    }
    files.erase(files.begin() + static_cast<std::ptrdiff_t>(which));
    try_reading(files);
  }
  EXPECT_GT(refused, 10);
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

TEST(TableFormats, OfAProgramNeedANameOfTheirOwnAWriterAndAReader) {
  EXPECT_THROW(register_table_format(nullptr), std::invalid_argument);
  EXPECT_THROW(register_table_format(std::make_unique<TableFormat>(*find_table_format("csv"))),
               std::invalid_argument);
  TableFormat half = *find_table_format("csv");
  half.name = "half";
  half.read = nullptr;
  EXPECT_THROW(register_table_format(std::make_unique<TableFormat>(half)), std::invalid_argument);
  EXPECT_EQ(find_table_format("half"), nullptr);
}

}  // namespace
}  // namespace volcal
