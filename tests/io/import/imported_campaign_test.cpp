/// Every sample is recognised, read, and written as a campaign that is read back.

#include "volcal/identify/io/import/imported_campaign.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/import_files.h"
#include "tests/support/refusal.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign_writer.h"
#include "volcal/identify/text/text_file.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::import_machine;
using testing::refusal;
using testing::sample_imports;
using testing::SampleImport;

class ImportedCampaign : public ::testing::Test {
 protected:
  void spill(const std::string& name, const std::string& bytes) const {
    std::ofstream(scratch_.path() / name, std::ios::binary) << bytes;
  }
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }

  ImportedFile imported(SampleImport sample) const {
    if (!sample.nominal.empty()) sample.answers.nominal = {"nominal.csv", sample.nominal};
    const ImportSource source{path(sample.name), foreign_text(sample.bytes, path(sample.name),
                                                              sample.answers.encoding, "give --encoding ")};
    const ImportFormat& format = import_format_of(source, std::nullopt);
    EXPECT_EQ(format.name(), sample.format) << sample.name;
    ImportedFile file{source.path, sample.name, 0, format.read(source, sample.answers, import_machine(), 0)};
    for (const auto& [key, value] : sample.answers.keys) file.readings.keys[key] = value;
    return file;
  }
  /// With noise by which any instrument is judged.
  ImportedFile with_noise(const SampleImport& sample) const {
    ImportedFile file = imported(sample);
    std::string noise;
    for (const KeySchema& key : file.readings.instrument->noise_keys)
      noise += (noise.empty() ? "" : ", ") + key.key + " = 1.0";
    file.readings.keys["noise"] = "{ " + noise + " }";
    return file;
  }

  testing::ScratchFolder scratch_;
};

TEST_F(ImportedCampaign, EverySampleComesBack) {
  ASSERT_GE(sample_imports().size(), 12U);
  spill("machine.toml", testing::kImportMachine);
  for (const SampleImport& sample : sample_imports()) {
    SCOPED_TRACE(sample.name);
    const ImportedFile file = with_noise(sample);
    EXPECT_EQ(file.readings.source_line.size(), sample.readings);
    const Campaign campaign = imported_campaign({file}, import_machine());
    std::ofstream(scratch_.path() / "campaign.toml")
        << import_comments({file}) + campaign_toml(campaign, "machine.toml");
    spill(readings_file_name(campaign.setups[0]), readings_csv(campaign.setups[0], import_machine()));
    const Campaign read = read_campaign(path("campaign.toml"));
    ASSERT_EQ(read.setups.size(), 1U);
    const Readings& one = campaign.setups[0].readings;
    const Readings& other = read.setups[0].readings;
    EXPECT_EQ(read.setups[0].instrument, file.readings.instrument->name);
    ASSERT_EQ(other.size(), sample.readings);
    EXPECT_EQ(other.direction, one.direction);
    for (std::size_t channel = 0; channel < one.channels(); ++channel) {
      for (std::size_t row = 0; row < one.size(); ++row)
        EXPECT_NEAR(other.value[channel][row], one.value[channel][row], 2e-10);
    }
  }
}

TEST_F(ImportedCampaign, FilesTogetherShareOneMachine) {
  std::vector<ImportedFile> files;
  for (const SampleImport& sample : sample_imports()) files.push_back(with_noise(sample));
  const Campaign campaign = imported_campaign(files, import_machine());
  EXPECT_EQ(campaign.setups.size(), files.size());
  const std::string comments = import_comments(files);
  EXPECT_THAT(comments, HasSubstr("# mark.rtl: imported from mark.rtl\n"));
  EXPECT_THAT(comments, HasSubstr("By: M\u00FCller (line 18)"));
  EXPECT_THAT(comments, HasSubstr("unit of the deviations: um (--unit)"));
}

TEST_F(ImportedCampaign, ReadingsOutsideTheTravelAreRefusedWithTheirLine) {
  SampleImport sample = testing::sample_lasers().front();
  sample.bytes = testing::replaced(sample.bytes, "200.000 ", "900.000 ");
  const ImportedFile file = with_noise(sample);
  EXPECT_THAT(refusal([&] { imported_campaign({file}, import_machine()); }),
              HasSubstr("crlf.rtl:29: x_mm = 900 lies outside the travel of X"));
}

TEST_F(ImportedCampaign, NoiseAndKeysAreAskedFor) {
  ImportedFile file = imported(testing::sample_lasers().front());
  EXPECT_THAT(refusal([&] { imported_campaign({file}, import_machine()); }),
              HasSubstr("--set \"noise = { constant_um = ..."));
  file.readings.keys["noise"] = "{ constant_um = 1.0 }";
  file.readings.keys["colour"] = "\"red\"";
  EXPECT_THAT(refusal([&] { imported_campaign({file}, import_machine()); }), HasSubstr("colour"));
  file.readings.keys.erase("colour");
  EXPECT_NO_THROW(imported_campaign({file}, import_machine()));
}

TEST_F(ImportedCampaign, WhatIsNoFileOfAnInstrumentIsRefusedWithItsLine) {
  for (const char* text :
       {"Dear Sir,\nplease find enclosed the report.\n", "{\"a\": [1, 2, 3]}\n", "1\n2\n3\n"}) {
    const std::string message = refusal([&] { import_format_of({"letter.txt", text}, std::nullopt); });
    EXPECT_THAT(message, HasSubstr("letter.txt:1: the file is not understood")) << text;
    EXPECT_THAT(message, HasSubstr("rtl, tracker, csv"));
  }
  EXPECT_THAT(refusal([&] {
                import_format_of({"letter.txt", "x"}, "rtf");
              }),
              HasSubstr("did you mean \"rtl\"?"));
}

TEST_F(ImportedCampaign, ATableThatCannotBeReadIsRefusedWithItsLine) {
  const auto message = [](const std::string& text) {
    const ImportSource source{"t.csv", text};
    return refusal([&] { import_format_of(source, std::nullopt).read(source, {}, import_machine(), 0); });
  };
  for (const char* cell : {"", "nan", "1.234,5"}) {
    EXPECT_THAT(message("X;Error\n0;1\n" + std::string(cell) + ";2\n200;3\n"),
                HasSubstr("t.csv:3: column \"X\" holds \"" + std::string(cell) + "\", not a number"));
  }
  EXPECT_THAT(message("0;1\n100;2\n"), HasSubstr("t.csv:1: no header above the numbers"));
  EXPECT_THAT(message("X;Error\n0;1\n100\n200;3\n"), HasSubstr("t.csv:3: the row has 1 cells"));
}

TEST_F(ImportedCampaign, ACodePageIsNamedInTheRemedy) {
  const std::string bytes = testing::replaced(testing::rtl_text(), "By: NN", "By: M\xFCller");
  const auto read = [&](std::optional<TextEncoding> encoding) {
    return refusal([&] { foreign_text(bytes, "x.rtl", encoding, "give --encoding "); });
  };
  EXPECT_THAT(read(std::nullopt), HasSubstr("x.rtl:18: the file is not UTF-8 text (give --encoding cp1252"));
  EXPECT_EQ(read(TextEncoding::Cp1252), "");
  EXPECT_THAT(refusal([&] { foreign_text("a\nb\x81\n", "x.rtl", TextEncoding::Cp1252, "give --encoding "); }),
              HasSubstr("x.rtl:2: a byte here is not a character"));
}

}  // namespace
}  // namespace volcal
