#pragma once
/// Tree behind TomlDocument: what the TOML parser found, with lines and a record of the keys asked for.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "volcal/identify/text/toml_document.h"

namespace volcal::detail {

struct TomlEntry;

struct TomlNode {
  TomlKind kind = TomlKind::Table;
  int line = 0;
  double number = 0.0;  ///< of Number and Integer, as written (not SI)
  std::int64_t integer = 0;
  bool boolean = false;
  std::string text;
  std::vector<TomlNode> items;     ///< of an array
  std::vector<TomlEntry> entries;  ///< of a table, in the order of the file
  std::vector<std::string> known;  ///< keys that a reader asked for

  bool knows(std::string_view key) const;
  const TomlNode* find(std::string_view key) const;
  TomlNode* find(std::string_view key);
};

struct TomlEntry {
  std::string key;
  TomlNode node;
};

struct TomlSource {
  std::string file;
  TomlNode root;
};

/// Throws InputError at the line of a syntax error.
std::shared_ptr<TomlSource> parse_toml(const std::string& text, const std::string& file);

}  // namespace volcal::detail
