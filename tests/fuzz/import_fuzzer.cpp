#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/support/reader_harness.h"

/// The first byte chooses the format, the second what is said of the file; the rest is the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  volcal::testing::accepts_import(std::string(data + 2, data + size), data[0], data[1]);
  return 0;
}
