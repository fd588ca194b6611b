#pragma once
/// What a computation noticed and somebody should know: a code with data. Plain data; the sentence of it is
/// made in identify/words, and files keep both.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace volcal {

enum class Severity {
  Note,     ///< nothing to mend
  Warning,  ///< to be looked at: a file, a setup or the model may be wrong
  Failure,  ///< the status of the result is not "ok" because of it
};
/// "note", "warning", "failure"
std::string_view to_string(Severity severity);

/// All codes: finding_codes.h. Apart, so that one more does not compile everything anew.
enum class FindingCode : std::uint8_t;
/// "rank.not-visible.axis-at-rest": as in files, for ever.
std::string_view to_string(FindingCode code);
std::optional<FindingCode> finding_code(std::string_view name);

/// A number in SI with the unit that people read it in.
struct FindingNumber {
  double si = 0.0;
  std::string unit = {};  ///< "mm", "um/m/K"; empty = a ratio
  double si_per_unit = 1.0;

  double in_unit() const { return si / si_per_unit; }
  bool operator==(const FindingNumber&) const = default;
};

using FindingValue = std::variant<bool, std::int64_t, FindingNumber, std::string, std::vector<std::string>,
                                  std::vector<std::int64_t>, std::vector<FindingNumber>>;

struct Finding {
  FindingCode code = {};                          ///< verbatim
  std::map<std::string, FindingValue> data = {};  ///< lists are not empty: an empty one is left out

  Severity severity() const;
  bool has(const std::string& key) const { return data.contains(key); }
  /// Values by key. Throws std::invalid_argument where there is none of this type; a flag or a list that is
  /// not there is false or empty.
  const std::string& text(const std::string& key) const;
  std::int64_t count(const std::string& key) const;
  const FindingNumber& number(const std::string& key) const;
  bool flag(const std::string& key) const;
  std::vector<std::string> texts(const std::string& key) const;
  std::vector<std::int64_t> counts(const std::string& key) const;
  std::vector<FindingNumber> numbers(const std::string& key) const;

  bool operator==(const Finding&) const = default;
};

/// A sentence that has no code.
Finding verbatim(std::string text);

}  // namespace volcal
