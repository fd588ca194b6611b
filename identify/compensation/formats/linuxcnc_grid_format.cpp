#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <utility>

#include "volcal/identify/compensation/formats/linuxcnc_units.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"

namespace volcal {

const TableFormat& linuxcnc_grid_format();

namespace {

constexpr std::string_view kKinsGridFile = "volcal.grid";
constexpr std::string_view kKinsGridMark = "volcal-grid-1";
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

std::vector<TableFile> write_kins_grid(const FitResult& result, const TableFormatOptions& options) {
  const CorrectionGrid grid = sample_grid(linuxcnc_grid_format(), result, options);
  return {{std::string(kKinsGridFile), kins_grid(grid, linear_units_of(options))}};
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
  return result;
}

}  // namespace

const TableFormat& linuxcnc_grid_format() {
  static const TableFormat format = {
      .name = "linuxcnc-grid",
      .summary =
          "volumetric compensation in LinuxCNC: volcal.grid for the kinematics module volcalkins "
          "(controllers/linuxcnc), corrections on a grid with the share of each axis's reversal",
      .source =
          "volcalkins.c: joint = axis + correction, trilinear, end values held; directions from the "
          "commanded positions; joints 0 1 2 move X Y Z",
      .verified =
          "applied by LinuxCNC 2.9.0~pre1 in simulation as predicted, in every combination of directions "
          "(scripts/linuxcnc-loop --volumetric); not on a machine",
      .supported = CompensationType::volumetric(),
      .refusal = "it holds every type of the linear axes",
      .limits = {.resolution = 1e-12, .both_directions = true},
      .settings = kLinuxCncSettings,
      .write = write_kins_grid,
      .read = read_kins_grid};
  return format;
}

}  // namespace volcal
