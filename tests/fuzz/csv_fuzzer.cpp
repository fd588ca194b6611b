#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "tests/support/reader_harness.h"

/// The first byte chooses the instrument, the second the format; the rest is the file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  using volcal::TextEncoding;
  static constexpr std::array<volcal::CsvFormat, 5> kFormats = {{{',', '.', TextEncoding::Utf8, 0},
                                                                 {';', ',', TextEncoding::Utf8, 0},
                                                                 {'\t', '.', TextEncoding::Utf8, 1},
                                                                 {' ', '.', TextEncoding::Utf8, 0},
                                                                 {';', ',', TextEncoding::Cp1252, 0}}};
  volcal::testing::accepts_readings(std::string(data + 2, data + size), data[0],
                                    kFormats[data[1] % kFormats.size()]);
  return 0;
}
