#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/support/reader_harness.h"
#include "volcal/studies/criticism/criticism_record.h"

/// A line of the campaigns that a study of criticism has finished.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string line(data, data + size);
  volcal::testing::accepts([&] { volcal::cli::record_of_line(line, {"campaigns.jsonl", 1}); });
  return 0;
}
