#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/support/reader_harness.h"

/// The first byte chooses the table; the rest is the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  volcal::testing::accepts_error_tables(std::string(data + 1, data + size), data[0]);
  return 0;
}
