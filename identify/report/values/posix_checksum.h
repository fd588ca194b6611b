#pragma once
/// The checksum that `cksum` prints of a file (IEEE Std 1003.1, cksum: CRC-32 with the length behind the
/// content), so that whoever holds a file can say whether it is the one that was signed.

#include <cstdint>
#include <string_view>

namespace volcal::report {

std::uint32_t posix_checksum(std::string_view content);

}  // namespace volcal::report
