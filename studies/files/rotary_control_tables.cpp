#include "volcal/studies/files/rotary_control_tables.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/studies/files/control_words.h"

namespace volcal {
namespace {

constexpr double kRotaryMicro = 1e-6;  // m of um, rad of urad
constexpr double kRotaryMillimetre = 1e-3;
constexpr double kRotaryDegree = std::numbers::pi / 180.0;

/// axis,position_deg,towards_plus_urad,towards_minus_urad,full_turn: what is added to the axis' own command.
void add_own_rotations(const TableFile& file, sim::ControlTables& tables) {
  std::map<AxisName, sim::ControlAxisTable> by_axis;
  const auto rows = lines_of_words(file.content, ",");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const AxisName axis = axis_in(rows[i].at(0));
    sim::ControlAxisTable& table = by_axis[axis];
    table.input = table.output = axis;
    table.position.push_back(std::stod(rows[i].at(1)) * kRotaryDegree);
    table.towards_plus.push_back(std::stod(rows[i].at(2)) * kRotaryMicro);
    table.towards_minus.push_back(std::stod(rows[i].at(3)) * kRotaryMicro);
    if (rows[i].at(4) == "1") table.period = 2.0 * std::numbers::pi;
  }
  for (auto& [axis, table] : by_axis) tables.axis_tables.push_back(std::move(table));
}

/// Key and value of a line "# key = value"; an empty key otherwise.
std::pair<std::string, Words> key_of(const Words& line) {
  if (line.size() < 3 || line[0] != "#") return {};
  const auto equals = std::find(line.begin(), line.end(), "=");
  if (equals != line.begin() + 2) return {};
  return {line[1], Words(equals + 1, line.end())};
}

/// Ascending values of one column, each once.
std::vector<double> nodes_of_column(const std::vector<Words>& rows, std::size_t column) {
  std::vector<double> nodes;
  for (const Words& row : rows) nodes.push_back(std::stod(row.at(column)) * kRotaryDegree);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

sim::ControlTwistGrid twist_grid(const TableFile& file, const TableMetadata& metadata) {
  sim::ControlTwistGrid grid;
  grid.machine = metadata.machine;
  grid.tool = metadata.tool_offset();
  std::map<std::string, Words> keys;
  for (const Words& line : lines_of_words(file.content, " \t")) {
    auto [key, value] = key_of(line);
    if (!key.empty()) keys[key] = std::move(value);
  }
  grid.of_table = keys.at("body").at(0) == "table";
  for (std::size_t k = 0; k < 3; ++k)
    grid.reference[static_cast<Eigen::Index>(k)] =
        std::stod(keys.at("reference_point_mm").at(k)) * kRotaryMillimetre;
  std::vector<Words> rows;
  for (Words& row : lines_of_words(file.content, ",")) {
    if (row[0].front() != '#' && row[0].find("_deg") == std::string::npos) rows.push_back(std::move(row));
  }
  for (const std::string& letter : keys.at("axes")) {
    grid.full_turn.push_back(keys.at("beyond_ends." + letter).at(0) == "modulo");
    grid.nodes.push_back(nodes_of_column(rows, grid.axes.size()));
    grid.axes.push_back(axis_in(letter));
  }
  for (const Words& row : rows) {
    Eigen::Matrix<double, 6, 1>& twist = grid.twist.emplace_back();
    for (std::size_t k = 0; k < 6; ++k)
      twist[static_cast<Eigen::Index>(k)] = std::stod(row.at(grid.axes.size() + k)) * kRotaryMicro;
  }
  return grid;
}

}  // namespace

void add_neutral_rotary_tables(std::span<const TableFile> files, sim::ControlTables& tables) {
  if (const TableFile* file = find_file(files, "rotary_axis_corrections.csv"))
    add_own_rotations(*file, tables);
  for (const char* name : {"rotary_compensation_grid_table.csv", "rotary_compensation_grid_tool.csv"}) {
    if (const TableFile* file = find_file(files, name))
      tables.twist_grids.push_back(twist_grid(*file, read_table_metadata(file_named(files, "metadata.csv"))));
  }
}

namespace {

/// Lines of volcal.rotary, in turn.
class KinsLines {
 public:
  explicit KinsLines(const std::string& text) {
    for (Words& line : lines_of_words(text, " \t")) {
      if (line[0].front() != '#') lines_.push_back(std::move(line));
    }
  }
  bool at_end() const { return next_ == lines_.size(); }
  const Words& take() { return lines_.at(next_++); }

 private:
  std::vector<Words> lines_;
  std::size_t next_ = 0;
};

Eigen::Vector3d kins_point_in(const Words& line, std::size_t first, double unit) {
  return unit * Eigen::Vector3d(std::stod(line.at(first)), std::stod(line.at(first + 1)),
                                std::stod(line.at(first + 2)));
}

void take_kins_chain(const Words& line, Machine& machine) {
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (line[i] == "b") continue;
    machine.structure.joints.push_back({axis_in(line[i]), line[i].ends_with("'")});
    machine.axes.emplace_back().name = axis_in(line[i]);
  }
}

sim::ControlAxisTable kins_own_table(const Words& head, KinsLines& lines) {
  sim::ControlAxisTable table;
  table.input = table.output = axis_in(head.at(1));
  if (head.at(3) == "1") table.period = 2.0 * std::numbers::pi;
  for (int row = std::stoi(head.at(2)); row > 0; --row) {
    const Words& line = lines.take();
    table.position.push_back(std::stod(line.at(0)) * kRotaryDegree);
    table.towards_plus.push_back(std::stod(line.at(1)) * kRotaryDegree);
    table.towards_minus.push_back(std::stod(line.at(2)) * kRotaryDegree);
  }
  return table;
}

sim::ControlTwistGrid kins_twist_grid(const Words& head, KinsLines& lines, double unit) {
  sim::ControlTwistGrid grid;
  grid.of_table = head.at(1) == "table";
  int rows = 1;
  for (std::size_t i = 2; i < head.size(); i += 3) {
    grid.axes.push_back(axis_in(head[i]));
    rows *= std::stoi(head.at(i + 1));
    grid.full_turn.push_back(head.at(i + 2) == "1");
  }
  grid.reference = kins_point_in(lines.take(), 0, unit);
  std::vector<Words> taken;
  for (; rows > 0; --rows) {
    taken.push_back(lines.take());
    Eigen::Matrix<double, 6, 1>& twist = grid.twist.emplace_back();
    twist.head<3>() = kins_point_in(taken.back(), grid.axes.size(), unit);
    twist.tail<3>() = kins_point_in(taken.back(), grid.axes.size() + 3, 1.0);
  }
  for (std::size_t a = 0; a < grid.axes.size(); ++a) grid.nodes.push_back(nodes_of_column(taken, a));
  return grid;
}

}  // namespace

void add_kins_rotary_tables(const TableFile& file, sim::ControlTables& tables) {
  constexpr double kRotaryInch = 25.4e-3;
  KinsLines lines(file.content);
  const double unit = lines.take().at(1) == "inch" ? kRotaryInch : kRotaryMillimetre;
  Machine machine;
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  std::vector<sim::ControlTwistGrid> grids;
  while (!lines.at_end()) {
    const Words& line = lines.take();
    if (line[0] == "chain") take_kins_chain(line, machine);
    if (line[0] == "tool") tool = kins_point_in(line, 1, unit);
    if (line[0] == "own") tables.axis_tables.push_back(kins_own_table(line, lines));
    if (line[0] == "twists") grids.push_back(kins_twist_grid(line, lines, unit));
    for (Axis& axis : machine.axes) {
      if (line[0] == "centre" && axis.name == axis_in(line.at(1))) axis.centre = kins_point_in(line, 2, unit);
    }
  }
  for (sim::ControlTwistGrid& grid : grids) {
    grid.machine = machine;
    grid.tool = tool;
    tables.twist_grids.push_back(std::move(grid));
  }
}

void add_trt_pivots(const TableFile& file, sim::ControlTables& tables) {
  constexpr double kPivotInch = 25.4e-3;
  double unit = kRotaryMillimetre;
  sim::ControlPivotChange change;
  const auto in = [&](const Words& line, std::size_t i) { return std::stod(line.at(i)) * unit; };
  for (const Words& line : lines_of_words(file.content, " \t")) {
    if (line[0] == "#" && line.size() == 4 && line[2] == "units") {
      change.drawn.tilt = line[1] == "xyzbc-trt-kins" ? AxisName::B : AxisName::A;
      unit = line[3] == "inch" ? kPivotInch : kRotaryMillimetre;
    } else if (line[0] == "#" && line.at(1) == "nominal") {
      change.drawn.rot_point = {in(line, 2), in(line, 3), in(line, 4)};
      change.drawn.across_offset = in(line, 5);
      change.drawn.z_offset = in(line, 6);
    } else if (line[0] == "#" && line.size() == 6 && line[1] == "table") {
      change.work_moved = {in(line, 3), in(line, 4), in(line, 5)};
    } else if (line[0] == "#" && line.size() == 4 && line[1] == "tool") {
      change.tool_length = in(line, 3);
    } else if (line[0] == "setp") {
      const std::string pin = line.at(1).substr(line[1].find('.') + 1);
      if (pin == "x-rot-point") change.loaded.rot_point.x() = in(line, 2);
      if (pin == "y-rot-point") change.loaded.rot_point.y() = in(line, 2);
      if (pin == "z-rot-point") change.loaded.rot_point.z() = in(line, 2);
      if (pin == "x-offset" || pin == "y-offset") change.loaded.across_offset = in(line, 2);
      if (pin == "z-offset") change.loaded.z_offset = in(line, 2);
    }
  }
  change.loaded.tilt = change.drawn.tilt;
  tables.pivots.push_back(change);
}

IsgChainControl::IsgChainControl(const std::string& list, const std::string& file) {
  std::string chain;
  std::size_t on_workpiece_side = 0;
  for (const Words& line : lines_of_words(list, " \t")) {
    if (line[0] == "chain") chain = line.at(1);
    if (line[0] == "workpiece_axes") on_workpiece_side = static_cast<std::size_t>(std::stoi(line.at(1)));
  }
  signs_.fill(1.0);
  const bool of_the_axes = file.find("error motions of the axes themselves") != std::string::npos;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const AxisName axis = axis_in(chain.substr(i, 1));
    model_.machine.structure.joints.push_back({axis, i < on_workpiece_side});
    model_.machine.axes.emplace_back().name = axis;
    if (of_the_axes && i < on_workpiece_side) signs_.at(index_of(axis)) = -1.0;
  }
  model_.meaning = sim::TableValue::Error;
  model_.rotary = sim::RotaryModel::MovesLinearAxes;
}

bool IsgChainControl::opens(const Words& header) {
  const bool argument = header[0].size() == 1;
  const bool mine = argument ? is_rotary(axis_in(header[0])) : header[0][0] != 'E';
  if (mine) header_ = header;
  return mine;
}

void IsgChainControl::add_row(const Words& row) {
  for (std::size_t i = 0; i < header_.size(); ++i) {
    const std::string& name = header_[i];
    const double value = std::stod(row.at(i));
    if (name.size() == 1) continue;
    const AxisName axis = axis_in(name.substr(2));
    if (name.starts_with("P0")) {
      model_.tool[direction_of(axis)] = value * kRotaryMillimetre;
    } else if (name[0] == 'P') {
      for (Axis& described : model_.machine.axes) {
        if (described.name == axis)
          described.centre[direction_of(axis_in(name.substr(1, 1)))] = value * kRotaryMillimetre;
      }
    } else if (name[1] == '0') {
      const AxisName of = axis_in(name);
      const Component component = kAllComponents.at(index_of(of));
      model_.locations[{component, axis}] = value * (is_rotary(of) ? 1.0 : kRotaryMillimetre);
    } else {
      const ErrorSymbol symbol = ErrorSymbol::parse(name).value();
      sim::ControlAxisTable& table = model_.motions[symbol];
      const double si = signs_.at(index_of(axis)) * (is_rotation(symbol.component) ? 1.0 : kRotaryMillimetre);
      table.input = axis;
      table.position.push_back(std::stod(row.at(0)) * kRotaryDegree);
      table.towards_plus.push_back(si * value);
      table.towards_minus.push_back(si * value);
    }
  }
}

void IsgChainControl::move_to(sim::ControlTables& tables) {
  if (model_.motions.empty() && model_.locations.empty()) return;
  for (auto& [symbol, table] : model_.motions) {
    const double length = table.position.back() - table.position.front();
    if (std::abs(length - 2.0 * std::numbers::pi) < 1e-9) table.period = 2.0 * std::numbers::pi;
  }
  tables.models.push_back(std::move(model_));
}

}  // namespace volcal
