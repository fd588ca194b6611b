#include "volcal/studies/files/typed_control_tables.h"

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "volcal/studies/files/control_words.h"

namespace volcal {
namespace {

constexpr const char* kBlanks = " \t";
constexpr double kTypedMillimetre = 1e-3, kTypedMicrometre = 1e-6, kTypedTenth = 1e-7;  // m
constexpr double kTypedDegree = std::numbers::pi / 180.0;

/// Rows of one .COM: what the position of `cause` does to the axes of the columns.
void add_com_rows(const std::string& text, AxisName cause, sim::ControlTables& tables) {
  const double unit = is_rotary(cause) ? kTypedDegree : kTypedMillimetre;
  const bool errors = text.find("VALUES ARE ERRORS") != std::string::npos;
  double datum = 0.0, spacing = 0.0;
  std::vector<sim::ControlAxisTable> columns;
  for (const auto& words : lines_of_words(text, kBlanks)) {
    if (words[0] == ";") continue;
    if (words[0] == "DATUM") {
      datum = std::stod(words.at(1)) * unit;
    } else if (words[0] == "SPACING") {
      spacing = kTypedTenth * std::pow(2.0, std::stoi(words.at(1)));
    } else if (columns.empty()) {
      for (std::size_t i = 1; i < words.size(); ++i) {
        columns.emplace_back();
        columns.back().input = cause;
        columns.back().output = axis_in(words[i]);
        columns.back().meaning = errors ? sim::TableValue::Error : sim::TableValue::Correction;
      }
    } else {
      const double first = std::stod(words.at(0));
      for (std::size_t i = 0; i < columns.size(); ++i) {
        const double value = std::stod(words.at(i + 1)) * unit;
        columns[i].position.push_back(spacing > 0.0 ? datum + first * spacing : first * unit);
        columns[i].towards_plus.push_back(value);
        columns[i].towards_minus.push_back(value);
      }
    }
  }
  for (sim::ControlAxisTable& column : columns) {
    const bool turn =
        column.position.size() > 1 &&
        std::abs(column.position.back() - column.position.front() - 360.0 * kTypedDegree) < 1e-9;
    if (is_rotary(cause) && turn) column.period = 360.0 * kTypedDegree;
  }
  tables.axis_tables.insert(tables.axis_tables.end(), columns.begin(), columns.end());
}

/// Parameters of an axis by their numbers, and the values of all points.
struct TypedPitch {
  std::map<char, std::map<std::string, double>> parameters;
  std::map<int, int> values;
  std::map<std::string, std::string> head;
};

TypedPitch typed_pitch(const std::string& text) {
  TypedPitch pitch;
  bool points = false;
  for (const auto& words : lines_of_words(text, kBlanks)) {
    if (words[0] == ";" || words[0] == "PARAMETER") continue;
    if (words[0] == "NUMBER") {
      points = true;
    } else if (points) {
      pitch.values[std::stoi(words.at(0))] = std::stoi(words.at(1));
    } else if (words.size() == 3) {
      pitch.parameters[words[1].at(0)][words[0]] = std::stod(words[2]);
    } else {
      pitch.head[words[0]] = words.at(1);
    }
  }
  return pitch;
}

/// Detection units at every point from the one before `lowest`, walked away from the reference position: up
/// it adds the value of the point that it comes to, down it takes off that of the point that it leaves.
std::map<int, double> walked_amounts(const TypedPitch& pitch, int lowest, int highest, int reference,
                                     double magnification) {
  std::map<int, double> amounts = {{reference, 0.0}};
  for (int point = reference + 1; point <= highest; ++point)
    amounts[point] = amounts.at(point - 1) + magnification * pitch.values.at(point);
  for (int point = reference; point >= lowest; --point)
    amounts[point - 1] = amounts.at(point) - magnification * pitch.values.at(point);
  return amounts;
}

struct TypedAmounts {
  std::vector<double> position, plus, minus;
};

TypedAmounts amounts_of_axis(const TypedPitch& pitch, const std::map<std::string, double>& parameter,
                             bool rotary) {
  const auto whole = [&](const char* key) { return static_cast<int>(parameter.at(key)); };
  const int lowest = whole("3621"), highest = whole("3622"), reference = whole("3620");
  const double length = rotary ? kTypedDegree : kTypedMillimetre;
  const double magnification = parameter.at("3623"), interval = parameter.at("3624") * length;
  const double home = parameter.at("REFERENCE") * length;
  const double unit = rotary ? std::stod(pitch.head.at("DETECTION_UNIT_DEG")) * kTypedDegree
                             : std::stod(pitch.head.at("DETECTION_UNIT_UM")) * kTypedMicrometre;
  const bool both = whole("3605#0") == 1;
  const auto plus = walked_amounts(pitch, lowest, highest, reference, magnification);
  const int shift = both ? whole("3626") - lowest : 0;
  const auto minus = walked_amounts(pitch, lowest + shift, highest + shift, reference + shift, magnification);
  const double other = both ? parameter.at("3627") : 0.0;
  const bool negative = !both || pitch.head.at("REFERENCE_AMOUNT") == "NEGATIVE";
  TypedAmounts amounts;
  for (const auto& [point, amount] : plus) {
    amounts.position.push_back(home + (point - reference) * interval);
    amounts.plus.push_back(unit * (amount + (negative ? 0.0 : other)));
    amounts.minus.push_back(unit * (minus.at(point + shift) + (negative ? other : 0.0)));
  }
  return amounts;
}

/// Every amount as a flat piece from half an interval before its point to half an interval behind it.
TypedAmounts in_the_middle(const TypedAmounts& points) {
  constexpr double kEdge = 1e-9;  // m, over which a step is taken
  TypedAmounts flat;
  for (std::size_t i = 0; i < points.position.size(); ++i) {
    const double before = i == 0 ? points.position[0] : 0.5 * (points.position[i - 1] + points.position[i]);
    const double behind = i + 1 == points.position.size()
                              ? points.position[i]
                              : 0.5 * (points.position[i] + points.position[i + 1]);
    for (const double position : {before + kEdge, behind - kEdge}) {
      flat.position.push_back(position);
      flat.plus.push_back(points.plus[i]);
      flat.minus.push_back(points.minus[i]);
    }
  }
  return flat;
}

/// One turn up to the last point; what lies before it belongs to the turn before.
void turn_round(sim::ControlAxisTable& table, double turn) {
  std::size_t outside = 0;
  while (table.position.at(outside) < table.position.back() - turn - 1e-9) ++outside;
  for (auto* const column : {&table.position, &table.towards_plus, &table.towards_minus})
    column->erase(column->begin(), column->begin() + static_cast<std::ptrdiff_t>(outside));
  table.period = turn;
}

/// The axis stands farther by the shift everywhere.
sim::ControlAxisTable shifted_reference(const sim::ControlAxisTable& axis,
                                        const std::map<std::string, double>& parameter) {
  sim::ControlAxisTable shift;
  shift.input = axis.input;
  shift.output = axis.output;
  shift.position = {0.0};
  shift.towards_plus = shift.towards_minus = {parameter.at("SHIFT") * kTypedDegree};
  return shift;
}

}  // namespace

// TNC 407 Technical Manual, 4-27 and 4-28; MANUALplus 620 Technical Manual, 716 to 718: the axis of a column
// of the .COM is a function of the axis of the column of the .CMA that names it.
sim::ControlTables heidenhain_control(std::span<const TableFile> files) {
  const auto assignment = lines_of_words(file_named(files, "CONFIG.CMA.txt").content, kBlanks);
  sim::ControlTables tables;
  for (const auto& row : assignment) {
    if (row[0] != "*") continue;
    for (std::size_t i = 1; i < row.size(); ++i)
      add_com_rows(file_named(files, row[i] + ".txt").content, axis_in(assignment.at(0).at(i)), tables);
  }
  return tables;
}

// Series 0i-PB Parameter Manual, 3620 to 3624; Technical Report A-77810E, 3605#0, 3626, 3627.
sim::ControlTables fanuc_control(std::span<const TableFile> files) {
  const TypedPitch pitch = typed_pitch(file_named(files, "pitch_error.txt").content);
  sim::ControlTables tables;
  for (const auto& [letter, parameter] : pitch.parameters) {
    const bool rotary = letter == 'A' || letter == 'B' || letter == 'C';
    TypedAmounts amounts = amounts_of_axis(pitch, parameter, rotary);
    if (pitch.head.at("OUTPUT") == "MIDDLE") amounts = in_the_middle(amounts);
    sim::ControlAxisTable table;
    table.input = table.output = axis_in(std::string(1, letter));
    table.meaning =
        pitch.head.at("VALUES") == "ERRORS" ? sim::TableValue::Error : sim::TableValue::Correction;
    table.position = amounts.position;
    table.towards_plus = amounts.plus;
    table.towards_minus = amounts.minus;
    if (parameter.contains("3625")) turn_round(table, parameter.at("3625") * kTypedDegree);
    tables.axis_tables.push_back(table);
    if (parameter.contains("SHIFT")) tables.axis_tables.push_back(shifted_reference(table, parameter));
  }
  return tables;
}

}  // namespace volcal
