/// The certificate of `volcal tables`: of a simulated machine, measured again with the tables active.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using testing::content;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;
using ::testing::StartsWith;

class CertificateOfTables : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    simulated_ = new testing::SimulatedCampaign;
    simulated_->simulate(8,
                         "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [6, 5, 5]\n"
                         "[validation]\npoints = 60\n",
                         3, 6);
    std::ofstream(path("campaign/campaign.toml"), std::ios::app)
        << "\n[record]\nserial_number = \"4711-0815\"\noperator = \"A. Müller\"\nload = \"none, table "
           "empty\"\n"
           "[record.instruments]\nlaser-tracer = \"No. 12, calibrated 2026-03\"\n";
    ASSERT_EQ(simulated_->fit("--noise white").exit_code, 0);
  }
  static void TearDownTestSuite() { delete simulated_; }
  static std::string path(const std::string& name) { return simulated_->path(name); }
  static testing::ProgramRun tables(const std::string& options) {
    return run_program("tables " + path("result") + " " + options);
  }
  static testing::SimulatedCampaign* simulated_;
};
testing::SimulatedCampaign* CertificateOfTables::simulated_ = nullptr;

/// The data of a page, from the document that the HTML holds.
nlohmann::json certificate_in(const std::string& html, const std::string& kind) {
  const std::string begin = "<script type=\"application/json\" id=\"volcal-data\">";
  const std::size_t from = html.find(begin) + begin.size();
  const auto document = nlohmann::json::parse(html.substr(from, html.find("</script>", from) - from));
  for (const auto& page : document.at("pages")) {
    if (page.at("kind") == kind) return page.at("data");
  }
  return {};
}

TEST_F(CertificateOfTables, HasTheRecordAndWhatWasMeasuredBeforeAndAfter) {
  const std::string certificate = " --certificate " + path("campaign/campaign.toml");
  const auto first = tables("--format neutral-csv -o " + path("tables") + certificate);
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_THAT(first.output, HasSubstr("certificate.html"));
  const auto again = run_program("simulate " + path("study.toml") + " --compensation " + path("tables") +
                                 " -o " + path("second"));
  ASSERT_EQ(again.exit_code, 0) << again.errors;  // the certificate is no table

  const auto verified = tables("--format neutral-csv --json -o " + path("tables") + certificate +
                               " --verified " + path("second/campaign.toml"));
  ASSERT_EQ(verified.exit_code, 0) << verified.errors;
  EXPECT_EQ(nlohmann::json::parse(verified.output).at("certificate"), "certificate.html");
  const std::string html = content(path("tables/certificate.html"));
  EXPECT_THAT(html,
              AllOf(HasSubstr("4711-0815"), HasSubstr("A. Müller"), HasSubstr("No. 12, calibrated 2026-03")));
  const auto measured = certificate_in(html, "certificate_figures").at("measured");
  ASSERT_EQ(measured.size(), 2U);
  EXPECT_LT(measured.at(1).at("lengths").at("rms").get<double>(),
            0.2 * measured.at(0).at("lengths").at("rms").get<double>());
  EXPECT_THAT(measured.at(1).at("active").get<std::string>(), HasSubstr("neutral-csv tables of"));
}

/// As POSIX cksum prints them: an independent program says the same.
TEST_F(CertificateOfTables, ItsChecksumsAreThoseOfCksum) {
  ASSERT_EQ(
      tables("--format linuxcnc -o " + path("comp") + " --certificate " + path("campaign/campaign.toml"))
          .exit_code,
      0);
  const auto files = certificate_in(content(path("comp/certificate.html")), "certificate_files").at("files");
  ASSERT_EQ(files.size(), 4U);  // x, y, z and the lines for the INI file
  for (const auto& file : files) {
    const std::string name = file.at("name");
    const std::string said = path("cksum");
    ASSERT_EQ(std::system(("cksum <" + path("comp/" + name) + " >" + said).c_str()), 0);
    EXPECT_THAT(content(said), StartsWith(std::to_string(file.at("checksum").get<std::uint32_t>()) + " " +
                                          std::to_string(file.at("bytes").get<std::size_t>())));
  }
}

/// What --record says stands before the campaign's; both are in the metadata of csv.
TEST_F(CertificateOfTables, OptionsStandBeforeTheCampaign) {
  ASSERT_EQ(tables("--record load='50 kg' --record feed=1000 -o " + path("native") + " --certificate " +
                   path("campaign/campaign.toml"))
                .exit_code,
            0);
  EXPECT_THAT(content(path("native/metadata.csv")),
              AllOf(HasSubstr("load,50 kg\n"), HasSubstr("feed,1000\n")));
  const std::string record =
      certificate_in(content(path("native/certificate.html")), "certificate_record").dump();
  EXPECT_THAT(record, AllOf(HasSubstr("50 kg"), Not(HasSubstr("table empty"))));
  ASSERT_EQ(tables("-o " + path("native")).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("native/certificate.html")));  // of other tables
}

TEST_F(CertificateOfTables, IsRefusedWithARemedy) {
  const std::string own = " --certificate " + path("campaign/campaign.toml");
  const std::string other = " --certificate " VOLCAL_SOURCE_DIR "/datasets/demo/campaign/campaign.toml";
  const std::pair<std::string, std::string> refusals[] = {
      {"--dry-run" + own, "give -o FOLDER"},
      {"-o " + path("none") + other, "not identified from the readings of this campaign"},
      {"-o " + path("none") + own + " --verified " + path("campaign/campaign.toml"),
       "measured with the tables active"},
      {"-o " + path("none") + " --pdf", "--certificate"},
  };
  for (const auto& [options, words] : refusals) {
    const auto run = tables(options);
    EXPECT_NE(run.exit_code, 0) << options;
    EXPECT_THAT(run.errors, HasSubstr(words)) << options;
    EXPECT_FALSE(std::filesystem::exists(path("none"))) << options;
  }
}

TEST_F(CertificateOfTables, WithoutChromiumSaysWhatToDo) {
  const testing::ScratchFolder empty;
  const std::string command = "PATH=" + empty.path().string() + " " VOLCAL_PROGRAM " tables " +
                              path("result") + " -o " + path("none") + " --pdf --certificate " +
                              path("campaign/campaign.toml") + " 2>" + path("errors") + " >/dev/null";
  EXPECT_NE(std::system(command.c_str()), 0);
  EXPECT_THAT(content(path("errors")), AllOf(HasSubstr("Chromium, which is not installed"),
                                             HasSubstr("print certificate.html from a browser")));
  EXPECT_FALSE(std::filesystem::exists(path("none")));
}

TEST_F(CertificateOfTables, IsPrintedByChromium) {
  if (std::system("command -v chromium chromium-browser google-chrome >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "Chromium is not installed";
  const auto run = tables("--format linuxcnc --pdf -o " + path("printed") + " --certificate " +
                          path("campaign/campaign.toml"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(content(path("printed/certificate.pdf")), StartsWith("%PDF-"));
}

}  // namespace
}  // namespace volcal
