// Sizes of errors: vectors as one value, angles apart.

#include <gtest/gtest.h>

#include <cmath>

#include "volcal/identify/solve/evaluate.h"

namespace volcal {
namespace {

Setup with_readings(const std::string& instrument, std::size_t channels, std::size_t rows) {
  Setup setup;
  setup.name = setup.instrument = instrument;
  setup.readings.value.assign(channels, std::vector<double>(rows, 0.0));
  setup.readings.source_line.assign(rows, 0);
  return setup;
}

ResidualRecord residual(std::size_t setup, std::size_t row, int channel, double value) {
  ResidualRecord record;
  record.setup = setup;
  record.row = row;
  record.channel = channel;
  record.reading = value;
  return record;
}

/// Error vectors (3, 4, 0) and (0, 0, 12) um, a displacement of 1 um, an angle of 7 urad.
TEST(ErrorSizes, AreOfVectorsNotOfTheirComponents) {
  Campaign campaign;
  campaign.setups = {with_readings("volumetric-points", 3, 2), with_readings("displacement", 1, 2),
                     with_readings("angle", 1, 1)};
  std::vector<ResidualRecord> records = {
      residual(0, 0, 0, 3e-6),  residual(0, 0, 1, 4e-6), residual(0, 0, 2, 0.0),
      residual(0, 1, 0, 0.0),   residual(0, 1, 1, 0.0),  residual(0, 1, 2, 12e-6),
      residual(1, 0, 0, -1e-6), residual(1, 1, 0, 1.0),  residual(2, 0, 0, 7e-6)};
  records[7].left_out = true;
  const ErrorSizes sizes = error_sizes(campaign, records);
  EXPECT_EQ(sizes.lengths.count, 3U);
  EXPECT_NEAR(sizes.lengths.rms, std::sqrt((25.0 + 144.0 + 1.0) / 3.0) * 1e-6, 1e-15);
  EXPECT_NEAR(sizes.lengths.max, 12e-6, 1e-15);
  EXPECT_EQ(sizes.angles.count, 1U);
  EXPECT_NEAR(sizes.angles.rms, 7e-6, 1e-15);
}

}  // namespace
}  // namespace volcal
