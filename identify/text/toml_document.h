#pragma once
/// TOML files as typed, unit-checked values that know their file and line.
///
/// A reader asks a `TomlTable` for the keys it knows; every key asked for counts as known. At the end
/// `TomlDocument::reject_unknown()` throws for the first key that nobody asked for, with the nearest known
/// key or, when only the unit differs (`station_m` for `station_mm`), with the conversion. Numbers come out
/// in SI: the unit is the suffix of the key (model/description/units.h). Integers are accepted wherever a
/// number is; nan and inf never are. A file that is not UTF-8 is read where its root key `encoding` names a
/// code page; every kind of file may have that key. All errors are InputError.

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/schema.h"

namespace volcal {

enum class TomlKind { Absent, Number, Integer, Text, Boolean, Array, Table, Date };

/// Bounds of a number, both allowed, in the unit of its key.
struct NumberLimits {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};
inline constexpr NumberLimits kNotNegative{0.0, std::numeric_limits<double>::infinity()};

namespace detail {
struct TomlNode;
struct TomlSource;
}  // namespace detail

/// One table of a document. Copies share the record of known keys; the document's text stays alive with them.
class TomlTable {
 public:
  TomlTable(std::shared_ptr<detail::TomlSource> source, detail::TomlNode* node, std::string path);

  /// Dotted path of this table, "" for the root: "axes.X", "setups[3].noise".
  const std::string& path() const { return path_; }
  SourcePlace place() const;
  SourcePlace place(std::string_view key) const;  ///< of the key, or of the table when it is absent

  /// What stands under a key; asking makes the key known.
  TomlKind kind(std::string_view key) const;
  bool has(std::string_view key) const { return kind(key) != TomlKind::Absent; }
  std::vector<std::string> keys() const;  ///< in the order of the file; does not make them known
  /// Makes a key known without reading it; needed only for keys that are legal and unused here.
  void know(std::string_view key) const;

  // Absent keys give nothing; a wrong type is an error.
  std::optional<double> number(std::string_view key, NumberLimits limits = {}) const;  ///< SI
  std::optional<double> raw_number(std::string_view key) const;  ///< as written, whatever the key's unit
  std::optional<std::int64_t> integer(std::string_view key, std::int64_t min, std::int64_t max) const;
  std::optional<std::string> text(std::string_view key) const;
  std::optional<bool> boolean(std::string_view key) const;
  std::optional<std::vector<double>> numbers(std::string_view key, NumberLimits limits = {}) const;  ///< SI
  std::optional<Eigen::Vector3d> vector3(std::string_view key) const;                                ///< SI
  std::optional<std::vector<std::string>> texts(std::string_view key) const;
  std::optional<TomlTable> table(std::string_view key) const;
  std::vector<TomlTable> tables(std::string_view key) const;  ///< [[key]]; empty when absent

  // The same, with an error when the key is absent.
  double required_number(std::string_view key, NumberLimits limits = {}) const;
  std::string required_text(std::string_view key) const;
  /// A text that is more than blanks and that no spreadsheet takes for a formula.
  std::string required_name(std::string_view key) const;
  std::vector<double> required_numbers(std::string_view key, NumberLimits limits = {}) const;
  Eigen::Vector3d required_vector3(std::string_view key) const;
  TomlTable required_table(std::string_view key) const;
  /// `remedy`: instead of "add KEY".
  std::vector<TomlTable> required_tables(std::string_view key, const std::string& remedy = "") const;

  /// Text that must be one of `choices`.
  std::optional<std::string> choice(std::string_view key, const std::vector<std::string>& choices) const;

  /// Keys of a schema: type, required, choices and plausible bounds checked; values in SI under the stem.
  Options options(const std::vector<KeySchema>& schema) const;

  /// Throws InputError where `name`, the value or the name of a key, begins like a formula (= + - @).
  void require_no_formula(std::string_view key, const std::string& name) const;
  /// Throws InputError at a key (or at this table when the key is absent).
  [[noreturn]] void fail(std::string_view key, const std::string& problem, const std::string& remedy) const;
  /// Throws "KEY is missing", or names the unknown key that was probably meant to be it. `remedy`:
  /// instead of "add KEY".
  [[noreturn]] void fail_missing(std::string_view key, const std::string& remedy = "") const;

  /// Throws for the first key of this table that was never asked for.
  void reject_unknown() const;

 private:
  detail::TomlNode* find(std::string_view key) const;
  std::string name(std::string_view key) const;  ///< with the path of the table
  double finite(const detail::TomlNode& node, std::string_view key, NumberLimits limits) const;
  [[noreturn]] void fail_type(std::string_view key, const detail::TomlNode& node,
                              const std::string& expected) const;
  void check_plausible(const KeySchema& schema, double value) const;

  std::shared_ptr<detail::TomlSource> source_;
  detail::TomlNode* node_;
  std::string path_;
};

class TomlDocument {
 public:
  /// `named_at`: the line of another file that names this one, for the message when it does not exist.
  static TomlDocument read(const std::string& path, const SourcePlace& named_at = {});
  static TomlDocument parse(const std::string& text, const std::string& file);

  TomlTable root() const;
  /// Checks the root key `format`, e.g. "volcal-machine-1".
  void require_format(const std::string& format) const;
  /// Throws for the first key of the file that was never asked for.
  void reject_unknown() const;

 private:
  explicit TomlDocument(std::shared_ptr<detail::TomlSource> source) : source_(std::move(source)) {}
  std::shared_ptr<detail::TomlSource> source_;
};

}  // namespace volcal
