#include "volcal/identify/compensation/rotary_grid_csv.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kGridTurn = 2.0 * std::numbers::pi;
constexpr double kSameNode = 1e-9;  // rad

std::string_view word_of(TableContent content) {
  return content == TableContent::Errors ? "error" : "compensation";
}

double sign_in(TableContent content) { return content == TableContent::Errors ? 1.0 : -1.0; }

std::string rotary_grid_header(const RotaryGrid& grid, TableContent content) {
  std::string header;
  for (const RotaryNodes& nodes : grid.axes) header += fmt::format("{}_deg,", lower_letter_of(nodes.axis));
  for (const char letter : {content == TableContent::Errors ? 'e' : 'd', 'u'}) {
    for (const Component component : kAllComponents)
      header += fmt::format("{}{}_{},", letter == 'u' ? "u_e" : std::string(1, letter),
                            lower_letter_of(kAllAxes[index_of(component)]), edge_unit(component));
  }
  return header + "extrapolated";
}

/// Lines of keys above the rows.
class GridKeys {
 public:
  explicit GridKeys(const TableFile& file) : file_(file) {
    TableLines lines(file);
    while (lines.advance()) {
      const std::string_view line = lines.current();
      if (!line.starts_with('#')) break;
      const auto equals = line.find('=');
      if (equals == std::string_view::npos) continue;
      const std::string key(trimmed_text(line.substr(1, equals - 1)));
      if (!values_.emplace(key, std::pair(std::string(trimmed_text(line.substr(equals + 1))), lines.place()))
               .second)
        lines.fail("key " + key.substr(0, 40) + " is given twice", "delete one of the lines");
    }
  }

  const std::string& text(const std::string& key) const { return found(key).first; }
  const SourcePlace& place(const std::string& key) const { return found(key).second; }
  [[noreturn]] void fail(const std::string& key, const std::string& remedy) const {
    throw InputError(place(key), key + " is \"" + text(key).substr(0, 40) + "\"", remedy);
  }
  bool yes_or_no(const std::string& key, std::string_view yes, std::string_view no) const {
    if (text(key) != yes && text(key) != no)
      fail(key, "write " + std::string(yes) + " or " + std::string(no));
    return text(key) == yes;
  }

 private:
  const std::pair<std::string, SourcePlace>& found(const std::string& key) const {
    const auto value = values_.find(key);
    if (value == values_.end())
      throw InputError({file_.name, 0}, "the line # " + key + " = ... is missing", "write the tables again");
    return value->second;
  }

  const TableFile& file_;
  std::map<std::string, std::pair<std::string, SourcePlace>> values_;
};

Eigen::Vector3d point_in(const GridKeys& keys, const std::string& key) {
  const auto words = words_of(keys.text(key));
  if (words.size() != 3) keys.fail(key, "write three numbers, mm");
  Eigen::Vector3d point;
  for (std::size_t k = 0; k < 3; ++k)
    point[static_cast<Eigen::Index>(k)] =
        csv_number({keys.place(key), {std::string(words[k])}}, 0, key) * kMetrePerMillimetre;
  return point;
}

std::vector<RotaryNodes> axes_in(const GridKeys& keys) {
  std::vector<RotaryNodes> axes;
  for (const std::string_view word : words_of(keys.text("axes"))) {
    const auto axis = word.size() == 1 ? axis_from_letter(word[0]) : std::nullopt;
    const bool after = axis && (axes.empty() || axes.back().axis < *axis);
    if (!axis || !is_rotary(*axis) || !after) keys.fail("axes", "write A, B, C in this order");
    RotaryNodes nodes;
    nodes.axis = *axis;
    nodes.full_turn =
        keys.yes_or_no(fmt::format("beyond_ends.{}", letter_of(*axis)), "modulo 360 deg", "end values held");
    axes.push_back(std::move(nodes));
  }
  if (axes.empty()) keys.fail("axes", "name the rotary axes of the columns");
  return axes;
}

/// The rows must be a complete grid, the last axis fastest.
void set_nodes(RotaryGrid& grid, const std::vector<std::vector<double>>& rows,
               const std::vector<SourcePlace>& places) {
  for (std::size_t a = 0; a < grid.axes.size(); ++a) {
    auto& nodes = grid.axes[a].positions;
    for (const auto& row : rows) nodes.push_back(row[a]);
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
  const auto positions = grid.positions();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bool right = positions.size() == rows.size();
    for (std::size_t a = 0; right && a < grid.axes.size(); ++a)
      right = positions[i][index_of(grid.axes[a].axis)] == rows[i][a];
    if (!right)
      throw InputError(places[i], "the rows are not a complete grid",
                       "write every combination of positions once, ascending, the last axis fastest; write "
                       "the tables again");
  }
  for (const RotaryNodes& nodes : grid.axes) {
    const double length = nodes.positions.back() - nodes.positions.front();
    if (nodes.full_turn && std::abs(length - kGridTurn) > 1e-6)
      throw InputError(places.back(),
                       fmt::format("the positions of {} do not make a turn", letter_of(nodes.axis)),
                       "write a turn, or beyond_ends = end values held");
  }
}

struct GridPlace {
  std::size_t lower = 0;
  double share = 0.0;
};

GridPlace place_among(const RotaryNodes& nodes, double angle) {
  const auto& positions = nodes.positions;
  if (positions.size() < 2) return {};
  if (nodes.full_turn) angle -= kGridTurn * std::floor((angle - positions.front()) / kGridTurn + kSameNode);
  const auto above = std::upper_bound(positions.begin(), positions.end(), angle);
  const auto place = std::clamp<std::ptrdiff_t>(above - positions.begin(), 1,
                                                static_cast<std::ptrdiff_t>(positions.size()) - 1);
  const auto lower = static_cast<std::size_t>(place - 1);
  const double share = (angle - positions[lower]) / (positions[lower + 1] - positions[lower]);
  return {lower, std::clamp(share, 0.0, 1.0)};
}

/// The lever of the axis of a grid that stands nearest to the bed.
const JointLever& carrier_lever(const RotaryGrid& grid, const JointLever* levers, std::size_t count) {
  const JointLever* nearest = nullptr;
  for (std::size_t i = 0; i < count; ++i) {
    const bool of_grid = std::ranges::find(grid.axes, levers[i].axis, &RotaryNodes::axis) != grid.axes.end();
    if (of_grid && (nearest == nullptr || levers[i].workpiece_side)) nearest = &levers[i];
  }
  if (nearest == nullptr) throw std::logic_error("no axis of a rotary grid is a joint of the machine");
  return *nearest;
}

void require_axes(const RotaryGrid& grid, const Machine& machine) {
  for (const RotaryNodes& nodes : grid.axes) {
    const auto joint = std::ranges::find(machine.structure.joints, nodes.axis, &Joint::axis);
    const bool right =
        joint != machine.structure.joints.end() && joint->workpiece_side == (grid.body == TurnedBody::Table);
    if (!right)
      throw InputError({rotary_grid_file_name(grid.body, TableContent::Compensations), 0},
                       fmt::format("axis {} does not turn the {} of this machine", letter_of(nodes.axis),
                                   to_string(grid.body)),
                       "take metadata.csv of the same run");
  }
}

}  // namespace

std::string rotary_grid_file_name(TurnedBody body, TableContent content) {
  return fmt::format("rotary_{}_grid_{}.csv", word_of(content), to_string(body));
}

std::string rotary_grid_csv(const RotaryGrid& grid, TableContent content, bool own_rotations) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  const Eigen::Vector3d reference = grid.reference / kMetrePerMillimetre;
  fmt::format_to(
      out,
      "# Spatial grid of rotary axes (ISO/TR 16907:2015, 9.3.2, Table 3): rigid twist, tool relative "
      "to workpiece\n"
      "# content = {}\n# body = {}\n# reference_point_mm = {:.9g} {:.9g} {:.9g}\n"
      "# coordinates = of the body that carries these axes, parallel to the machine's, all axes at 0\n"
      "# own_rotations = {}\n# axes =",
      word_of(content), to_string(grid.body), reference.x() + 0.0, reference.y() + 0.0, reference.z() + 0.0,
      own_rotations ? "included" : "left to the axes");
  for (const RotaryNodes& nodes : grid.axes) fmt::format_to(out, " {}", letter_of(nodes.axis));
  for (const RotaryNodes& nodes : grid.axes)
    fmt::format_to(out, "\n# beyond_ends.{} = {}", letter_of(nodes.axis),
                   nodes.full_turn ? "modulo 360 deg" : "end values held");
  fmt::format_to(out, "\n{}\n", rotary_grid_header(grid, content));
  const auto positions = grid.positions();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (const RotaryNodes& nodes : grid.axes)
      fmt::format_to(out, "{:.12g},", positions[i][index_of(nodes.axis)] / kRadianPerDegree + 0.0);
    for (const double value : grid.twists[i].value)
      fmt::format_to(out, "{:.9g},", sign_in(content) * value / kMicro + 0.0);
    for (const double u : grid.twists[i].u) fmt::format_to(out, "{:.6g},", u / kMicro);
    fmt::format_to(out, "{}\n", grid.twists[i].extrapolated ? 1 : 0);
  }
  return fmt::to_string(text);
}

RotaryGrid read_rotary_grid(const TableFile& file, TableContent content) {
  const GridKeys keys(file);
  if (keys.text("content") != word_of(content))
    keys.fail("content", "this file must hold " + std::string(word_of(content)) + "s");
  keys.yes_or_no("own_rotations", "included", "left to the axes");
  RotaryGrid grid;
  grid.body = keys.yes_or_no("body", "table", "tool") ? TurnedBody::Table : TurnedBody::Tool;
  grid.reference = point_in(keys, "reference_point_mm");
  grid.axes = axes_in(keys);
  // The lines of keys become blank, so that the rows keep their numbers.
  TableFile rows_only{file.name, {}};
  bool above = true;
  for (std::size_t from = 0; from < file.content.size();) {
    const std::size_t stop = std::min(file.content.find('\n', from), file.content.size() - 1);
    above = above && file.content[from] == '#';
    rows_only.content += above ? "\n" : file.content.substr(from, stop + 1 - from);
    from = stop + 1;
  }
  std::vector<std::vector<double>> angles;
  std::vector<SourcePlace> places;
  for (const CsvRow& row : csv_rows(rows_only, rotary_grid_header(grid, content))) {
    std::size_t column = 0;
    std::vector<double>& place = angles.emplace_back();
    for (std::size_t a = 0; a < grid.axes.size(); ++a)
      place.push_back(csv_number(row, column++, "the position") * kRadianPerDegree);
    RotaryTwist& twist = grid.twists.emplace_back();
    for (double& value : twist.value)
      value = sign_in(content) * csv_number(row, column++, "the value") * kMicro;
    for (double& u : twist.u) u = csv_number(row, column++, "u") * kMicro;
    const double flag = csv_number(row, column, "extrapolated");
    if (twist.u.minCoeff() < 0.0 || (flag != 0.0 && flag != 1.0))
      throw InputError(row.place, "an uncertainty is negative, or extrapolated is neither 0 nor 1",
                       "write the tables again");
    twist.extrapolated = flag == 1.0;
    places.push_back(row.place);
  }
  set_nodes(grid, angles, places);
  return grid;
}

std::vector<RotaryGrid> read_rotary_grids(std::span<const TableFile> files, TableContent content) {
  std::vector<RotaryGrid> grids;
  for (const TurnedBody body : {TurnedBody::Table, TurnedBody::Tool}) {
    const TableFile* file = find_file(files, rotary_grid_file_name(body, content));
    if (file == nullptr) continue;
    grids.push_back(read_rotary_grid(*file, content));
    if (grids.back().body != body)
      throw InputError({file->name, 0}, "the file holds the grid of the other body", "rename the files back");
  }
  return grids;
}

PoseErrorVector twist_at(const RotaryGrid& grid, const AxisPosition& position) {
  std::vector<GridPlace> places;
  for (const RotaryNodes& nodes : grid.axes)
    places.push_back(place_among(nodes, position[index_of(nodes.axis)]));
  PoseErrorVector sum = PoseErrorVector::Zero();
  for (unsigned corner = 0; corner < (1U << places.size()); ++corner) {
    double weight = 1.0;
    std::size_t index = 0;
    for (std::size_t a = 0; a < places.size(); ++a) {
      const bool upper = ((corner >> a) & 1U) != 0;
      weight *= upper ? places[a].share : 1.0 - places[a].share;
      const std::size_t count = grid.axes[a].positions.size();
      index = index * count + std::min(places[a].lower + (upper ? 1 : 0), count - 1);
    }
    if (weight != 0.0) sum += weight * grid.twists[index].value;
  }
  return sum;
}

CorrectionTerm rotary_grid_term(std::vector<RotaryGrid> grids, const Machine& machine,
                                const Eigen::Vector3d& tool_offset) {
  for (const RotaryGrid& grid : grids) require_axes(grid, machine);
  std::array<Eigen::Vector3d, kAxisCount> centres;
  centres.fill(Eigen::Vector3d::Zero());
  for (const Axis& axis : machine.axes) centres[index_of(axis.name)] = axis.centre;
  return [grids = std::move(grids), centres, chain = KinematicChain(machine), tool_offset](
             const AxisPosition& position, const ApproachDirection& /*direction*/) {
    JointLever levers[kAxisCount];
    chain.levers(position, tool_offset, levers);
    Eigen::Vector3d displacement_w = Eigen::Vector3d::Zero();
    for (const RotaryGrid& grid : grids) {
      const JointLever& carrier = carrier_lever(grid, levers, chain.joint_count());
      const Eigen::Vector3d arm = carrier.arm_s + centres[index_of(carrier.axis)] - grid.reference;
      const PoseErrorVector twist = twist_at(grid, position);
      // A table's lever is turned by its own axis, too: from the carrier into the workpiece.
      displacement_w += carrier.rotation_ws * (twist.head<3>() + Eigen::Vector3d(twist.tail<3>()).cross(arm));
    }
    Correction correction;
    correction.linear = -linear_moves(linear_directions(levers, chain.joint_count()), displacement_w);
    return correction;
  };
}

}  // namespace volcal
