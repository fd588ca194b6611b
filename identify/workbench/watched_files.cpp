#include "volcal/identify/workbench/watched_files.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>

namespace volcal::workbench {
namespace {

/// What stands in quotes, as far as it looks like a name of a file.
std::vector<std::string> quoted_names(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t at = text.find_first_of("\"'\n"); at != std::string::npos;) {
    const std::size_t end = text[at] == '\n' ? at : text.find_first_of(std::string{text[at], '\n'}, at + 1);
    if (end == std::string::npos) break;
    if (end > at + 1 && text[end] != '\n') {
      std::string name = text.substr(at + 1, end - at - 1);
      if (std::filesystem::path(name).has_extension()) names.push_back(std::move(name));
    }
    at = text.find_first_of("\"'\n", end + 1);
  }
  return names;
}

void add_with_named(const std::filesystem::path& file, std::set<std::string>& files) {
  if (file.empty() || !files.insert(file.string()).second || file.extension() != ".toml") return;
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (const std::string& name : quoted_names(text)) add_with_named(file.parent_path() / name, files);
}

}  // namespace

FileStamps stamp_of(const std::vector<std::string>& files) {
  FileStamps stamp;
  for (const std::string& file : files) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(file, error);
    const auto size = error ? 0 : std::filesystem::file_size(file, error);
    if (!error) stamp[file] = {time, size};
  }
  return stamp;
}

std::vector<std::string> changed_since(const FileStamps& before) {
  std::vector<std::string> files;
  for (const auto& [file, stamp] : before) files.push_back(file);
  const FileStamps now = stamp_of(files);
  std::erase_if(files, [&](const std::string& file) {
    const auto found = now.find(file);
    return found != now.end() && found->second == before.at(file);
  });
  return files;
}

std::vector<std::string> with_named_files(const std::vector<std::string>& files) {
  std::set<std::string> all;
  for (const std::string& file : files) add_with_named(file, all);
  return {all.begin(), all.end()};
}

}  // namespace volcal::workbench
