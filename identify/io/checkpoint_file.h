#pragma once
/// The state of an interrupted Monte Carlo study in a file: a line of text that says what it is, the
/// fingerprint of the study, the state, a checksum. Written under a temporary name, flushed to the disk and
/// renamed: a killed or powered-off run leaves the state before or the state after.

#include <cstdint>
#include <string>
#include <string_view>

namespace volcal {

/// Throws InputError when the file cannot be written.
void write_checkpoint(const std::string& path, std::uint64_t fingerprint, const std::string& state);

/// Whether there is such a file.
bool has_checkpoint(const std::string& path);

/// The state. Throws InputError: no such file, another kind of file, cut off or changed, another study's.
std::string read_checkpoint(const std::string& path, std::uint64_t fingerprint);

/// The bytes of such a file.
std::string checkpoint_bytes(std::uint64_t fingerprint, const std::string& state);
/// The state in these bytes; `file` names them in errors. Throws InputError.
std::string checkpoint_state(std::string_view bytes, const std::string& file, std::uint64_t fingerprint);

void remove_checkpoint(const std::string& path);

}  // namespace volcal
