// Traits of instruments: of ours by hand, and of every one that they hold for what its schema declares.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>

#include "tests/support/schema_keys.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

volcal::Setup setup_of(const std::string& instrument) {
  volcal::Setup setup;
  setup.name = "S";
  setup.instrument = instrument;
  return setup;
}

const InstrumentTraits& traits_of_name(const std::string& instrument) {
  return traits_of(setup_of(instrument));
}

struct InstrumentTruth {
  LaserLength laser_length;
  bool length_from_zero, has_bar, reads_in_motion, reads_error_vectors, stands_on_floor;
};

TEST(InstrumentTraits, OfOurInstruments) {
  const std::map<std::string, InstrumentTruth> truth = {
      {"laser-tracer", {LaserLength::Distance, true, false, false, false, true}},
      {"laser-tracker", {LaserLength::Distance, true, false, false, false, true}},
      {"ball-bar", {LaserLength::None, true, true, true, false, false}},
      {"displacement", {LaserLength::Displacement, true, false, false, false, false}},
      {"straightness", {LaserLength::None, true, false, false, false, false}},
      {"angle", {LaserLength::None, false, false, false, false, false}},
      {"volumetric-points", {LaserLength::None, false, false, false, true, false}},
      {"r-test", {LaserLength::None, false, false, false, false, false}},
      {"probed-sphere", {LaserLength::None, false, false, false, false, false}}};
  for (const auto& [name, expected] : truth) {
    ASSERT_NE(find_instrument(name), nullptr) << name;
    const InstrumentTraits& traits = traits_of_name(name);
    EXPECT_EQ(traits.laser_length, expected.laser_length) << name;
    EXPECT_EQ(traits.length_from_zero, expected.length_from_zero) << name;
    EXPECT_EQ(traits.has_bar, expected.has_bar) << name;
    EXPECT_EQ(traits.reads_in_motion, expected.reads_in_motion) << name;
    EXPECT_EQ(traits.reads_error_vectors, expected.reads_error_vectors) << name;
    EXPECT_EQ(traits.stands_on_floor({}), expected.stands_on_floor) << name;
    EXPECT_EQ(traits.encoders.size(), name == "laser-tracker" ? 2U : 0U) << name;
    const LineReading line_reading = name == "displacement"   ? LineReading::Along
                                     : name == "straightness" ? LineReading::Across
                                     : name == "angle"        ? LineReading::Rotation
                                                              : LineReading::None;
    EXPECT_EQ(traits.line_reading, line_reading) << name;
    const SphereReading sphere_reading = name == "r-test"          ? SphereReading::Displacement
                                         : name == "probed-sphere" ? SphereReading::Place
                                                                   : SphereReading::None;
    EXPECT_EQ(traits.sphere_reading, sphere_reading) << name;
  }
  EXPECT_EQ(instrument_with_bar(), "ball-bar");
}

/// A level refers to gravity, an angular interferometer between spindle and table does not.
TEST(InstrumentTraits, ALevelStandsOnTheFloor) {
  const auto& stands_on_floor = traits_of_name("angle").stands_on_floor;
  const auto with_body = [](const std::string& body) {
    Options options;
    options.set("body", body);
    return options;
  };
  EXPECT_FALSE(stands_on_floor(with_body("relative")));
  EXPECT_TRUE(stands_on_floor(with_body("tool")));
  EXPECT_TRUE(stands_on_floor(with_body("table")));
}

TEST(InstrumentTraits, AnUnknownInstrumentHasNone) {
  const InstrumentTraits& none = traits_of_name("tape-measure");
  EXPECT_EQ(none.laser_length, LaserLength::None);
  EXPECT_FALSE(none.length_from_zero || none.has_bar || none.reads_in_motion || none.reads_error_vectors);
  EXPECT_TRUE(none.encoders.empty());
  EXPECT_FALSE(none.stands_on_floor({}));
}

/// What reads a trait reads the keys and columns that come with it.
TEST(InstrumentTraits, AgreeWithTheSchema) {
  for (const Instrument* instrument : instruments()) {
    const InstrumentSchema& schema = instrument->schema();
    const InstrumentTraits& traits = schema.traits;
    if (traits.laser_length == LaserLength::Distance) {
      EXPECT_TRUE(testing_support::has_key(schema, "station_mm")) << schema.name;
    }
    if (traits.laser_length == LaserLength::Displacement) {
      EXPECT_TRUE(testing_support::has_key(schema, "direction")) << schema.name;
    }
    if (traits.sphere_reading != SphereReading::None) {
      EXPECT_TRUE(testing_support::has_key(schema, "sphere")) << schema.name;
    }
    if (traits.has_bar) {
      EXPECT_TRUE(testing_support::has_key(schema, "centre_mm")) << schema.name;
      EXPECT_TRUE(testing_support::has_key(schema, "length_sigma_um")) << schema.name;
    }
    volcal::Setup setup = setup_of(schema.name);
    for (setup.readings.column_set = 0; setup.readings.column_set < schema.column_sets.size();
         ++setup.readings.column_set) {
      if (traits.length_from_zero) {
        EXPECT_FALSE(is_angle_channel(setup, 0)) << schema.name;
      }
      for (const AngleEncoder& encoder : traits.encoders) {
        const auto channel = static_cast<std::size_t>(encoder.channel);
        EXPECT_TRUE(is_angle_channel(setup, channel)) << schema.name;
        EXPECT_TRUE(channel_column(setup, channel).starts_with(encoder.name)) << schema.name;
      }
      if (traits.reads_error_vectors) {
        EXPECT_TRUE(channel_column(setup, 0).starts_with("e")) << schema.name;
      }
    }
  }
}

}  // namespace
}  // namespace volcal
