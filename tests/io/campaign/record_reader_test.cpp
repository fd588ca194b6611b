#include "volcal/identify/io/campaign/record_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/refusal.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/io/campaign/campaign_reader.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kRecordedCampaign = VOLCAL_SOURCE_DIR "/datasets/hidden/21/campaign.toml";

TEST(RecordOfACampaign, IsItsTexts) {
  const MeasurementRecord record = parse_record(
      "active_compensations = \"L-POS of the control\"\n[record]\nserial_number = \"4711\"\noperator = \"A. "
      "Müller\"\n"
      "load = \"none\"\n[record.instruments]\nlaser-tracer = \"No. 12, calibrated 2026-03\"\n",
      "record");
  EXPECT_EQ(record.entry("serial_number"), "4711");
  EXPECT_EQ(record.entry("operator"), "A. Müller");
  EXPECT_EQ(record.entry("load"), "none");
  EXPECT_EQ(record.entry("active_compensations"), "L-POS of the control");
  EXPECT_EQ(record.instruments.at("laser-tracer"), "No. 12, calibrated 2026-03");
  EXPECT_THAT(record.entry("feed"), IsEmpty());
  EXPECT_TRUE(parse_record("", "record").entries.empty());
  const MeasurementRecord again = parse_record(record_toml(record), "record");
  EXPECT_EQ(again.instruments, record.instruments);
  EXPECT_EQ(again.entry("operator"), record.entry("operator"));
  EXPECT_EQ(record_toml({}), "");
}

TEST(RecordOfACampaign, IsRefusedWithItsLine) {
  const auto why = [](const std::string& text) {
    return testing::refusal([&] { parse_record(text, "campaign.toml"); });
  };
  EXPECT_THAT(why("[record]\nserial_no = \"4711\"\n"),
              AllOf(HasSubstr("campaign.toml:2"), HasSubstr("serial_number")));
  EXPECT_THAT(why("[record]\noperator = \"  \"\n"),
              AllOf(HasSubstr("campaign.toml:2"), HasSubstr("leave the key out")));
  EXPECT_THAT(why("[record]\nload = 12\n"), HasSubstr("campaign.toml:2"));
  EXPECT_THAT(why("[record]\n[record.instruments]\nlaser-trace = \"x\"\n"),
              AllOf(HasSubstr("campaign.toml:3"), HasSubstr("laser-tracer")));
  EXPECT_THAT(why("[record]\nactive_compensations = \"none\"\n"),
              AllOf(HasSubstr("campaign.toml:2"), HasSubstr("top of campaign.toml")));
}

/// A campaign with a record is read as without; what is wrong in it is said when the campaign is read.
TEST(RecordOfACampaign, StandsInTheFileOfTheCampaign) {
  const testing::ScratchFolder folder;
  const std::filesystem::path from = std::filesystem::path(kRecordedCampaign).parent_path();
  for (const auto& entry : std::filesystem::directory_iterator(from)) {
    if (entry.is_regular_file()) std::filesystem::copy(entry.path(), folder.path() / entry.path().filename());
  }
  const std::string file = (folder.path() / "campaign.toml").string();
  std::ofstream(file, std::ios::app) << "\n[record]\nserial_number = \"4711\"\n";
  EXPECT_EQ(read_campaign(file).reading_count(), read_campaign(kRecordedCampaign).reading_count());
  EXPECT_EQ(read_campaign_record(file).entry("serial_number"), "4711");
  EXPECT_TRUE(read_campaign_record(kRecordedCampaign).entries.empty());
  std::ofstream(file, std::ios::app) << "operater = \"x\"\n";
  EXPECT_THAT(testing::refusal([&] { read_campaign(file); }), HasSubstr("operator"));
}

/// What clause 9.1 asks for stands in metadata.csv and on the certificate by the same keys.
TEST(RecordOfACampaign, HasTheConditionsOfTheTables) {
  for (const std::string_view key : recordable_conditions())
    EXPECT_EQ(std::ranges::count(record_items(), key, &RecordItem::key), 1) << key;
}

}  // namespace
}  // namespace volcal
