#pragma once
/// Files that are loaded again once they have changed.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace volcal::workbench {

/// When files were written last, and how long they are; those that are not there are absent.
using FileStamps = std::map<std::string, std::pair<std::filesystem::file_time_type, std::uintmax_t>>;

FileStamps stamp_of(const std::vector<std::string>& files);

/// Those of which the stamp is another now.
std::vector<std::string> changed_since(const FileStamps& before);

/// These and the files that they name, there or not, sorted: their text need not be right.
std::vector<std::string> with_named_files(const std::vector<std::string>& files);

}  // namespace volcal::workbench
