#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>

#include "volcal/identify/compensation/formats/linuxcnc/linuxcnc_units.h"
#include "volcal/identify/compensation/rotary_grid_csv.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"

namespace volcal {

const TableFormat& linuxcnc_grid_format();

namespace {

constexpr std::string_view kKinsGridFile = "volcal.grid";
constexpr std::string_view kKinsGridMark = "volcal-grid-1";
constexpr std::string_view kKinsRotaryFile = "volcal.rotary";
constexpr std::string_view kKinsRotaryMark = "volcal-rotary-1";
constexpr int kMostKinsPositions = 100'000;  // MOST_POSITIONS
constexpr std::size_t kKinsColumns = 15;
constexpr int kMostKinsNodes = 1'000'000;  // MOST_NODES of volcalkins.c

std::string kins_grid(const CorrectionGrid& grid, std::string_view units) {
  const double unit = linear_unit(units);
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  const auto write_vector = [&](const Eigen::Vector3d& value) {
    for (const double component : value)
      fmt::format_to(out, " {:.9f}", without_negative_zero(component / unit));
  };
  fmt::format_to(
      out,
      "# corrections to the commands of X Y Z: position, mean of both directions, then for X, Y and Z\n");
  fmt::format_to(out, "# half the difference of approach towards + and towards -\n{} {} {} {} {}\n",
                 kKinsGridMark, units, grid.nodes[0].size(), grid.nodes[1].size(), grid.nodes[2].size());
  for_each_node(grid.nodes, [&](std::size_t index, const AxisPosition& node) {
    fmt::format_to(out, "{:.6f} {:.6f} {:.6f}", without_negative_zero(node[0] / unit),
                   without_negative_zero(node[1] / unit), without_negative_zero(node[2] / unit));
    write_vector(grid.mean[index]);
    for (const auto& half : grid.half_reversal) write_vector(half[index]);
    fmt::format_to(out, "\n");
  });
  return fmt::to_string(text);
}

// ---- Rotary axes

/// Whether rotary axes stand before the linear ones or behind them.
bool linear_axes_are_together(const Structure& structure) {
  const auto& joints = structure.joints;
  const auto linear = [](const Joint& joint) { return !is_rotary(joint.axis); };
  const auto first = std::ranges::find_if(joints, linear);
  const auto behind = std::find_if_not(first, joints.end(), linear);
  return std::none_of(behind, joints.end(), linear);
}

void require_kins_structure(const Machine& machine) {
  if (linear_axes_are_together(machine.structure) && machine.main_linear_axes().size() == 3) return;
  throw InputError({},
                   "linuxcnc-grid: volcalkins needs X, Y and Z without a rotary axis between them, " +
                       machine.structure.code + " has not",
                   "leave out the types of rotary axes");
}

std::string kins_point(const Eigen::Vector3d& point, double unit) {
  return fmt::format("{:.6f} {:.6f} {:.6f}", point.x() / unit + 0.0, point.y() / unit + 0.0,
                     point.z() / unit + 0.0);
}

std::string kins_chain(const Machine& machine, const Tool& tool, double unit) {
  std::string text = "chain";
  bool workpiece = true;
  for (const Joint& joint : machine.structure.joints) {
    if (workpiece && !joint.workpiece_side) text += " b";
    workpiece = joint.workpiece_side;
    text += fmt::format(" {}{}", letter_of(joint.axis), workpiece ? "'" : "");
  }
  text += workpiece ? " b\n" : "\n";
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name))
      text += fmt::format("centre {} {}\n", letter_of(axis.name), kins_point(axis.centre, unit));
  }
  return text + fmt::format("tool {}\n", kins_point(tool.offset, unit));
}

std::string kins_own(const SampledTable& sampled) {
  const AxisTable& table = sampled.table;
  std::string text = fmt::format("own {} {} {}\n", letter_of(sampled.output), table.position.size(),
                                 table.beyond == BeyondEnds::Repeat ? 1 : 0);
  for (std::size_t i = 0; i < table.position.size(); ++i)
    text +=
        fmt::format("{:.9f} {:.12f} {:.12f}\n", table.position[i] / kRadianPerDegree + 0.0,
                    table.forward[i] / kRadianPerDegree + 0.0, table.backward[i] / kRadianPerDegree + 0.0);
  return text;
}

/// Corrections: minus the errors.
std::string kins_twists(const RotaryGrid& grid, double unit) {
  std::string text = fmt::format("twists {}", to_string(grid.body));
  for (const RotaryNodes& nodes : grid.axes)
    text += fmt::format(" {} {} {}", letter_of(nodes.axis), nodes.positions.size(), nodes.full_turn ? 1 : 0);
  text += "\n" + kins_point(grid.reference, unit) + "\n";
  const auto positions = grid.positions();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (const RotaryNodes& nodes : grid.axes)
      text += fmt::format("{:.9f} ", positions[i][index_of(nodes.axis)] / kRadianPerDegree + 0.0);
    for (int k = 0; k < 3; ++k) text += fmt::format("{:.9f} ", -grid.twists[i].value[k] / unit + 0.0);
    for (int k = 3; k < 6; ++k) text += fmt::format("{:.12f} ", -grid.twists[i].value[k] + 0.0);
    text.back() = '\n';
  }
  return text;
}

std::string kins_rotary(const FitResult& result, const TableFormatOptions& options) {
  const std::string units = linear_units_of(options);
  const double unit = linear_unit(units);
  const RotaryShares shares = twist_shares(linuxcnc_grid_format(), options.type);
  require_kins_structure(result.machine);
  std::string text = fmt::format(
      "# rotary axes: what is added to their commands, deg, and what the linear axes follow, {} and rad\n"
      "{} {}\n",
      units, kKinsRotaryMark, units);
  text += kins_chain(result.machine, tool_of(result.machine, options), unit);
  if (options.type.has(CompensationPart::RotaryPositioning)) {
    for (const SampledTable& sampled : sample_rotary_positioning(linuxcnc_grid_format(), result, options))
      text += kins_own(sampled);
  }
  if (!shares.location && !shares.motion) return text;
  for (const RotaryGrid& grid : rotary_grids_to_correct(result, options, shares))
    text += kins_twists(grid, unit);
  return text;
}

std::vector<TableFile> write_kins_grid(const FitResult& result, const TableFormatOptions& options) {
  const CorrectionGrid grid = sample_grid(linuxcnc_grid_format(), result, options);
  std::vector<TableFile> files = {{std::string(kKinsGridFile), kins_grid(grid, linear_units_of(options))}};
  if (!options.type.rotary().empty())
    files.push_back({std::string(kKinsRotaryFile), kins_rotary(result, options)});
  return files;
}

bool advance_to_kins_line(TableLines& lines) {
  while (lines.advance_to_content()) {
    if (trimmed_text(lines.current()).front() != '#') return true;
  }
  return false;
}

struct KinsHeader {
  double unit = 0.0;  ///< m
  std::array<std::size_t, 3> size{};
};

KinsHeader read_kins_header(TableLines& lines) {
  const auto words =
      advance_to_kins_line(lines) ? words_of(lines.current()) : std::vector<std::string_view>();
  if (words.size() != 5 || words[0] != kKinsGridMark)
    lines.fail("the header is missing", fmt::format("write {} mm NX NY NZ", kKinsGridMark));
  KinsHeader header{.unit = linear_unit(words[1])};
  if (header.unit == 0.0) lines.fail("the unit is neither mm nor inch", "write mm or inch");
  std::int64_t rows = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    const int size = lines.integer(words[2 + i], "the number of positions");
    rows *= std::clamp(size, 0, kMostKinsNodes);
    if (size < 1 || rows > kMostKinsNodes)
      lines.fail("the size of the grid is out of range",
                 fmt::format("give at least 1 position an axis and at most {} rows", kMostKinsNodes));
    header.size[i] = static_cast<std::size_t>(size);
  }
  return header;
}

/// volcal.rotary line by line.
class KinsRotaryReader {
 public:
  explicit KinsRotaryReader(const TableFile& file) : lines_(file) {}

  std::vector<CorrectionTerm> read() {
    read_header();
    while (next()) read_part();
    if (machine_.axes.empty()) lines_.fail("the chain is missing", "write the tables again");
    std::vector<CorrectionTerm> terms;
    for (auto& [axis, table] : own_) terms.push_back(axis_term(axis, std::move(table)));
    if (!grids_.empty()) terms.push_back(rotary_grid_term(std::move(grids_), machine_, tool_));
    return terms;
  }

 private:
  bool next() {
    if (!advance_to_kins_line(lines_)) return false;
    words_ = words_of(lines_.current());
    return true;
  }
  void require_next() {
    if (!next()) lines_.fail("rows are missing", "write the tables again");
  }
  double number(std::size_t word, double unit) const {
    return lines_.number(words_[word], "the value") * unit;
  }
  Eigen::Vector3d point(std::size_t first) const {
    if (words_.size() != first + 3) lines_.fail("three numbers are needed", "write x y z");
    return {number(first, unit_), number(first + 1, unit_), number(first + 2, unit_)};
  }
  AxisName rotary_axis(std::size_t word) const {
    const auto axis =
        word < words_.size() && words_[word].size() == 1 ? axis_from_letter(words_[word][0]) : std::nullopt;
    const bool right =
        axis && is_rotary(*axis) && machine_.has_axis(*axis) && words_[word][0] == letter_of(*axis);
    if (!right) lines_.fail("the line names no rotary axis of the chain", "write the tables again");
    return *axis;
  }

  void read_header() {
    if (!next() || words_.size() != 2 || words_[0] != kKinsRotaryMark)
      lines_.fail("the header is missing", fmt::format("write {} mm", kKinsRotaryMark));
    unit_ = linear_unit(words_[1]);
    if (unit_ == 0.0) lines_.fail("the unit is neither mm nor inch", "write mm or inch");
  }

  void read_part() {
    if (words_[0] == "chain") {
      read_chain();
    } else if (words_[0] == "tool") {
      tool_ = point(1);
    } else if (words_[0] == "centre") {
      const AxisName axis = rotary_axis(1);
      std::ranges::find(machine_.axes, axis, &Axis::name)->centre = point(2);
    } else if (words_[0] == "own") {
      read_own();
    } else if (words_[0] == "twists") {
      read_twists();
    } else {
      lines_.fail("the line is neither chain, centre, tool, own nor twists", "write the tables again");
    }
  }

  void read_chain() {
    if (!machine_.axes.empty()) lines_.fail("there is a second chain", "delete one of them");
    const std::string_view line = trimmed_text(lines_.current());
    machine_.structure =
        Structure::parse("w " + std::string(line.substr(5)) + " t", lines_.place().file, lines_.place().line);
    for (const Joint& joint : machine_.structure.joints) machine_.axes.emplace_back().name = joint.axis;
    if (!linear_axes_are_together(machine_.structure) || machine_.main_linear_axes().size() != 3)
      lines_.fail("a rotary axis stands between linear axes, or one of X, Y, Z is missing",
                  "volcalkins needs X, Y and Z without a rotary axis between them");
  }

  int count(std::size_t word) const {
    const int rows = lines_.integer(words_[word], "the number of rows");
    if (rows < 1 || rows > kMostKinsPositions)
      lines_.fail("the number of rows is out of range",
                  fmt::format("give at least 1 and at most {}", kMostKinsPositions));
    return rows;
  }
  bool turn(std::size_t word) const {
    if (words_[word] != "0" && words_[word] != "1")
      lines_.fail("whether a turn repeats is neither 0 nor 1", "write 0 or 1");
    return words_[word] == "1";
  }

  void read_own() {
    if (words_.size() != 4) lines_.fail("the line is not own A ROWS TURN", "write the tables again");
    const AxisName axis = rotary_axis(1);
    if (own_.contains(axis)) lines_.fail("the axis has a second table", "delete one of them");
    const int rows = count(2);
    const bool repeats = turn(3);
    AxisTable& table = own_[axis];
    table.input = axis;
    if (repeats) table.beyond = BeyondEnds::Repeat;
    for (int i = 0; i < rows; ++i) {
      require_next();
      if (words_.size() != 3) lines_.fail("the row does not have 3 numbers", "complete or delete the row");
      const double position = number(0, kRadianPerDegree);
      require_ascending(table.position, position, lines_.place());
      table.position.push_back(position);
      table.forward.push_back(number(1, kRadianPerDegree));
      table.backward.push_back(number(2, kRadianPerDegree));
    }
    if (repeats && !make_a_turn(table.position))
      lines_.fail("the positions do not make a turn", "write 0 behind the number of rows");
  }

  void read_twists() {
    const bool table = words_.size() > 1 && words_[1] == "table";
    const bool tool = words_.size() > 1 && words_[1] == "tool";
    if ((words_.size() != 5 && words_.size() != 8) || (!table && !tool))
      lines_.fail("the line is not twists table A ROWS TURN C ROWS TURN", "write the tables again");
    RotaryGrid& grid = grids_.emplace_back();
    grid.body = table ? TurnedBody::Table : TurnedBody::Tool;
    std::size_t rows = 1;
    std::vector<std::size_t> sizes;
    for (std::size_t word = 2; word < words_.size(); word += 3) {
      grid.axes.push_back({rotary_axis(word), {}, turn(word + 2)});
      if (machine_.structure.is_on_workpiece_side(grid.axes.back().axis) != table)
        lines_.fail("the axis turns the other body", "write the tables again");
      sizes.push_back(static_cast<std::size_t>(count(word + 1)));
      rows *= sizes.back();
    }
    if (rows > static_cast<std::size_t>(kMostKinsNodes))
      lines_.fail("the grid is too large", "give a larger --rotary-step");
    require_next();
    grid.reference = point(0);
    for (std::size_t row = 0; row < rows; ++row) read_twist(grid, sizes, row);
    for (const RotaryNodes& nodes : grid.axes) {
      if (nodes.full_turn && !make_a_turn(nodes.positions))
        lines_.fail("the positions do not make a turn", "write 0 behind the number of rows");
    }
  }

  void read_twist(RotaryGrid& grid, const std::vector<std::size_t>& sizes, std::size_t row) {
    require_next();
    if (words_.size() != grid.axes.size() + 6)
      lines_.fail("the row does not have the numbers of its grid", "complete or delete the row");
    std::size_t rest = row;
    for (std::size_t a = grid.axes.size(); a-- > 0;) {
      const std::size_t index = rest % sizes[a];
      rest /= sizes[a];
      std::vector<double>& positions = grid.axes[a].positions;
      const double position = number(a, kRadianPerDegree);
      if (index == positions.size()) {
        require_ascending(positions, position, lines_.place());
        positions.push_back(position);
      } else if (positions.at(index) != position) {
        lines_.fail("the rows are not a complete grid, the last axis fastest", "write the tables again");
      }
    }
    RotaryTwist& twist = grid.twists.emplace_back();
    for (std::size_t k = 0; k < 6; ++k)
      twist.value[static_cast<Eigen::Index>(k)] = -number(grid.axes.size() + k, k < 3 ? unit_ : 1.0);
  }

  TableLines lines_;
  std::vector<std::string_view> words_;
  double unit_ = 0.0;
  Machine machine_;
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero();
  std::map<AxisName, AxisTable> own_;
  std::vector<RotaryGrid> grids_;
};

CompensationTables read_kins_grid(std::span<const TableFile> files) {
  TableLines lines(file_named(files, kKinsGridFile));
  const KinsHeader header = read_kins_header(lines);
  std::vector<std::array<double, 3>> points;
  std::vector<SourcePlace> places;
  CorrectionGrid grid;
  while (advance_to_kins_line(lines)) {
    const auto words = words_of(lines.current());
    if (words.size() != kKinsColumns)
      lines.fail(fmt::format("the row has {} numbers", words.size()), "write 15 numbers a row");
    const auto vector = [&](std::size_t column) {
      Eigen::Vector3d value;
      for (std::size_t i = 0; i < 3; ++i)
        value[static_cast<Eigen::Index>(i)] = lines.number(words[column + i], "the value") * header.unit;
      return value;
    };
    const Eigen::Vector3d point = vector(0);
    points.push_back({point.x(), point.y(), point.z()});
    places.push_back(lines.place());
    grid.mean.push_back(vector(3));
    for (std::size_t i = 0; i < 3; ++i) grid.half_reversal[i].push_back(vector(6 + 3 * i));
  }
  if (points.empty()) lines.fail("the grid has no row", "write the tables again");
  grid.nodes = grid_nodes(points, places);
  for (std::size_t i = 0; i < 3; ++i) {
    if (grid.nodes[i].size() != header.size[i])
      lines.fail(fmt::format("the header promises {} positions of {}, the rows have {}", header.size[i],
                             letter_of(kLinearAxes[i]), grid.nodes[i].size()),
                 "write the tables again");
  }
  CompensationTables result;
  result.terms.push_back(grid_term(std::move(grid)));
  if (const TableFile* rotary = find_file(files, kKinsRotaryFile))
    std::ranges::move(KinsRotaryReader(*rotary).read(), std::back_inserter(result.terms));
  return result;
}

}  // namespace

const TableFormat& linuxcnc_grid_format() {
  static const TableFormat format = {
      .name = "linuxcnc-grid",
      .summary =
          "volumetric compensation in LinuxCNC: volcal.grid for the kinematics module volcalkins "
          "(controllers/linuxcnc), corrections on a grid with the share of each axis's reversal; of rotary "
          "axes volcal.rotary, what is added to their commands, and twists of table and tool that the linear "
          "axes follow",
      .source =
          "volcalkins.c: joint = axis + correction, trilinear, end values held; directions from the "
          "commanded positions; joints 0 1 2 move X Y Z",
      .verified =
          "applied by LinuxCNC 2.9.0~pre1 in simulation as predicted, in every combination of directions "
          "(scripts/linuxcnc-loop --volumetric), rotary axes of a table and of a head among them; not on a "
          "machine",
      .supported = CompensationType::volumetric(),
      .rotary = CompensationType::rotary_volumetric(),
      .refusal = "it holds every type of the linear axes",
      .limits = {.resolution = 1e-12, .both_directions = true},
      .settings = kLinuxCncSettings,
      .write = write_kins_grid,
      .read = read_kins_grid};
  return format;
}

}  // namespace volcal
