#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/support/reader_harness.h"

/// The first byte chooses the format; the rest is its files, as unpacked_files() takes them.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  volcal::testing::accepts_tables(std::string(data + 1, data + size), data[0]);
  return 0;
}
