// What every simulated instrument must keep, by its row of the table alone.

#include "volcal/sim/measurement/simulated_instruments.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>

namespace volcal::sim {
namespace {

SetupPlan plan_of(const SimulatedInstrument& instrument, std::size_t column_set = 0) {
  SetupPlan plan;
  plan.instrument = std::string(instrument.name);
  plan.column_set = column_set;
  return plan;
}

TEST(SimulatedInstruments, HaveNamesFunctionsAndColumns) {
  std::set<std::string_view> names;
  for (const SimulatedInstrument& instrument : simulated_instruments()) {
    EXPECT_TRUE(names.insert(instrument.name).second) << instrument.name;
    EXPECT_EQ(find_simulated(instrument.name), &instrument);
    EXPECT_NE(instrument.read, nullptr) << instrument.name;
    ASSERT_FALSE(instrument.columns.empty()) << instrument.name;
    for (const auto& columns : instrument.columns) {
      EXPECT_GE(columns.size(), 1U) << instrument.name;
      EXPECT_LE(columns.size(), static_cast<std::size_t>(kMaxReadingChannels)) << instrument.name;
    }
    if (instrument.contacts) {
      EXPECT_LT(*instrument.contacts, instrument.columns.size()) << instrument.name;
    }
  }
  EXPECT_EQ(find_simulated("tape-measure"), nullptr);
  SetupPlan unknown;
  unknown.instrument = "tape-measure";
  EXPECT_THROW(simulated_instrument(unknown), std::invalid_argument);
}

TEST(SimulatedInstruments, EncodersReadTheLastColumnsWhichHaveTheirNames) {
  for (const SimulatedInstrument& instrument : simulated_instruments()) {
    const auto& columns = instrument.columns.front();
    ASSERT_LE(instrument.encoders.size(), columns.size()) << instrument.name;
    std::size_t read = 0;
    for (std::size_t channel = 0; channel < columns.size(); ++channel) {
      const std::string_view encoder = instrument.encoder(channel, 0);
      if (encoder.empty()) continue;
      ++read;
      EXPECT_TRUE(columns[channel].starts_with(encoder)) << instrument.name << " " << encoder;
      EXPECT_TRUE(reads_encoder(plan_of(instrument), channel, encoder)) << instrument.name;
    }
    EXPECT_EQ(read, instrument.encoders.size()) << instrument.name;
    EXPECT_EQ(instrument.channels_before_encoders(0) + read, columns.size()) << instrument.name;
  }
}

}  // namespace
}  // namespace volcal::sim
