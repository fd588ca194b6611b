#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/support/program_harness.h"

/// The first byte chooses what the control holds; the rest is the program.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  volcal::testing::accepts_program(std::string(data + 1, data + size), data[0]);
  return 0;
}
