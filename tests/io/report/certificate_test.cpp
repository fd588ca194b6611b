/// The certificate of a compensation, of tables and figures made by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/io/report/drawing.h"
#include "tests/io/report/synthetic_fit.h"
#include "tests/support/refusal.h"
#include "volcal/identify/report/report.h"
#include "volcal/identify/report/values/posix_checksum.h"
#include "volcal/identify/result/fitted_readings.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using CertificateJson = nlohmann::json;

MadeTables hand_made_tables(const FitResult& result) {
  MadeTables tables;
  tables.format = find_table_format("linuxcnc");
  tables.options.type = CompensationType::parse("L-POS");
  tables.options.tool = result.machine.tools.front().name;
  tables.options.step = 0.02;
  tables.files = {{"x.comp", "0 0 0\n"}, {"y.comp", "123456789"}};
  tables.check.before = {20.7e-6, 41.17e-6};
  tables.check.ideal = {7.5e-6, 19.71e-6};
  tables.check.exported = {7.5e-6, 19.72e-6};
  tables.check.identification_u = 4.0e-6;
  tables.check.parts = {{CompensationPart::Positioning, {12e-6, 20e-6}, {0.1e-6, 0.2e-6}}};
  return tables;
}

class Certificate : public ::testing::Test {
 protected:
  Certificate() : fit_(test::synthetic_fit()), tables_(hand_made_tables(fit_.result)) {
    record_.entries = {{"serial_number", "4711 <b>"}, {"operator", "A. Müller"}, {"load", "none"}};
    record_.instruments = {{"laser-tracer", "No. 12"}};
    before_.campaign = "before/campaign.toml";
    before_.setups = 3;
    before_.sizes.lengths = {1000, 11.2e-6, 35e-6};
    before_.sizes.angles = {42, 3.4e-6, 9e-6};
  }
  CertificateView view() const { return {fit_.result, tables_, record_, before_, after_}; }
  CertificateJson page(const std::string& kind) const {
    const auto document = CertificateJson::parse(report_json(view(), {.date = "2026-11-26"}));
    for (const auto& each : document.at("pages")) {
      if (each.at("kind") == kind) return each.at("data");
    }
    ADD_FAILURE() << "no page " << kind;
    return {};
  }
  /// The value of a fact by its name.
  static std::string fact(const CertificateJson& facts, const std::string& name) {
    for (const auto& each : facts) {
      if (each.at(0) == name) return each.at(1);
    }
    return "no such fact";
  }

  test::SyntheticFit fit_;
  MadeTables tables_;
  MeasurementRecord record_;
  MeasuredError before_;
  std::optional<MeasuredError> after_;
};

TEST_F(Certificate, SaysWhatWasRecordedAndWhatWasNot) {
  const auto certified = page("certified");
  EXPECT_EQ(fact(certified.at("machine"), "Serial number"), "4711 <b>");
  EXPECT_EQ(fact(certified.at("machine"), "Owner"), "");
  EXPECT_EQ(fact(certified.at("measurement"), "Operator"), "A. Müller");
  EXPECT_EQ(fact(certified.at("measurement"), "Campaign"), "before/campaign.toml");
  EXPECT_EQ(fact(certified.at("compensation"), "Type (ISO/TR 16907, 8.2)"), "L-POS");
  for (const auto& row : certified.at("instruments"))
    EXPECT_EQ(row.at("recorded"), row.at("instrument") == "laser-tracer" ? "No. 12" : "");
  const auto rows = page("certificate_record").at("rows");
  const auto load = std::ranges::find_if(rows, [](const auto& row) { return row.at("item") == "Load"; });
  ASSERT_NE(load, rows.end());
  EXPECT_EQ(load->at("recorded"), "none");
  const auto state = std::ranges::find_if(
      rows, [](const auto& row) { return row.at("item") == "Machine before the measurement, warm-up"; });
  ASSERT_NE(state, rows.end());
  EXPECT_EQ(state->at("recorded"), "");
}

/// hypot(7.5, 4) um is expected where 7.5 um are left and what was identified is uncertain by 4 um.
TEST_F(Certificate, HasTheFiguresBeforeAndAfter) {
  const auto figures = page("certificate_figures");
  EXPECT_DOUBLE_EQ(figures.at("volume").at(0).at("rms"), 20.7);
  EXPECT_DOUBLE_EQ(figures.at("volume").at(2).at("max"), 19.72);
  EXPECT_DOUBLE_EQ(figures.at("volume").at(3).at("rms"), 8.5);
  EXPECT_DOUBLE_EQ(figures.at("parts").at(0).at("after"), 0.1);
  ASSERT_EQ(figures.at("measured").size(), 1U);
  EXPECT_DOUBLE_EQ(figures.at("measured").at(0).at("lengths").at("rms"), 11.2);
  EXPECT_DOUBLE_EQ(figures.at("measured").at(0).at("angles").at("max"), 9.0);
  EXPECT_FALSE(page("signature").at("measured_after").get<bool>());
  after_ = before_;
  after_->sizes.lengths.rms = 1.5e-6;
  EXPECT_DOUBLE_EQ(page("certificate_figures").at("measured").at(1).at("lengths").at("rms"), 1.5);
  EXPECT_TRUE(page("signature").at("measured_after").get<bool>());
}

TEST_F(Certificate, NamesItsReservations) {
  const std::string reservations = page("certified").at("reservations").dump();
  EXPECT_THAT(reservations, HasSubstr("status rank_deficient"));
  EXPECT_THAT(reservations, HasSubstr("ECZ: not visible"));
}

TEST_F(Certificate, HasAReservationWhereTheCampaignAfterStatesNoCompensations) {
  after_ = before_;
  for (const char* active : {"", "none", "L-POS"}) {
    after_->active_compensations = active;
    const std::string reservations = page("certified").at("reservations").dump();
    EXPECT_EQ(reservations.find("does not state that compensations were active") == std::string::npos,
              after_->active_compensations == "L-POS")
        << active;
  }
}

/// `printf 123456789 | cksum` prints 930766865 9.
TEST_F(Certificate, ListsFilesWithTheChecksumsOfCksum) {
  const auto files = page("certificate_files").at("files");
  EXPECT_EQ(files.at(1).at("name"), "y.comp");
  EXPECT_EQ(files.at(1).at("bytes"), 9);
  EXPECT_EQ(files.at(1).at("checksum"), 930766865U);
  EXPECT_EQ(report::posix_checksum(""), 4294967295U);
}

TEST_F(Certificate, DrawsItself) {
  const auto drawing = test::draw_report(report_json(view()));
  if (!drawing.possible) GTEST_SKIP() << "Node.js is not installed";
  EXPECT_EQ(drawing.exit_code, 0) << drawing.output;
  EXPECT_THAT(drawing.output, HasSubstr("5 sections, 0 plots"));
}

TEST_F(Certificate, IsOfTheCampaignThatWasIdentified) {
  FitResult result = fit_.result;
  EXPECT_THAT(testing::refusal([&] { require_campaign_of(result, fit_.campaign); }),
              HasSubstr("was not identified from the readings of this campaign"));
  result.setups.front().fingerprint = readings_fingerprint(fit_.campaign.setups.front());
  EXPECT_EQ(testing::refusal([&] { require_campaign_of(result, fit_.campaign); }), "");
  result.setups.clear();
  EXPECT_THAT(testing::refusal([&] { require_campaign_of(result, fit_.campaign); }),
              HasSubstr("were stated"));
}

}  // namespace
}  // namespace volcal
