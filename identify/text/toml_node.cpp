#include "volcal/identify/text/toml_node.h"

#include <toml++/toml.h>

#include <algorithm>
#include <optional>
#include <regex>

#include "volcal/identify/text/nesting.h"
#include "volcal/identify/text/text_encoding.h"
#include "volcal/identify/text/text_file.h"

namespace volcal::detail {
namespace {

/// Texts of a file are shown on terminals and written into tables.
void require_no_control(std::string_view text, int line, const std::string& file) {
  if (!holds_control(text)) return;
  throw InputError({file, line},
                   "the text \"" + printable(std::string(text)) + "\" holds a control character",
                   "write it in letters, figures and signs; a path in single quotes keeps its backslashes");
}

int line_of(const toml::node& node) { return static_cast<int>(node.source().begin.line); }

TomlNode convert(const toml::node& node, const std::string& file);

void convert_table(const toml::table& table, const std::string& file, TomlNode& into) {
  for (const auto& [key, child] : table) {
    require_no_control(key.str(), static_cast<int>(key.source().begin.line), file);
    TomlNode converted = convert(child, file);
    converted.line = static_cast<int>(key.source().begin.line);
    into.entries.push_back({std::string(key.str()), std::move(converted)});
  }
  std::ranges::stable_sort(into.entries, {}, [](const auto& entry) { return entry.node.line; });
}

TomlNode convert(const toml::node& node, const std::string& file) {
  TomlNode converted;
  converted.line = line_of(node);
  if (const auto* table = node.as_table()) {
    convert_table(*table, file, converted);
  } else if (const auto* array = node.as_array()) {
    converted.kind = TomlKind::Array;
    for (const toml::node& item : *array) converted.items.push_back(convert(item, file));
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
    require_no_control(converted.text, converted.line, file);
  } else if (const auto* boolean = node.as_boolean()) {
    converted.kind = TomlKind::Boolean;
    converted.boolean = boolean->get();
  } else {
    converted.kind = TomlKind::Date;
  }
  return converted;
}

/// What a line `encoding = "NAME"` before the first table says.
std::optional<TextEncoding> stated_encoding(std::string_view text) {
  static const std::regex kLine(R"(^\s*encoding\s*=\s*["']([\w-]+)["'].*)");
  while (!text.empty()) {
    const std::string line(text.substr(0, text.find_first_of("\r\n")));
    std::smatch match;
    if (line.starts_with('[')) return std::nullopt;
    if (line.size() < 100 && std::regex_match(line, match, kLine)) return encoding_of_name(match[1].str());
    text.remove_prefix(
        std::min(text.size(), text.find('\n') == text.npos ? text.size() : text.find('\n') + 1));
  }
  return std::nullopt;
}

/// The text as UTF-8: TOML is, or its key `encoding` says in which code page it stands.
std::string text_as_utf8(const std::string& text, const std::string& file) {
  const int line = line_not_utf8(text);
  if (line == 0) return text;
  const auto encoding = stated_encoding(text);
  if (!encoding || *encoding == TextEncoding::Utf8) {
    throw InputError({file, line}, "the file is not UTF-8 text; it seems to be in a code page",
                     encoding_remedy(text, "write encoding = \"", "\" in its first line"));
  }
  DecodedText decoded = decode(text, *encoding);
  if (decoded.unknown_line > 0) {
    throw InputError({file, decoded.unknown_line}, "a byte here is not a character of the file's encoding",
                     encoding_remedy(text, "write encoding = \"", "\""));
  }
  return std::move(decoded.text);
}

std::string syntax_remedy(const std::string& description) {
  if (description.find("redefine") != std::string::npos ||
      description.find("duplicate") != std::string::npos) {
    return "each key and each table may appear once; remove one of the two";
  }
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

std::shared_ptr<TomlSource> parse_toml(const std::string& bytes, const std::string& file) {
  const std::string text = text_as_utf8(bytes, file);
  require_shallow(text, NestedText::Toml, file);
  try {
    const toml::table table = toml::parse(std::string_view(text), std::string_view(file));
    auto source = std::make_shared<TomlSource>();
    source->file = file;
    convert_table(table, file, source->root);
    return source;
  } catch (const toml::parse_error& error) {
    std::string description(error.description());
    std::ranges::replace(description, '\n', ' ');
    throw InputError({file, static_cast<int>(error.source().begin.line)}, "TOML: " + description,
                     syntax_remedy(description));
  }
}

}  // namespace volcal::detail
