#include "volcal/identify/io/toml_node.h"

#include <toml++/toml.h>

#include <algorithm>

#include "volcal/identify/io/nesting.h"

namespace volcal::detail {
namespace {

int line_of(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

TomlNode convert(const toml::node& node);

void convert_table(const toml::table& table, TomlNode& into) {
  for (const auto& [key, child] : table) {
    TomlNode converted = convert(child);
    converted.line = static_cast<int>(key.source().begin.line);
    into.entries.push_back({std::string(key.str()), std::move(converted)});
  }
  std::ranges::stable_sort(into.entries, {}, [](const auto& entry) { return entry.node.line; });
}

TomlNode convert(const toml::node& node) {
  TomlNode converted;
  converted.line = line_of(node);
  if (const auto* table = node.as_table()) {
    convert_table(*table, converted);
  } else if (const auto* array = node.as_array()) {
    converted.kind = TomlKind::Array;
    for (const toml::node& item : *array) converted.items.push_back(convert(item));
  } else if (const auto* integer = node.as_integer()) {
    converted.kind = TomlKind::Integer;
    converted.integer = integer->get();
    converted.number = static_cast<double>(integer->get());
  } else if (const auto* number = node.as_floating_point()) {
    converted.kind = TomlKind::Number;
    converted.number = number->get();
  } else if (const auto* text = node.as_string()) {
    converted.kind = TomlKind::Text;
    converted.text = text->get();
  } else if (const auto* boolean = node.as_boolean()) {
    converted.kind = TomlKind::Boolean;
    converted.boolean = boolean->get();
  } else {
    converted.kind = TomlKind::Date;
  }
  return converted;
}

std::string syntax_remedy(const std::string& description) {
  if (description.find("redefine") != std::string::npos ||
      description.find("duplicate") != std::string::npos) {
    return "each key and each table may appear once; remove one of the two";
  }
  if (description.find("utf-8") != std::string::npos)
    return "save the file as UTF-8, or write names without accents";
  return "TOML syntax: key = value, texts in double quotes, decimal point, arrays as [1.0, 2.0]";
}

}  // namespace

bool TomlNode::knows(std::string_view key) const { return std::ranges::find(known, key) != known.end(); }

const TomlNode* TomlNode::find(std::string_view key) const {
  const auto found = std::ranges::find(entries, key, &TomlEntry::key);
  return found == entries.end() ? nullptr : &found->node;
}

TomlNode* TomlNode::find(std::string_view key) {
  const auto found = std::ranges::find(entries, key, &TomlEntry::key);
  return found == entries.end() ? nullptr : &found->node;
}

std::shared_ptr<TomlSource> parse_toml(const std::string& text, const std::string& file) {
  require_shallow(text, NestedText::Toml, file);
  try {
    const toml::table table = toml::parse(std::string_view(text), std::string_view(file));
    auto source = std::make_shared<TomlSource>();
    source->file = file;
    convert_table(table, source->root);
    return source;
  } catch (const toml::parse_error& error) {
    std::string description(error.description());
    std::ranges::replace(description, '\n', ' ');
    throw InputError({file, static_cast<int>(error.source().begin.line)}, "TOML: " + description,
                     syntax_remedy(description));
  }
}

}  // namespace volcal::detail
