#include "volcal/identify/text/toml_document.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_encoding.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/identify/text/toml_node.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using detail::TomlNode;

constexpr int kFileDigits = 9;  // what a file holds is repeated as it stands

std::string with_unit(double value, std::string_view key) {
  const std::string_view unit = unit_of_key(key).suffix;
  return number_text(value, kFileDigits) + (unit.empty() ? "" : " " + std::string(unit));
}

const char* kind_name(TomlKind kind) {
  switch (kind) {
    case TomlKind::Number:
      return "a number";
    case TomlKind::Integer:
      return "an integer";
    case TomlKind::Text:
      return "a text";
    case TomlKind::Boolean:
      return "true or false";
    case TomlKind::Array:
      return "an array";
    case TomlKind::Table:
      return "a table";
    case TomlKind::Date:
      return "a date or time";
    case TomlKind::Absent:
      break;
  }
  return "nothing";
}

/// A known key with the same stem and another unit, as `station_mm` for `station_m`.
std::optional<std::string> other_unit_of(std::string_view key, const std::vector<std::string>& known) {
  for (const std::string& candidate : known) {
    const Unit unit = unit_of_key(candidate);
    if (unit.suffix.empty() || candidate == key) continue;
    if (stem_of_key(candidate) == stem_of_key(key)) return candidate;
  }
  return std::nullopt;
}

std::string type_remedy(const std::string& expected) {
  if (expected.find("text") != std::string::npos) return "write texts in double quotes";
  if (expected.find("table") != std::string::npos)
    return "write [NAME] or NAME = { key = value }; repeated tables as [[NAME]]";
  if (expected.find("array") != std::string::npos) return "write [1.0, 2.0, 3.0]";
  return "write " + expected + " without quotes";
}

enum class Dimension { Length, Angle, Other };

Dimension dimension_of(std::string_view unit) {
  if (unit == "m" || unit == "mm" || unit == "um") return Dimension::Length;
  if (unit == "rad" || unit == "mrad" || unit == "urad" || unit == "deg") return Dimension::Angle;
  return Dimension::Other;
}

std::string unit_remedy(std::string_view key, const std::string& known) {
  const Unit given = unit_of_key(key);
  const Unit wanted = unit_of_key(known);
  std::string remedy = "write " + known + ", in " + std::string(wanted.suffix);
  const Dimension dimension = dimension_of(given.suffix);
  if (dimension != Dimension::Other && dimension == dimension_of(wanted.suffix)) {
    remedy +=
        ": 1 " + std::string(given.suffix) + " = " + with_unit(given.si_per_unit / wanted.si_per_unit, known);
  }
  return remedy;
}

std::string unknown_remedy(std::string_view key, const std::vector<std::string>& known) {
  if (const auto other = other_unit_of(key, known)) return unit_remedy(key, *other);
  return suggest_name(key, known, "keys here");
}

/// Standard deviations and radii are never negative.
bool is_size(const std::string& stem) { return stem.ends_with("sigma") || stem.ends_with("radius"); }

bool is_blank(const std::string& text) { return text.find_first_not_of(" \t") == std::string::npos; }

struct Unknown {
  const TomlNode* node = nullptr;
  std::string path;
  std::string remedy;
};

void find_first_unknown(const TomlNode& table, const std::string& path, Unknown& first) {
  for (const auto& [key, child] : table.entries) {
    const std::string child_path = path.empty() ? key : path + "." + key;
    if (!table.knows(key)) {
      if (!first.node || child.line < first.node->line) {
        first = {&child, child_path, unknown_remedy(key, table.known)};
      }
      continue;
    }
    if (child.kind == TomlKind::Table) find_first_unknown(child, child_path, first);
    if (child.kind != TomlKind::Array) continue;
    for (std::size_t i = 0; i < child.items.size(); ++i) {
      if (child.items[i].kind != TomlKind::Table) continue;
      find_first_unknown(child.items[i], child_path + "[" + std::to_string(i + 1) + "]", first);
    }
  }
}

}  // namespace

TomlTable::TomlTable(std::shared_ptr<detail::TomlSource> source, TomlNode* node, std::string path)
    : source_(std::move(source)), node_(node), path_(std::move(path)) {}

SourcePlace TomlTable::place() const { return {source_->file, node_->line}; }

SourcePlace TomlTable::place(std::string_view key) const {
  const TomlNode* found = node_->find(key);
  return {source_->file, found ? found->line : node_->line};
}

std::string TomlTable::name(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

void TomlTable::know(std::string_view key) const {
  if (!node_->knows(key)) node_->known.emplace_back(key);
}

TomlNode* TomlTable::find(std::string_view key) const {
  know(key);
  return node_->find(key);
}

TomlKind TomlTable::kind(std::string_view key) const {
  const TomlNode* found = find(key);
  return found ? found->kind : TomlKind::Absent;
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, child] : node_->entries) names.push_back(key);
  return names;
}

void TomlTable::fail(std::string_view key, const std::string& problem, const std::string& remedy) const {
  throw InputError(place(key), problem, remedy);
}

void TomlTable::fail_missing(std::string_view key, const std::string& remedy) const {
  std::vector<std::string> unknown;
  for (const auto& [present, child] : node_->entries) {
    if (!node_->knows(present)) unknown.push_back(present);
  }
  std::string wanted(key);
  for (const std::string& present : unknown) {
    if (other_unit_of(present, {wanted})) {
      fail(present, "unknown key " + name(present), unit_remedy(present, wanted));
    }
  }
  if (const auto near = nearest_name(key, unknown)) {
    fail(*near, "unknown key " + name(*near), "did you mean \"" + wanted + "\"?");
  }
  const std::string_view unit = unit_of_key(key).suffix;
  const std::string where = path_.empty() ? "at the top of the file" : "in " + path_;
  throw InputError(
      place(), "key " + wanted + " is missing " + where,
      !remedy.empty() ? remedy : "add " + wanted + (unit.empty() ? "" : ", in " + std::string(unit)));
}

void TomlTable::fail_type(std::string_view key, const TomlNode& node, const std::string& expected) const {
  throw InputError({source_->file, node.line},
                   name(key) + " is " + kind_name(node.kind) + ", expected " + expected,
                   type_remedy(expected));
}

double TomlTable::finite(const TomlNode& node, std::string_view key, NumberLimits limits) const {
  if (node.kind != TomlKind::Number && node.kind != TomlKind::Integer) {
    if (node.kind == TomlKind::Text) {
      throw InputError({source_->file, node.line},
                       name(key) + " is the text \"" + printable(node.text) + "\", expected a number",
                       "write the number without quotes, with a decimal point");
    }
    fail_type(key, node, "a number");
  }
  const double value = node.number;
  const SourcePlace here{source_->file, node.line};
  if (!std::isfinite(value))
    throw InputError(here, name(key) + " is not a finite number", "give a finite number");
  if (value < limits.min) {
    throw InputError(
        here, name(key) + " is " + number_text(value, kFileDigits),
        limits.min == 0.0 ? "it must not be negative" : "it must be at least " + with_unit(limits.min, key));
  }
  if (value > limits.max) {
    throw InputError(here, name(key) + " is " + number_text(value, kFileDigits),
                     "it must be at most " + with_unit(limits.max, key));
  }
  return value;
}

std::optional<double> TomlTable::number(std::string_view key, NumberLimits limits) const {
  const TomlNode* found = find(key);
  if (!found) return std::nullopt;
  return finite(*found, key, limits) * unit_of_key(key).si_per_unit;
}

std::optional<double> TomlTable::raw_number(std::string_view key) const {
  const TomlNode* found = find(key);
  if (!found) return std::nullopt;
  return finite(*found, key, {});
}

std::optional<std::int64_t> TomlTable::integer(std::string_view key, std::int64_t min,
                                               std::int64_t max) const {
  const TomlNode* found = find(key);
  if (!found) return std::nullopt;
  if (found->kind != TomlKind::Integer) fail_type(key, *found, "an integer");
  if (found->integer < min || found->integer > max) {
    fail(key, name(key) + " is " + std::to_string(found->integer),
         "it must be " + std::to_string(min) + " to " + std::to_string(max));
  }
  return found->integer;
}

std::optional<std::string> TomlTable::text(std::string_view key) const {
  const TomlNode* found = find(key);
  if (!found) return std::nullopt;
  if (found->kind != TomlKind::Text) fail_type(key, *found, "a text in quotes");
  return found->text;
}

std::optional<bool> TomlTable::boolean(std::string_view key) const {
  const TomlNode* found = find(key);
  if (!found) return std::nullopt;
  if (found->kind != TomlKind::Boolean) fail_type(key, *found, "true or false");
  return found->boolean;
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key, NumberLimits limits) const {
  const TomlNode* found = find(key);
  if (!found) return std::nullopt;
  if (found->kind != TomlKind::Array) fail_type(key, *found, "an array of numbers");
  std::vector<double> values;
  values.reserve(found->items.size());
  const double factor = unit_of_key(key).si_per_unit;
  for (const TomlNode& item : found->items) values.push_back(finite(item, key, limits) * factor);
  return values;
}

std::optional<Eigen::Vector3d> TomlTable::vector3(std::string_view key) const {
  const auto values = numbers(key);
  if (!values) return std::nullopt;
  if (values->size() != 3) {
    fail(key, name(key) + " has " + std::to_string(values->size()) + " numbers, expected 3",
         "give [x, y, z]");
  }
  return Eigen::Vector3d((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<std::vector<std::string>> TomlTable::texts(std::string_view key) const {
  const TomlNode* found = find(key);
  if (!found) return std::nullopt;
  if (found->kind != TomlKind::Array) fail_type(key, *found, "an array of texts");
  std::vector<std::string> values;
  for (const TomlNode& item : found->items) {
    if (item.kind != TomlKind::Text) fail_type(key, item, "an array of texts");
    values.push_back(item.text);
  }
  return values;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) const {
  TomlNode* found = find(key);
  if (!found) return std::nullopt;
  if (found->kind != TomlKind::Table) fail_type(key, *found, "a table [" + name(key) + "]");
  return TomlTable(source_, found, name(key));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  TomlNode* found = find(key);
  if (!found) return {};
  if (found->kind == TomlKind::Table) {
    fail(key, name(key) + " is a single table", "write [[" + name(key) + "]] with double brackets");
  }
  if (found->kind != TomlKind::Array) fail_type(key, *found, "tables [[" + name(key) + "]]");
  std::vector<TomlTable> all;
  for (std::size_t i = 0; i < found->items.size(); ++i) {
    TomlNode& item = found->items[i];
    if (item.kind != TomlKind::Table) fail_type(key, item, "tables [[" + name(key) + "]]");
    all.emplace_back(source_, &item, name(key) + "[" + std::to_string(i + 1) + "]");
  }
  return all;
}

namespace {

template <class T>
T or_missing(std::optional<T> value, const TomlTable& table, std::string_view key) {
  if (!value) table.fail_missing(key);
  return *std::move(value);
}

}  // namespace

double TomlTable::required_number(std::string_view key, NumberLimits limits) const {
  return or_missing(number(key, limits), *this, key);
}

std::string TomlTable::required_text(std::string_view key) const { return or_missing(text(key), *this, key); }

std::string TomlTable::required_name(std::string_view key) const {
  std::string given = required_text(key);
  if (is_blank(given)) fail(key, name(key) + " is empty", "give it a name");
  require_no_formula(key, given);
  return given;
}

void TomlTable::require_no_formula(std::string_view key, const std::string& name) const {
  const std::size_t first = name.find_first_not_of(" \t");
  if (first == std::string::npos || std::string_view("=+-@").find(name[first]) == std::string_view::npos)
    return;
  fail(key, "the name \"" + printable(name) + "\" begins with " + name[first],
       "begin it with a letter or a figure: a spreadsheet takes it for a formula in the tables that hold it");
}

std::vector<double> TomlTable::required_numbers(std::string_view key, NumberLimits limits) const {
  return or_missing(numbers(key, limits), *this, key);
}

Eigen::Vector3d TomlTable::required_vector3(std::string_view key) const {
  return or_missing(vector3(key), *this, key);
}

TomlTable TomlTable::required_table(std::string_view key) const { return or_missing(table(key), *this, key); }

std::vector<TomlTable> TomlTable::required_tables(std::string_view key, const std::string& remedy) const {
  auto all = tables(key);
  if (all.empty()) fail_missing(key, remedy);
  return all;
}

std::optional<std::string> TomlTable::choice(std::string_view key,
                                             const std::vector<std::string>& choices) const {
  auto value = text(key);
  if (value && std::ranges::find(choices, *value) == choices.end()) {
    fail(key, name(key) + " = \"" + printable(*value) + "\" is not known",
         suggest_name(*value, choices, "values"));
  }
  return value;
}

void TomlTable::check_plausible(const KeySchema& schema, double value) const {
  const double size = std::abs(value);
  const bool large = size > schema.plausible_max;
  if (!large && (size == 0.0 || size >= schema.plausible_min)) return;
  const double factor = large ? 1e-3 : 1e3;
  const double meant = size * factor;
  const bool unit_slip = meant <= schema.plausible_max && meant >= schema.plausible_min;
  std::string remedy = large
                           ? "at most " + with_unit(schema.plausible_max, schema.key) + " is believed"
                           : "0 or at least " + with_unit(schema.plausible_min, schema.key) + " is believed";
  if (unit_slip) {
    remedy += "; wrong unit by 1000? " + std::string(stem_of_key(schema.key)) + " is stated in " +
              std::string(unit_of_key(schema.key).suffix) + ", write " +
              number_text(value * factor, kFileDigits);
  }
  fail(schema.key,
       name(schema.key) + " = " + with_unit(value, schema.key) + (large ? " is too large" : " is too small"),
       remedy);
}

Options TomlTable::options(const std::vector<KeySchema>& schema) const {
  Options read;
  for (const KeySchema& key : schema) know(key.key);
  for (const KeySchema& key : schema) {
    const std::string stem(stem_of_key(key.key));
    const double factor = unit_of_key(key.key).si_per_unit;
    if (!has(key.key)) {
      if (key.required) fail_missing(key.key);
      continue;
    }
    switch (key.type) {
      case KeyType::Number: {
        const double value = *number(key.key, is_size(stem) ? kNotNegative : NumberLimits{});
        check_plausible(key, value / factor);
        read.set(stem, value);
        break;
      }
      case KeyType::Vector3: {
        const Eigen::Vector3d value = *vector3(key.key);
        for (const double component : value) check_plausible(key, component / factor);
        read.set(stem, value);
        break;
      }
      case KeyType::Numbers: {
        std::vector<double> values = required_numbers(key.key);
        for (const double value : values) check_plausible(key, value / factor);
        read.set(stem, std::move(values));
        break;
      }
      case KeyType::Text: {
        const std::string value = key.choices.empty() ? *text(key.key) : *choice(key.key, key.choices);
        if (is_blank(value)) {
          fail(key.key, name(key.key) + " is empty",
               "write a text" + (key.required ? "" : ", or leave " + key.key + " out"));
        }
        read.set(stem, value);
        break;
      }
      case KeyType::Boolean:
        read.set(stem, *boolean(key.key));
        break;
    }
  }
  return read;
}

TomlDocument TomlDocument::read(const std::string& path, const SourcePlace& named_at) {
  return parse(read_text_file(path, named_at), path);
}

TomlDocument TomlDocument::parse(const std::string& text, const std::string& file) {
  TomlDocument document(detail::parse_toml(text, file));
  if (document.source_->root.find("encoding") != nullptr)
    document.root().choice("encoding", encoding_names());
  return document;
}

TomlTable TomlDocument::root() const { return TomlTable(source_, &source_->root, ""); }

void TomlDocument::require_format(const std::string& format) const {
  const TomlTable table = root();
  if (!table.has("format")) {
    throw InputError({source_->file, 0}, "key format is missing at the top of the file",
                     "add format = \"" + format + "\"");
  }
  const std::string given = table.required_text("format");
  if (given == format) return;
  std::string remedy = "expected format = \"" + format + "\"";
  const auto kind_of = [](const std::string& name) { return name.substr(0, name.rfind('-')); };
  if (given.starts_with("volcal-")) {
    remedy += kind_of(given) == kind_of(format) ? "; the file is of another version"
                                                : "; this is another kind of file, check the path";
  }
  table.fail("format", "format is \"" + printable(given) + "\"", remedy);
}

namespace {

void reject_unknown_below(const TomlNode& table, const std::string& path, const std::string& file) {
  Unknown first;
  find_first_unknown(table, path, first);
  if (!first.node) return;
  throw InputError({file, first.node->line}, "unknown key " + printable(first.path), first.remedy);
}

}  // namespace

void TomlTable::reject_unknown() const { reject_unknown_below(*node_, path_, source_->file); }

void TomlDocument::reject_unknown() const { reject_unknown_below(source_->root, "", source_->file); }

}  // namespace volcal
