#include "volcal/identify/compensation/formats/isg_ssfk_lists.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::string_view kSsfkPrefix = "achskw", kSsfkEnd = ".lis";

std::string ssfk_file_name(AxisName axis) {
  return fmt::format("{}{}{}", kSsfkPrefix, direction_of(axis) + 1, kSsfkEnd);
}

bool is_ssfk_file(std::string_view name) { return name.starts_with(kSsfkPrefix) && name.ends_with(kSsfkEnd); }

/// As the control keeps it, a whole number of 32 bits.
long long tenths(double metres, AxisName axis) {
  const double value = std::round(metres / kSsfkUnit);
  if (!(std::abs(value) < std::numeric_limits<std::int32_t>::max()))
    throw InputError(
        {},
        fmt::format("{:.1f} m of axis {} is beyond what a number of 0.1 um holds", metres, letter_of(axis)),
        "write tables without leadscrew lists");
  return static_cast<long long>(value);
}

/// Values are actual minus set position: errors.
std::string ssfk_list(AxisName axis, const AxisTable& table) {
  const std::size_t count = table.position.size();
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(
      out,
      "# kopf.achs_nr: logical number of axis {1} on the control. lr_param.ssfk 1 switches it on.\n"
      "kopf.achs_nr {0}\nkopf.log_achs_name {1}\n"
      "kw.ssfk.interval 0\nkw.ssfk.kw_startpos {2}\nkw.ssfk.kw_nr_max {3}\n"
      "kw.ssfk.unit 1 /* 0.1 um */\nkw.ssfk.bilateral 1\nkw.ssfk.modulo 0\n",
      direction_of(axis) + 1, letter_of(axis), tenths(table.position.front(), axis), count);
  for (std::size_t i = 0; i < count; ++i)
    fmt::format_to(out, "kw.ssfk.table[{}].setpoint {}\n", i, tenths(table.position[i], axis));
  for (std::size_t i = 0; i < count; ++i)
    fmt::format_to(out, "kw.ssfk.table[{}].pos {}\n", i, tenths(-table.forward[i], axis));
  for (std::size_t i = 0; i < count; ++i)
    fmt::format_to(out, "kw.ssfk.table[{}].neg {}\n", i, tenths(-table.backward[i], axis));
  fmt::format_to(out, "End\n");
  return fmt::to_string(text);
}

/// One compensation list: KEY VALUE lines, comments behind # and between /* and */.
class SsfkReader {
 public:
  explicit SsfkReader(const TableFile& file) : lines_(file) {}

  std::pair<AxisName, AxisTable> read() {
    while (!ended_ && lines_.advance_to_content()) read_line(without_comments(lines_.current()));
    if (!ended_) lines_.fail("the list does not end in End", "write the tables again");
    return {axis(), table()};
  }

 private:
  std::string without_comments(std::string_view line) const {
    std::string text(line.substr(0, line.find('#')));
    for (auto open = text.find("/*"); open != std::string::npos; open = text.find("/*")) {
      const auto close = text.find("*/", open + 2);
      if (close == std::string::npos) lines_.fail("the comment does not end on its line", "close it with */");
      text.erase(open, close + 2 - open);
    }
    return text;
  }

  void read_line(const std::string& text) {
    const auto words = words_of(text);
    if (words.empty()) return;
    ended_ = words.size() == 1 && words[0] == "End";
    if (ended_) return;
    if (words.size() != 2) lines_.fail("the line is not KEY VALUE", "write a key and one value");
    constexpr std::string_view kTable = "kw.ssfk.table[";
    if (words[0].starts_with(kTable)) {
      read_entry(words[0].substr(kTable.size()), words[1]);
    } else if (!header_.emplace(words[0], words[1]).second) {
      lines_.fail(std::string(words[0].substr(0, 60)) + " is given twice", "delete one of the lines");
    }
  }

  /// `name`: "3].pos".
  void read_entry(std::string_view name, std::string_view value) {
    const auto close = name.find("].");
    if (close == std::string_view::npos) lines_.fail("the entry has no index", "write kw.ssfk.table[0].pos");
    const int index = lines_.integer(name.substr(0, close), "the index");
    if (index < 0 || index >= kMostSsfkEntries)
      lines_.fail(fmt::format("index {} is not among the {} entries of a table", index, kMostSsfkEntries),
                  "write fewer entries, counted from 0");
    const std::string_view column = name.substr(close + 2);
    if (column != "setpoint" && column != "pos" && column != "neg")
      lines_.fail(std::string(column.substr(0, 40)) + " is not a column of the table",
                  "entries have setpoint, pos and neg");
    const double metres = lines_.integer(value, "the value") * kSsfkUnit;
    if (!entries_[std::string(column)].emplace(index, metres).second)
      lines_.fail("the entry is given twice", "delete one of the lines");
  }

  int number(const std::string& key, std::optional<int> otherwise = {}) const {
    const auto found = header_.find(key);
    if (found != header_.end()) return lines_.integer(found->second, key);
    if (!otherwise) lines_.fail(key + " is missing", "write it, or write the tables again");
    return *otherwise;
  }

  AxisName axis() const {
    const auto name = header_.find("kopf.log_achs_name");
    if (name == header_.end()) lines_.fail("kopf.log_achs_name is missing", "name the axis, X, Y or Z");
    for (const AxisName axis : kLinearAxes) {
      if (name->second == std::string(1, letter_of(axis))) return axis;
    }
    lines_.fail("kopf.log_achs_name is \"" + name->second.substr(0, 20) + "\"", "tables are for X, Y and Z");
  }

  AxisTable table() const {
    if (number("kw.ssfk.unit") != 1)
      lines_.fail("kw.ssfk.unit is not 1", "positions and values are read in 0.1 um only");
    if (number("kw.ssfk.modulo", 0) != 0) lines_.fail("kw.ssfk.modulo is not 0", "linear axes do not turn");
    const int count = number("kw.ssfk.kw_nr_max");
    if (count < 2) lines_.fail("kw.ssfk.kw_nr_max is less than 2", "write the tables again");
    AxisTable table{.input = axis(), .position = {}, .forward = {}, .backward = {}};
    const bool bilateral = number("kw.ssfk.bilateral") == 1;
    for (int i = 0; i < count; ++i) {
      const double position = position_of(i);
      require_ascending(table.position, position, lines_.place());
      table.position.push_back(position);
      table.forward.push_back(-entry("pos", i));
      table.backward.push_back(-entry(bilateral ? "neg" : "pos", i));
    }
    return table;
  }

  double position_of(int index) const {
    const int interval = number("kw.ssfk.interval");
    if (interval == 0) return entry("setpoint", index);
    return (number("kw.ssfk.kw_startpos") + static_cast<double>(interval) * index) * kSsfkUnit;
  }

  double entry(const std::string& column, int index) const {
    const auto values = entries_.find(column);
    if (values != entries_.end()) {
      const auto found = values->second.find(index);
      if (found != values->second.end()) return found->second;
    }
    lines_.fail(fmt::format("kw.ssfk.table[{}].{} is missing", index, column),
                "kw.ssfk.kw_nr_max counts the entries; write every one");
  }

  TableLines lines_;
  bool ended_ = false;
  std::map<std::string, std::string> header_;
  std::map<std::string, std::map<int, double>> entries_;  ///< per column, by index, m
};

}  // namespace

TableFile ssfk_file(AxisName axis, const AxisTable& table) {
  return {ssfk_file_name(axis), ssfk_list(axis, table)};
}

std::vector<CorrectionTerm> ssfk_terms(std::span<const TableFile> files) {
  std::map<AxisName, AxisTable> tables;
  for (const TableFile& file : files) {
    if (!is_ssfk_file(file.name)) continue;
    auto [axis, table] = SsfkReader(file).read();
    if (!tables.emplace(axis, std::move(table)).second)
      throw InputError({file.name, 0}, fmt::format("axis {} has two lists", letter_of(axis)),
                       "keep one of the files");
  }
  std::vector<CorrectionTerm> terms;
  terms.reserve(tables.size());
  for (auto& [axis, table] : tables) terms.push_back(axis_term(axis, std::move(table)));
  return terms;
}

}  // namespace volcal
