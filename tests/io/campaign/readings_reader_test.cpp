#include "volcal/identify/io/campaign/readings_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/reader_harness.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Readings read_vectors(const std::string& components, const std::string& values) {
  const std::string text =
      "x_mm,y_mm,z_mm,a_deg,c_deg," + components + "\n0,0,0,0,0," + values + "\n9,0,0,0,0," + values + "\n";
  return read_readings(CsvTable::parse(text, "plate.csv", {}), {}, testing::harness_machine(),
                       find_instrument("volumetric-points")->schema());
}

std::vector<std::string> columns_of(const Readings& readings) {
  std::vector<std::string> names;
  for (const ColumnSchema& column :
       find_instrument("volumetric-points")->schema().column_sets.at(readings.column_set)) {
    names.push_back(column.column);
  }
  return names;
}

TEST(ReadingsReader, TakesAllComponentsThatTheFileHas) {
  EXPECT_THAT(columns_of(read_vectors("ex_um,ey_um,ez_um", "1,2,3")), ElementsAre("ex_um", "ey_um", "ez_um"));
  EXPECT_THAT(columns_of(read_vectors("ex_um,ey_um", "1,2")), ElementsAre("ex_um", "ey_um"));
  EXPECT_THAT(columns_of(read_vectors("ez_um,ey_um", "3,2")), ElementsAre("ey_um", "ez_um"));
  const Readings plate = read_vectors("ez_um,remark,ex_um", "3,7,1");
  EXPECT_THAT(columns_of(plate), ElementsAre("ex_um", "ez_um"));
  EXPECT_THAT(plate.value, ElementsAre(ElementsAre(1e-6, 1e-6), ElementsAre(3e-6, 3e-6)));
}

TEST(ReadingsReader, DoesNotTakeAMisspeltComponentForAPlateInTwoDirections) {
  try {
    read_vectors("ex_um,ey_um,EZ_um", "1,2,3");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.problem(), HasSubstr("column EZ_um is not ez_um"));
    EXPECT_EQ(error.place().line, 1);
  }
}

}  // namespace
}  // namespace volcal
