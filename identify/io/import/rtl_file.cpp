#include "volcal/identify/io/import/rtl_file.h"

#include <algorithm>
#include <optional>

#include "volcal/identify/io/import/import_lines.h"
#include "volcal/identify/text/text_file.h"

namespace volcal {
namespace {

/// Name of a section that a line begins, in upper case; empty for other lines.
std::string rtl_section(std::string_view line) {
  if (!line.ends_with("::")) return "";
  std::string name(without_blanks(line.substr(0, line.size() - 2)));
  if (name.find(':') != std::string::npos) return "";
  std::ranges::transform(name, name.begin(),
                         [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return name;
}

class RtlParser {
 public:
  explicit RtlParser(const ImportSource& source) : file_(source.path), decimal_(source.decimal) {}

  LaserFile parse(const std::string& text) {
    for (const TextLine& line : lines_with_text(text)) read(line);
    laser_.decimal_comma = decimal_.value_or(signs_.decimal(file_)) == ',';
    check_targets();
    make_passes();
    return std::move(laser_);
  }

 private:
  void read(const TextLine& line) {
    if (section_ == "EOF") {
      if (line.text != "\x1A") fail(line.number, "text behind EOF::", "is it two files in one? cut it there");
      return;
    }
    if (const std::string section = rtl_section(line.text); !section.empty()) {
      section_ = section;
      in_targets_ = false;
      return;
    }
    if (section_.empty())
      fail(line.number, "the file does not begin with a section, as HEADER::", "export it as .rtl again");
    if (section_ == "DEVIATIONS") return read_deviation(line);
    if (in_targets_ && read_targets(line.text, line.number)) return;
    in_targets_ = false;
    read_entry(line);
  }

  void read_entry(const TextLine& line) {
    const std::size_t colon = line.text.find(':');
    const bool keyed = colon != std::string_view::npos;
    const std::string_view key = keyed ? without_blanks(line.text.substr(0, colon)) : std::string_view();
    const std::string_view value = keyed ? without_blanks(line.text.substr(colon + 1)) : line.text;
    const std::string name = lower_case(key);
    if (name == "target-count") return read_count(value, line.number, target_count_, target_count_line_);
    if (name == "run-count") return read_count(value, line.number, run_count_, run_count_line_);
    if (name == "targets") return begin_targets(value, line.number);
    if (!keyed && (section_ == "TARGET DATA" || section_ == "RUNS"))
      fail_not_understood(line, "a line \"key : value\" or target positions in mm are expected");
    laser_.entries.push_back({section_, std::string(key), std::string(value), line.number});
  }

  void read_count(std::string_view value, int line, std::optional<int>& count, int& count_line) const {
    if (count) fail(line, "the count is given twice", "remove one of the two");
    count = whole_number(value);
    count_line = line;
    if (!count)
      fail(line, "the count \"" + printable(std::string(value)) + "\" is not a whole number", "repair it");
  }

  void begin_targets(std::string_view value, int line) {
    if (targets_line_ > 0) fail(line, "the targets are given twice", "remove one of the two");
    targets_line_ = line;
    in_targets_ = true;
    if (!value.empty() && !read_targets(value, line))
      fail(line, "the targets \"" + printable(std::string(value)) + "\" are not numbers", "positions in mm");
  }

  /// False, and nothing is read, for a line that is none of positions.
  bool read_targets(std::string_view text, int line) {
    if (text.find(':') != std::string_view::npos) return false;
    for (const std::string_view word : words_between_blanks(text)) {
      const auto value = number(word, line);
      if (!value)
        fail(line, "the target \"" + printable(std::string(word)) + "\" is not a number", "positions in mm");
      laser_.targets_mm.push_back(*value);
    }
    return true;
  }

  void read_deviation(const TextLine& line) {
    const auto words = words_between_blanks(line.text);
    if (line.text.ends_with(':') && readings_.empty()) return;  // the heading "Run Target Data:"
    if (words.size() != 3) fail_not_understood(line, "a row is run, target and deviation");
    const auto run = whole_number(words[0]), target = whole_number(words[1]);
    const auto value = number(words[2], line.number);
    if (!run || !target || !value) fail_not_understood(line, "a row is run, target and deviation");
    readings_.push_back({*run, *target, *value, line.number});
  }

  std::optional<double> number(std::string_view word, int line) {
    if (decimal_) return grouped_number(word, *decimal_);
    signs_.add(word, line);
    return foreign_number(word);
  }

  void check_targets() const {
    const auto& targets = laser_.targets_mm;
    if (targets.size() < 2)
      fail(targets_line_, "the file has " + std::string(targets.empty() ? "no targets" : "one target"),
           "two positions at least must stand below \"Targets :\"");
    if (target_count_ && *target_count_ != static_cast<int>(targets.size()))
      fail(target_count_line_,
           "Target-count is " + std::to_string(*target_count_) + ", but " + std::to_string(targets.size()) +
               " targets follow",
           "was the file cut off? export it again");
    const bool up = targets[1] > targets[0];
    for (std::size_t i = 1; i < targets.size(); ++i) {
      if (up ? targets[i] > targets[i - 1] : targets[i] < targets[i - 1]) continue;
      fail(targets_line_,
           "target " + std::to_string(i + 1) + ", " + number_text(targets[i]) +
               " mm, does not continue the line of targets",
           "targets rise or fall from the first to the last");
    }
  }

  void make_passes() {
    if (readings_.empty())
      fail(0, "the file has no deviations", "rows of run, target and deviation stand in DEVIATIONS::");
    std::vector<int> seen;
    for (std::size_t from = 0; from < readings_.size();) {
      std::size_t to = from;
      while (to < readings_.size() && readings_[to].run == readings_[from].run) ++to;
      const int run = readings_[from].run;
      if (run != static_cast<int>(seen.size()) + 1)
        fail(readings_[from].line,
             "run " + std::to_string(run) + " follows run " + std::to_string(seen.size()),
             "runs are numbered 1, 2, 3 ... and stand one behind the other");
      seen.push_back(run);
      make_passes_of_run(from, to);
      from = to;
    }
    if (run_count_ && *run_count_ != static_cast<int>(seen.size()))
      fail(run_count_line_,
           "Run-count is " + std::to_string(*run_count_) + ", but DEVIATIONS holds " +
               std::to_string(seen.size()) + " runs",
           "was the file cut off? export it again");
  }

  void make_passes_of_run(std::size_t from, std::size_t to) {
    const std::size_t targets = laser_.targets_mm.size();
    for (std::size_t start = from; start < to; start += targets) {
      if (to - start < targets) {
        check_order(start, to);
        fail(readings_[to - 1].line,
             "run " + std::to_string(readings_[start].run) + " ends after " + std::to_string(to - start) +
                 " of " + std::to_string(targets) + " targets",
             "was the file cut off? every run has one deviation for each target");
      }
      const bool ascending = check_order(start, start + targets);
      const auto begin = readings_.begin() + static_cast<std::ptrdiff_t>(start);
      laser_.passes.push_back(
          {readings_[start].run, ascending, {begin, begin + static_cast<std::ptrdiff_t>(targets)}});
    }
  }

  /// Whether rows go from the first target on or from the last one back; throws where they do neither.
  bool check_order(std::size_t start, std::size_t stop) const {
    const int last = static_cast<int>(laser_.targets_mm.size());
    const int first = readings_[start].target;
    const bool ascending = first == 1;
    for (std::size_t i = start; i < stop; ++i) {
      const int offset = static_cast<int>(i - start);
      if (readings_[i].target == (ascending ? 1 + offset : last - offset)) continue;
      fail(readings_[i].line,
           "target " + std::to_string(readings_[i].target) + " stands where target " +
               std::to_string(ascending ? 1 + offset : last - offset) + " of run " +
               std::to_string(readings_[i].run) + " is expected",
           "a run goes over targets 1 to " + std::to_string(last) + ", or back, without a gap");
    }
    return ascending;
  }

  [[noreturn]] void fail_not_understood(const TextLine& line, const std::string& expected) const {
    fail(line.number, "\"" + printable(std::string(line.text)) + "\" in " + section_ + " is not understood",
         expected);
  }
  [[noreturn]] void fail(int line, const std::string& problem, const std::string& remedy) const {
    throw InputError({file_, line}, problem, remedy);
  }

  const std::string& file_;
  std::optional<char> decimal_;
  SeenSigns signs_;
  std::string section_;
  bool in_targets_ = false;
  int targets_line_ = 0;
  std::optional<int> target_count_, run_count_;
  int target_count_line_ = 0, run_count_line_ = 0;
  std::vector<LaserDeviation> readings_;
  LaserFile laser_;
};

}  // namespace

const LaserEntry* LaserFile::find(const std::vector<std::string>& keys) const {
  for (const LaserEntry& entry : entries) {
    if (!entry.value.empty() && std::ranges::find(keys, lower_case(entry.key)) != keys.end()) return &entry;
  }
  return nullptr;
}

LaserFile parse_rtl(const ImportSource& source) { return RtlParser(source).parse(source.text); }

}  // namespace volcal
