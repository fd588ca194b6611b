#include "volcal/studies/files/control_tables.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <numbers>
#include <set>
#include <sstream>

#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/compensation/measurement_record.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/studies/files/control_words.h"
#include "volcal/studies/files/rotary_control_tables.h"
#include "volcal/studies/files/skew_control_tables.h"
#include "volcal/studies/files/typed_control_tables.h"

namespace volcal {
namespace {

constexpr double kMillimetre = 1e-3, kInch = 25.4e-3, kMicrometre = 1e-6;  // m; also rad of a microradian
constexpr double kDegree = std::numbers::pi / 180.0;

const std::string& content_of(std::span<const TableFile> files, const std::string& name) {
  return file_named(files, name).content;
}

/// Tables of one input and one output axis in one row per position: appended in the order of the file.
class AxisTables {
 public:
  explicit AxisTables(sim::TableValue meaning) : meaning_(meaning) {}
  void add(AxisName input, AxisName output, double position, double plus, double minus) {
    sim::ControlAxisTable& table = tables_[{input, output}];
    table.input = input;
    table.output = output;
    table.meaning = meaning_;
    table.position.push_back(position);
    table.towards_plus.push_back(plus);
    table.towards_minus.push_back(minus);
  }
  void move_to(sim::ControlTables& tables) {
    for (auto& [axes, table] : tables_) tables.axis_tables.push_back(std::move(table));
    tables_.clear();
  }

 private:
  sim::TableValue meaning_;
  std::map<std::pair<AxisName, AxisName>, sim::ControlAxisTable> tables_;
};

/// Rows of a grid, X slowest and Z fastest; `columns` of the row give the position.
void add_node(sim::ControlGrid& grid, const std::array<double, 3>& position) {
  for (std::size_t i = 0; i < 3; ++i) {
    auto& nodes = grid.nodes[i];
    if (std::ranges::find(nodes, position[i]) == nodes.end()) nodes.push_back(position[i]);
  }
}

Eigen::Vector3d vector_in(const Words& row, std::size_t first, double unit) {
  return unit * Eigen::Vector3d(std::stod(row.at(first)), std::stod(row.at(first + 1)),
                                std::stod(row.at(first + 2)));
}

std::array<double, 3> position_in(const Words& row, double unit) {
  return {unit * std::stod(row.at(0)), unit * std::stod(row.at(1)), unit * std::stod(row.at(2))};
}

/// Position, mean of both directions, then for X, Y and Z the reversal, or `share` of it.
void add_grid_row(sim::ControlGrid& grid, const Words& row, double position_unit, double unit, double share) {
  add_node(grid, position_in(row, position_unit));
  grid.mean.push_back(vector_in(row, 3, unit));
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.reversal[axis].emplace_back(vector_in(row, 6 + 3 * axis, unit) / share);
}

// compensation_tables.csv holds what is to be added, with its own kinematics and the tool of metadata.csv.
sim::ControlTables csv_control(std::span<const TableFile> files) {
  const TableMetadata metadata = read_table_metadata(file_named(files, "metadata.csv"));
  const bool rotary = !metadata.type.rotary().empty();
  sim::ControlModel model{metadata.machine, {}, sim::TableValue::Correction, {}, {}};
  if (rotary) model.rotary = sim::RotaryModel::TurnsTheAxes;
  model.tool = metadata.tool_offset();
  std::istringstream text(content_of(files, "compensation_tables.csv"));
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    Words cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    const double value = std::stod(cells.at(5)) * kMicrometre;
    if (const auto location = LocationSymbol::parse(cells.at(0))) {
      if (is_rotary(location->axis) && !rotary) continue;
      const auto squareness = squareness_errors(metadata.machine);
      const bool known =
          is_rotary(location->axis) || std::ranges::find(squareness, *location) != squareness.end();
      if (!known || !metadata.machine.has_axis(location->axis))
        throw InputError({"compensation_tables.csv", 0},
                         location->name() + " is not a squareness of the datum in metadata.csv",
                         "take metadata.csv of the same run");
      model.locations[*location] = value;
      continue;
    }
    const ErrorSymbol symbol = *ErrorSymbol::parse(cells.at(0));
    if (is_rotary(symbol.axis) && !rotary) continue;
    sim::ControlAxisTable& table = model.motions[symbol];
    table.input = symbol.axis;
    const int direction = std::stoi(cells.at(4));
    if (direction >= 0) {
      table.position.push_back(std::stod(cells.at(2)) * (is_rotary(symbol.axis) ? kDegree : kMillimetre));
      table.towards_plus.push_back(value);
    }
    if (direction <= 0) table.towards_minus.push_back(value);
  }
  sim::ControlTables tables;
  tables.models.push_back(std::move(model));
  return tables;
}

// Corrections to add; the grid has the whole reversal.
sim::ControlTables neutral_control(std::span<const TableFile> files) {
  sim::ControlTables tables;
  if (const TableFile* file = find_file(files, "axis_corrections.csv")) {
    AxisTables axes(sim::TableValue::Correction);
    const auto rows = lines_of_words(file->content, ",");
    for (std::size_t i = 1; i < rows.size(); ++i)
      axes.add(axis_in(rows[i].at(0)), axis_in(rows[i].at(1)), std::stod(rows[i].at(2)) * kMillimetre,
               std::stod(rows[i].at(3)) * kMicrometre, std::stod(rows[i].at(4)) * kMicrometre);
    axes.move_to(tables);
  }
  if (const TableFile* file = find_file(files, "correction_grid.csv")) {
    sim::ControlGrid grid;
    const auto rows = lines_of_words(file->content, ",");
    for (std::size_t i = 1; i < rows.size(); ++i) add_grid_row(grid, rows[i], kMillimetre, kMicrometre, 1.0);
    tables.grids.push_back(std::move(grid));
  }
  add_neutral_rotary_tables(files, tables);
  return tables;
}

// COMP_FILE_TYPE 1: trims are added; 0: actual positions, the trim is nominal minus actual.
sim::ControlTables linuxcnc_control(std::span<const TableFile> files) {
  AxisTables axes(sim::TableValue::Correction);
  double unit = kMillimetre;
  std::string coordinates = "XYZ";  // axes by the number of their joint
  std::optional<std::size_t> joint;
  std::map<std::size_t, std::pair<std::string, int>> comp;
  for (const Words& line : lines_of_words(content_of(files, "compensation.ini"), " \t=")) {
    if (line.size() == 3 && line[0] == "#" && line[1] == "coordinates") coordinates = line[2];
    if (line[0].front() == '[') joint.reset();
    if (line[0].starts_with("[JOINT_")) joint = static_cast<std::size_t>(line[0][7] - '0');
    if (line[0] == "LINEAR_UNITS") unit = line.at(1) == "inch" ? kInch : kMillimetre;
    if (joint && line[0] == "COMP_FILE") comp[*joint].first = line.at(1);
    if (joint && line[0] == "COMP_FILE_TYPE") comp[*joint].second = std::stoi(line.at(1));
  }
  for (const auto& [number, file] : comp) {
    const AxisName axis = axis_in(std::string(1, coordinates.at(number)));
    for (const Words& row : lines_of_words(content_of(files, file.first), " \t")) {
      const double nominal = std::stod(row.at(0)), plus = std::stod(row.at(1)), minus = std::stod(row.at(2));
      const bool trims = file.second == 1;
      axes.add(axis, axis, nominal * unit, (trims ? plus : nominal - plus) * unit,
               (trims ? minus : nominal - minus) * unit);
    }
  }
  sim::ControlTables tables;
  axes.move_to(tables);
  return tables;
}

// volcalkins.c: joint = axis + correction; half the reversal in the file.
sim::ControlTables linuxcnc_grid_control(std::span<const TableFile> files) {
  sim::ControlGrid grid;
  double unit = kMillimetre;
  for (const Words& row : lines_of_words(content_of(files, "volcal.grid"), " \t")) {
    if (row[0].front() == '#') continue;
    if (row[0].starts_with("volcal-grid")) {
      unit = row.at(1) == "inch" ? kInch : kMillimetre;
    } else {
      add_grid_row(grid, row, unit, unit, 0.5);
    }
  }
  sim::ControlTables tables;
  tables.grids.push_back(std::move(grid));
  if (const TableFile* file = find_file(files, "volcal.rotary")) add_kins_rotary_tables(*file, tables);
  return tables;
}

// Screw compensation of the joints, and the pins of the kinematics.
sim::ControlTables linuxcnc_trt_control(std::span<const TableFile> files) {
  sim::ControlTables tables;
  if (find_file(files, "compensation.ini") != nullptr) tables = linuxcnc_control(files);
  if (const TableFile* file = find_file(files, "pivots.hal")) add_trt_pivots(*file, tables);
  return tables;
}

/// Rows of the block of an ISG file below its header.
class IsgControlBlock {
 public:
  IsgControlBlock(const Words& header, const std::array<double, kAxisCount>& signs) {
    for (const std::string& name : header) {
      if (name.size() == 1) {
        arguments_.push_back(axis_in(name));
      } else {
        outputs_.push_back(direction_of(ErrorSymbol::parse(name)->component));
        signs_.push_back(signs.at(index_of(axis_in(name.substr(2)))));
      }
    }
    grid_.meaning = sim::TableValue::Error;
  }
  void add(const Words& row) {
    std::array<double, 3> position{};
    for (std::size_t i = 0; i < arguments_.size(); ++i)
      position[index_of(arguments_[i])] = std::stod(row.at(i)) * kMillimetre;
    add_node(grid_, position);
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < outputs_.size(); ++i)
      value[outputs_[i]] += signs_[i] * std::stod(row.at(arguments_.size() + i)) * kMillimetre;
    grid_.mean.push_back(value);
  }
  const sim::ControlGrid& grid() const { return grid_; }

 private:
  std::vector<AxisName> arguments_;
  std::vector<int> outputs_;
  std::vector<double> signs_;
  sim::ControlGrid grid_;
};

// Whole numbers of 0.1 um; values are actual minus set position.
void add_leadscrew_lists(std::span<const TableFile> files, sim::ControlTables& tables) {
  constexpr double kTenth = 1e-7;
  AxisTables axes(sim::TableValue::Error);
  for (const TableFile& file : files) {
    if (!file.name.starts_with("achskw")) continue;
    AxisName axis = AxisName::X;
    std::map<int, std::map<std::string, double>> entries;
    for (const Words& line : lines_of_words(file.content, " \t[].")) {
      if (line[0] == "kopf" && line.at(1) == "log_achs_name") axis = axis_in(line.at(2));
      if (line.size() > 4 && line[2] == "table") entries[std::stoi(line[3])][line[4]] = std::stod(line.at(5));
    }
    for (auto& [index, entry] : entries)
      axes.add(axis, axis, entry.at("setpoint") * kTenth, entry.at("pos") * kTenth, entry.at("neg") * kTenth);
  }
  axes.move_to(tables);
}

// Names of ISO 230-1: errors, mm; # begins a new block. With a chain in the list, rotary axes have blocks
// too.
sim::ControlTables isg_control(std::span<const TableFile> files) {
  sim::ControlTables tables;
  IsgChainControl chain(content_of(files, "volcomp.lis"), content_of(files, "volcomp.csv"));
  std::optional<IsgControlBlock> block;
  bool of_chain = false;
  const auto close = [&] {
    if (block) tables.grids.push_back(block->grid());
    block.reset();
    of_chain = false;
  };
  for (const Words& line : lines_of_words(content_of(files, "volcomp.csv"), " \t")) {
    if (line[0].starts_with("//")) continue;
    if (line[0].front() == '#') {
      close();
    } else if (of_chain) {
      chain.add_row(line);
    } else if (block) {
      block->add(line);
    } else if (chain.opens(line)) {
      of_chain = true;
    } else {
      block.emplace(line, chain.signs());
    }
  }
  close();
  chain.move_to(tables);
  add_leadscrew_lists(files, tables);
  return tables;
}

sim::ControlTables etalon_control(std::span<const TableFile> files) {
  AxisTables axes(sim::TableValue::Error);
  ErrorSymbol symbol;
  for (Words line : lines_of_words(content_of(files, "volcomp.txt"), " \t[]")) {
    line.erase(std::ranges::find_if(line, [](const std::string& word) { return word.starts_with("//"); }),
               line.end());
    if (line.empty()) continue;
    if (const auto named = ErrorSymbol::parse(line[0])) symbol = *named;
    if (line.size() != 2 || line[0].find_first_not_of("+-.0123456789eE") != std::string::npos) continue;
    const double error = std::stod(line[1]) * kMillimetre;
    axes.add(symbol.axis, kLinearAxes.at(static_cast<std::size_t>(direction_of(symbol.component))),
             std::stod(line[0]) * kMillimetre, error, error);
  }
  sim::ControlTables tables;
  axes.move_to(tables);
  return tables;
}

sim::ControlTables isg_ssfk_control(std::span<const TableFile> files) {
  sim::ControlTables tables;
  add_leadscrew_lists(files, tables);
  return tables;
}

/// Assignments of a SINUMERIK file as words: variable, indices, value. Comments are left out.
std::vector<Words> sinumerik_words(const std::string& text) {
  std::vector<Words> assignments;
  for (Words line : lines_of_words(text, " \t[],=()\"")) {
    const auto comment = std::ranges::find_if(
        line, [](const std::string& word) { return word.find(';') != std::string::npos; });
    if (comment != line.end()) {
      comment->erase(comment->find(';'));
      line.erase(comment->empty() ? comment : comment + 1, line.end());
    }
    if (line.size() > 1 && line[0].front() == 'N') line.erase(line.begin());  // block number
    if (!line.empty() && line[0].front() == '$') assignments.push_back(std::move(line));
  }
  return assignments;
}

// $AA_ENC_COMP[encoder, point, axis]: a positive value moves the axis in the negative direction.
sim::ControlTables sinumerik_control(std::span<const TableFile> files) {
  std::map<AxisName, std::map<int, double>> values;
  std::map<AxisName, double> first, step, period;
  for (const Words& line : sinumerik_words(content_of(files, "AX_EEC.INI"))) {
    const AxisName axis = axis_in(line.at(line.size() - 2));
    const double value = std::stod(line.back()) * (is_rotary(axis) ? kDegree : kMillimetre);
    if (line[0] == "$AA_ENC_COMP") values[axis][std::stoi(line.at(2))] = value;
    if (line[0] == "$AA_ENC_COMP_STEP") step[axis] = value;
    if (line[0] == "$AA_ENC_COMP_MIN") first[axis] = value;
    if (line[0] == "$AA_ENC_COMP_IS_MODULO" && std::stoi(line.back()) == 1)
      period[axis] = 2.0 * std::numbers::pi;
  }
  AxisTables axes(sim::TableValue::Error);
  for (const auto& [axis, points] : values) {
    for (const auto& [point, value] : points)
      axes.add(axis, axis, first[axis] + point * step[axis], value, value);
  }
  sim::ControlTables tables;
  axes.move_to(tables);
  for (sim::ControlAxisTable& table : tables.axis_tables) table.period = period[table.input];
  return tables;
}

/// One table of $AN_CEC.
struct CecControlTable {
  std::map<int, double> values;
  std::map<std::string, std::string> settings;
};

sim::ControlAxisTable in_millimetres(sim::ControlAxisTable table) {
  for (double& value : table.towards_plus) value /= kMillimetre;
  for (double& value : table.towards_minus) value /= kMillimetre;
  return table;
}

// What a positive value means is a comment of the file: the control that is simulated is the one that the
// user found out it is.
sim::ControlTables sinumerik_cec_control(std::span<const TableFile> files) {
  const std::string& text = content_of(files, "NC_CEC.INI");
  const bool corrections = text.find("VALUES ARE COMPENSATIONS") != std::string::npos;
  std::map<int, CecControlTable> cec;
  for (const Words& line : sinumerik_words(text)) {
    CecControlTable& table = cec[std::stoi(line.at(1))];
    if (line[0] == "$AN_CEC") {
      table.values[std::stoi(line.at(2))] = std::stod(line.at(3)) * kMillimetre;
    } else {
      table.settings[line[0].substr(7)] = line.at(2);
    }
  }
  sim::ControlTables tables;
  std::map<int, std::size_t> place;
  for (auto& [number, table] : cec) {
    AxisTables axes(corrections ? sim::TableValue::Correction : sim::TableValue::Error);
    const double step = std::stod(table.settings["_STEP"]) * kMillimetre;
    const double first = std::stod(table.settings["_MIN"]) * kMillimetre;
    const int direction = std::stoi(table.settings["_DIRECTION"]);
    for (const auto& [point, value] : table.values)
      axes.add(axis_in(table.settings["_INPUT_AXIS"]), axis_in(table.settings["_OUTPUT_AXIS"]),
               first + point * step, direction < 0 ? 0.0 : value, direction > 0 ? 0.0 : value);
    place[number] = tables.axis_tables.size();
    axes.move_to(tables);
  }
  for (auto& [number, table] : cec) {
    const int other = std::stoi(table.settings["_MULT_BY_TABLE"]);
    if (other > 0)
      tables.products.push_back({tables.axis_tables.at(place.at(number)),
                                 in_millimetres(tables.axis_tables.at(place.at(other - 1)))});
  }
  return tables;
}

struct ControlFormat {
  std::string_view format;
  std::vector<std::string> marks;  ///< any of these files in a folder
  sim::ControlTables (*read)(std::span<const TableFile>);
  std::string_view without = {};         ///< a file that makes `shared` part of another format
  std::vector<std::string> shared = {};  ///< marks where `without` is not there
};

const std::vector<ControlFormat>& control_formats() {
  static const std::vector<ControlFormat> formats = {
      {"csv", {"compensation_tables.csv"}, csv_control},
      {"neutral-csv",
       {"axis_corrections.csv", "correction_grid.csv", "rotary_axis_corrections.csv"},
       neutral_control,
       "compensation_tables.csv",
       {"rotary_compensation_grid_table.csv", "rotary_compensation_grid_tool.csv"}},
      {"linuxcnc", {}, linuxcnc_control, "pivots.hal", {"compensation.ini"}},
      {"linuxcnc-grid", {"volcal.grid", "volcal.rotary"}, linuxcnc_grid_control},
      {"linuxcnc-trt", {"pivots.hal"}, linuxcnc_trt_control},
      {"klipper", {"skew_correction.cfg"}, klipper_control},
      {"marlin", {"skew.gcode"}, marlin_control},
      {"isg-csv", {"volcomp.lis"}, isg_control},
      {"etalon-exchange", {"volcomp.txt"}, etalon_control},
      {"isg-ssfk", {}, isg_ssfk_control, "volcomp.lis", {"achskw1.lis", "achskw2.lis", "achskw3.lis"}},
      {"sinumerik", {"AX_EEC.INI"}, sinumerik_control},
      {"sinumerik-cec", {"NC_CEC.INI"}, sinumerik_cec_control},
      {"heidenhain", {"CONFIG.CMA.txt"}, heidenhain_control},
      {"fanuc", {"pitch_error.txt"}, fanuc_control}};
  return formats;
}

bool is_marked(const ControlFormat& format, const std::set<std::string>& names) {
  const auto is_there = [&](const std::string& name) { return names.contains(name); };
  if (std::ranges::any_of(format.marks, is_there)) return true;
  return !names.contains(std::string(format.without)) && std::ranges::any_of(format.shared, is_there);
}

}  // namespace

TablesFolder read_tables_folder(const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw InputError({folder, 0}, "there is no such folder",
                     missing_remedy(folder, "give the folder that volcal tables wrote with -o"));
  TablesFolder tables;
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool certificate = name == kCertificatePage || name == kCertificatePdf;
    if (entry.is_regular_file() && name.front() != '.' && !certificate) names.insert(name);
  }
  for (const ControlFormat& format : control_formats()) {
    if (!is_marked(format, names)) continue;
    if (tables.format != nullptr)
      throw InputError({folder, 0},
                       "the folder holds tables of two formats, " + std::string(tables.format->name) +
                           " and " + std::string(format.format),
                       "give a folder with the tables of one");
    tables.format = find_table_format(format.format);
  }
  if (tables.format == nullptr)
    throw InputError({folder, 0}, "the folder holds no tables", "give a folder that volcal tables wrote");
  for (const std::string& name : names)
    tables.files.push_back({name, read_text_file((fs::path(folder) / name).string())});
  return tables;
}

bool control_reads(const TableFormat& format) {
  const auto& formats = control_formats();
  return std::ranges::find(formats, format.name, &ControlFormat::format) != formats.end();
}

sim::ControlTables control_tables(const TableFormat& format, std::span<const TableFile> files) {
  format.read(files);
  const auto& formats = control_formats();
  const auto known = std::ranges::find(formats, format.name, &ControlFormat::format);
  if (known == formats.end())
    throw InputError({}, "the simulated control does not read " + std::string(format.name),
                     "give tables of another format");
  try {
    return known->read(files);
  } catch (const std::logic_error&) {  // a number or a word that is not there
    throw InputError({files.empty() ? std::string() : files.front().name, 0},
                     "the simulated control does not read this file", "write the tables again");
  }
}

}  // namespace volcal
