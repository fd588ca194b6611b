#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/support/reader_harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  volcal::testing::accepts_workbench_request(std::string(data, data + size));
  return 0;
}
