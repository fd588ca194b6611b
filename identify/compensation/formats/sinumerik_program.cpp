#include "volcal/identify/compensation/formats/sinumerik_program.h"

#include <cctype>
#include <cmath>
#include <set>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

std::vector<std::string> split_indices(std::string_view text) {
  std::vector<std::string> indices;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t stop = std::min(text.find(',', from), text.size());
    indices.emplace_back(trimmed_text(text.substr(from, stop - from)));
    from = stop + 1;
  }
  return indices;
}

/// (X1) and "X1" are X1.
std::string_view without_brackets(std::string_view value) {
  const auto enclosed = [&](char open, char close) {
    return value.size() >= 2 && value.front() == open && value.back() == close;
  };
  if (enclosed('(', ')') || enclosed('"', '"')) return value.substr(1, value.size() - 2);
  return value;
}

std::string_view without_block_number(std::string_view line) {
  if (line.size() < 2 || line[0] != 'N' || std::isdigit(static_cast<unsigned char>(line[1])) == 0)
    return line;
  const std::size_t stop = line.find_first_of(" \t");
  return stop == std::string_view::npos ? std::string_view{} : trimmed_text(line.substr(stop));
}

SinumerikAssignment assignment_in(const TableLines& lines, std::string_view line) {
  const auto open = line.find('['), close = line.find(']'), equals = line.find('=');
  const bool shaped = line.front() == '$' && open != std::string_view::npos &&
                      close != std::string_view::npos && equals != std::string_view::npos && open < close &&
                      close < equals;
  if (!shaped || !trimmed_text(line.substr(close + 1, equals - close - 1)).empty())
    lines.fail("the line is not an assignment", "write $NAME[index]=value");
  return {std::string(line.substr(0, open)), split_indices(line.substr(open + 1, close - open - 1)),
          std::string(without_brackets(trimmed_text(line.substr(equals + 1)))), lines.place()};
}

}  // namespace

std::vector<SinumerikAssignment> sinumerik_assignments(const TableFile& file, std::string_view header) {
  TableLines lines(file);
  if (!lines.advance_to_content() || trimmed_text(lines.current()) != header)
    lines.fail("the program does not begin with " + std::string(header), "write that line first");
  std::vector<SinumerikAssignment> assignments;
  std::set<std::pair<std::string, std::vector<std::string>>> seen;
  while (lines.advance_to_content()) {
    std::string_view line = lines.current();
    line = without_block_number(trimmed_text(line.substr(0, line.find(';'))));
    if (line.empty() || line == "CHANDATA(1)") continue;
    if (line == "M17") {
      if (assignments.empty()) lines.fail("the program assigns nothing", "write the tables again");
      return assignments;
    }
    assignments.push_back(assignment_in(lines, line));
    if (!seen.emplace(assignments.back().variable, assignments.back().indices).second)
      lines.fail("the variable is assigned a second time", "delete one of the lines");
  }
  lines.fail("the program does not end in M17", "was the file cut off? write the tables again");
}

double sinumerik_number(const SinumerikAssignment& assignment) {
  return csv_number({assignment.place, {assignment.value}}, 0, assignment.variable);
}

int sinumerik_index(const SinumerikAssignment& assignment, std::size_t index) {
  constexpr int kLargestIndex = 100000;
  const double value =
      index < assignment.indices.size()
          ? csv_number({assignment.place, {assignment.indices[index]}}, 0, assignment.variable + "[]")
          : -1.0;
  const int whole = value >= 0.0 && value <= kLargestIndex ? static_cast<int>(value) : -1;
  if (whole < 0 || value != whole)
    throw InputError(assignment.place, "an index of " + assignment.variable.substr(0, 40) + " is wrong",
                     "indices are whole numbers from 0");
  return whole;
}

std::string sinumerik_axis_name(char letter) { return std::string(1, letter) + "1"; }

AxisName sinumerik_axis(std::string_view name, const SourcePlace& place) {
  for (const AxisName axis : kAllAxes) {
    if (!is_parallel(axis) && name == sinumerik_axis_name(letter_of(axis))) return axis;
  }
  throw InputError(place, "the machine axis is \"" + std::string(name.substr(0, 40)) + "\"",
                   "write X1, Y1, Z1, A1, B1 or C1");
}

AxisName sinumerik_linear_axis(std::string_view name, const SourcePlace& place) {
  for (const AxisName axis : kLinearAxes) {
    if (name == sinumerik_axis_name(letter_of(axis))) return axis;
  }
  throw InputError(place, "the machine axis is \"" + std::string(name.substr(0, 40)) + "\"",
                   "write X1, Y1 or Z1");
}

std::vector<double> sinumerik_positions(const SinumerikValues& values) {
  if (!values.low || !values.high || !values.step)
    throw InputError(values.place, "STEP, MIN or MAX is missing", "every table needs them");
  const auto count = static_cast<double>(values.value.size());
  if (!(*values.step > 0.0) || count < 2 ||
      std::abs((*values.high - *values.low) / *values.step + 1.0 - count) > 1e-3 ||
      values.value.rbegin()->first + 1 != static_cast<int>(values.value.size()))
    throw InputError(values.place,
                     std::to_string(values.value.size()) + " values do not reach from MIN to MAX",
                     "there are (MAX - MIN) / STEP + 1 values, numbered from 0, STEP above 0");
  std::vector<double> positions;
  for (const auto& [index, value] : values.value) positions.push_back(*values.low + index * *values.step);
  return positions;
}

}  // namespace volcal
