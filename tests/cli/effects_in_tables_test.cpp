/// What was found reaches every output: a machine with an effect that the rigid body has not is measured,
/// identified with and without it, compensated by tables, and measured again.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using testing::run_program;

/// A study of tests/data, simulated and fitted once with the rigid model ("rigid") and once with an effect
/// ("effect").
class EffectsInTables : public ::testing::Test {
 protected:
  void make(const std::string& study, const std::string& effect) {
    study_ = std::string(VOLCAL_SOURCE_DIR) + "/tests/data/" + study + "/study.toml";
    done("simulate " + study_ + " -o " + path("campaign"));
    const std::string model = path("campaign/with-effect.toml");
    std::ofstream(model) << "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[[effects]]\n"
                         << effect;
    done("fit " + path("campaign/campaign.toml") + " -o " + path("rigid"));
    done("fit " + path("campaign/campaign.toml") + " --model " + model + " -o " + path("effect"));
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  std::string done(const std::string& arguments) const {
    const auto run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 0) << arguments << "\n" << run.errors;
    return run.output;
  }

  Json error_at(const std::string& result, const std::string& options) const {
    return Json::parse(done("tables " + path(result) + " --tool short --json " + options))
        .at("volumetric_errors")
        .at(0);
  }

  /// What the tables print that they leave, and what the simulated machine then has; RMS of the vector, um.
  struct Left {
    double printed, measured;
  };
  Left left_by(const std::string& result, const std::string& options) const {
    const std::string tables = path("tables"), again = path("again");
    std::filesystem::remove_all(tables);
    std::filesystem::remove_all(again);
    const Json made =
        Json::parse(done("tables " + path(result) + " --tool short --json " + options + " -o " + tables));
    done("simulate " + study_ + " --compensation " + tables + " -o " + again);
    const Json compared = Json::parse(done("compare " + again + "/truth/campaign.toml nominal --json"));
    const double rms = compared.at("models").at(0).at("total").at("lengths_um").at("rms").get<double>();
    return {made.at("error_left").at("expected_rms_um").get<double>(), std::sqrt(3.0) * rms};
  }

  std::string study_;

 private:
  testing::ScratchFolder folder_;
};

// EAY by y z, 178 urad/m^2 at the poles of Y and Z: by hand ey = -1.07 um and ea = -20.7 urad at this pose,
// where the rigid model says 0.6 um.
TEST_F(EffectsInTables, ProductOfAxes) {
  make("effects-in-tables",
       "kind = \"product-coupling\"\nsymbol = \"EAY\"\naxis = \"Y\"\nsecond_axis = \"Z\"\n");
  const Json error = error_at("effect", "--at X=100,Y=200,Z=-400");
  EXPECT_NEAR(error.at("error_um").at(1).get<double>(), -1.07, 0.05);
  EXPECT_NEAR(error.at("rotation_urad").at(0).get<double>(), -20.7, 0.3);

  Left csv{};
  using Formats = std::vector<const char*>;
  const Formats formats =
      testing::short_or_long(Formats{"--format neutral-csv", "--format csv"},
                             Formats{"--format neutral-csv", "--format isg-csv", "--format csv"});
  for (const char* format : formats) {
    const Left rigid = left_by("rigid", format), with_effect = left_by("effect", format);
    EXPECT_LT(with_effect.measured, 0.8 * rigid.measured) << format;
    csv = with_effect;
  }
  // A table of one axis holds the share of a rigid body alone, and the command says what that leaves.
  EXPECT_GT(csv.printed, 0.3);
  EXPECT_LT(std::abs(csv.printed - csv.measured), 0.15);
}

// Expansion of X by 10 um/m/K about 20 degC: values and header are of one temperature, which can be asked
// for.
TEST_F(EffectsInTables, ExpansionAtStatedTemperature) {
  make("expansion-in-tables", "kind = \"scale-expansion\"\naxis = \"X\"\ntemperature = \"column\"\n");
  const auto exx_at = [&](const std::string& options) {
    return error_at("effect", "--at X=400,Y=-250,Z=0 " + options).at("error_um").at(0).get<double>();
  };
  // From the home of X at -400 mm, 800 mm expand; the coefficient is found to some 5 %.
  EXPECT_NEAR(exx_at("--conditions T_column=23.34") - exx_at(""), 3.34 * 10.0 * 0.8, 1.4);
  EXPECT_EQ(exx_at("--conditions T_column=20"), exx_at(""));
  const Json made = Json::parse(
      done("tables " + path("effect") + " --conditions T_column=23.34 --json -o " + path("warm")));
  EXPECT_EQ(made.at("conditions").at("T_column_degC").at("value"), 23.34);
  const std::string metadata = testing::content(path("warm/metadata.csv"));
  EXPECT_THAT(metadata, ::testing::HasSubstr("reference_temperature_degC,23.34\n"));
  const std::string table = testing::content(path("warm/error_tables.csv"));
  const auto row = table.find("EXX,X,400,mm,0,");
  ASSERT_NE(row, std::string::npos);
  EXPECT_NEAR(std::stod(table.substr(row + 15)), 68.5, 0.6);
  // Time cannot be held by a table: what the campaign's temperatures leave is printed.
  EXPECT_GT(made.at("error_left").at("tables_over_conditions").at("rms_um").get<double>(),
            made.at("error_left").at("tables").at("rms_um").get<double>());
  const auto refused = run_program("tables " + path("effect") + " --at X=0 --conditions T_row=20");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, ::testing::HasSubstr("T_column"));
}

TEST_F(EffectsInTables, KnownErrorsGoInAndTablesComeBack) {
  make("expansion-in-tables", "kind = \"reversal\"\nsymbol = \"EXX\"\n");
  done("tables " + path("effect") + " -o " + path("tables"));
  const auto at = [&](const std::string& errors, const std::string& options) {
    return Json::parse(
               done("tables " + path(errors) + " --tool side_x --json --at X=120,Y=40,Z=-110 " + options))
        .at("volumetric_errors")
        .at(0)
        .at("error_um");
  };
  for (const char* approach : {"", "--approach X+", "--approach X-"}) {
    const Json identified = at("effect", approach), model = at("effect/identified.toml", approach),
               tables = at("tables", approach);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(model.at(k).get<double>(), identified.at(k).get<double>(), 1e-6) << approach;
      EXPECT_NEAR(tables.at(k).get<double>(), identified.at(k).get<double>(), 0.2) << approach;
    }
  }
  EXPECT_NE(at("effect", "--approach X+").at(0), at("effect", "--approach X-").at(0));
  EXPECT_THAT(done("tables " + path("effect") + " --conditions T_column=23 --at X=0"),
              ::testing::HasSubstr("no identified error depends on T_column: it changes nothing"));
  const Json budget = Json::parse(done("budget " + path("effect") + " --json"));
  double share = 0.0;
  for (const Json& cause : budget.at("causes")) share += cause.at("share_percent").get<double>();
  EXPECT_NEAR(share, 100.0, 1e-6);
  EXPECT_EQ(budget.at("total").at("rms_um"),
            Json::parse(done("budget " + path("effect") + " --verbose --json")).at("total").at("rms_um"));
  const auto refused = run_program("budget " + path("nowhere"));
  EXPECT_EQ(refused.exit_code, 2);
}

}  // namespace
}  // namespace volcal
