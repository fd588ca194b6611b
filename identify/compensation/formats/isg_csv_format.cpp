#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "volcal/identify/compensation/formats/isg_ssfk_lists.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& isg_csv_format();

namespace {

constexpr std::string_view kIsgList = "volcomp.lis";
constexpr std::string_view kIsgFile = "volcomp.csv";

constexpr std::array<TableSetting, 1> kIsgSettings = {
    {{"reversal",
      "lists or none: with lists, half the positioning reversal of every axis towards + and towards - as "
      "leadscrew lists (isg-ssfk) beside the volumetric tables, which know no direction, where the type has "
      "L-POS; for axes that have no leadscrew compensation of their own",
      "none", "lists"}}};

/// All axes count as tool axes: displacements alone are written, and they add whatever carries the axis.
std::string isg_list(const Machine& machine) {
  std::string text = "workpiece_axes 0\n";
  for (const AxisName axis : linear_axes_of(machine))
    text += fmt::format("{} {}\n", letter_of(axis), direction_of(axis) + 1);
  return text + fmt::format("interpolation GRID\nfile[0] {}\nfile_format[0] ISG_CSV\n", kIsgFile);
}

/// Errors: minus the corrections, mm.
std::string error_mm(double correction) {
  return fmt::format(" {:.9f}", without_negative_zero(-correction) / kMetrePerMillimetre);
}

/// One block per axis: its position, then the displacements that it causes.
std::string isg_axis_blocks(const std::vector<SampledTable>& tables) {
  std::string text;
  for (const AxisName input : kLinearAxes) {
    std::vector<const SampledTable*> columns;
    for (const SampledTable& sampled : tables) {
      if (sampled.table.input == input) columns.push_back(&sampled);
    }
    if (columns.empty()) continue;
    if (!text.empty()) text += "#\n";
    text += letter_of(input);
    for (const SampledTable* column : columns)
      text += fmt::format(" E{}{}", letter_of(column->output), letter_of(input));
    text += '\n';
    for (std::size_t i = 0; i < columns.front()->table.position.size(); ++i) {
      text += fmt::format("{:.6f}", columns.front()->table.position[i] / kMetrePerMillimetre);
      for (const SampledTable* column : columns) text += error_mm(column->table.forward[i]);
      text += '\n';
    }
  }
  return text;
}

std::string isg_grid(const CorrectionGrid& grid) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "X Y Z EXX EYY EZZ\n");
  for_each_node(grid.nodes, [&](std::size_t index, const AxisPosition& node) {
    fmt::format_to(out, "{:.6f} {:.6f} {:.6f}", node[0] / kMetrePerMillimetre, node[1] / kMetrePerMillimetre,
                   node[2] / kMetrePerMillimetre);
    for (const double component : grid.mean[index]) fmt::format_to(out, "{}", error_mm(component));
    fmt::format_to(out, "\n");
  });
  return fmt::to_string(text);
}

bool has_reversal_lists(const TableFormatOptions& options) {
  return is_first_word(kIsgSettings, options, "reversal", "lists", "none") &&
         options.type.has(CompensationPart::Positioning);
}

/// What positioning along the specific lines leaves of the mean of both directions.
std::vector<TableFile> isg_reversal_lists(const FitResult& result, TableFormatOptions options) {
  options.type = CompensationPart::Positioning;
  std::vector<TableFile> files;
  for (const SampledTable& sampled : sample_axis_tables(isg_ssfk_format(), result, options)) {
    AxisTable half = sampled.table;
    for (std::size_t i = 0; i < half.position.size(); ++i) {
      half.forward[i] = 0.5 * (sampled.table.forward[i] - sampled.table.backward[i]);
      half.backward[i] = -half.forward[i];
    }
    files.push_back(ssfk_file(sampled.output, half));
  }
  return files;
}

std::vector<TableFile> write_isg(const FitResult& result, const TableFormatOptions& options) {
  std::string content = options.type.is_separable()
                            ? isg_axis_blocks(sample_axis_tables(isg_csv_format(), result, options))
                            : isg_grid(sample_grid(isg_csv_format(), result, options));
  std::vector<TableFile> files = {{std::string(kIsgList), isg_list(result.machine)},
                                  {std::string(kIsgFile), std::move(content)}};
  if (has_reversal_lists(options))
    std::ranges::move(isg_reversal_lists(result, options), std::back_inserter(files));
  return files;
}

/// One block of a file: arguments, parameters, rows.
class IsgBlock {
 public:
  explicit IsgBlock(const TableLines& lines) {
    for (const std::string_view name : words_of(lines.current())) add_column(lines, name);
    if (arguments_.empty() || parameters_.empty())
      lines.fail("the header needs arguments and errors", "write X EXX EYX, or X Y Z EXX EYY EZZ");
  }

  void add_row(const TableLines& lines) {
    const auto words = words_of(lines.current());
    if (words.size() != arguments_.size() + parameters_.size())
      lines.fail(fmt::format("the row has {} numbers, the header {} names", words.size(),
                             arguments_.size() + parameters_.size()),
                 "complete or delete the row");
    std::array<double, 3> point{};
    Eigen::Vector3d correction = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < arguments_.size(); ++i)
      point[index_of(arguments_[i])] = lines.number(words[i], "the position") * kMetrePerMillimetre;
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      correction[parameters_[i]] -=
          lines.number(words[arguments_.size() + i], "the error") * kMetrePerMillimetre;
    points_.push_back(point);
    places_.push_back(lines.place());
    grid_.mean.push_back(correction);
  }

  CorrectionTerm term(const TableLines& lines) && {
    if (points_.empty()) lines.fail("the block has no row", "write the tables again");
    grid_.nodes = grid_nodes(points_, places_);
    return grid_term(std::move(grid_));
  }

 private:
  void add_column(const TableLines& lines, std::string_view name) {
    const auto axis = name.size() == 1 ? axis_from_letter(name[0]) : std::nullopt;
    const auto symbol = ErrorSymbol::parse(name);
    if (axis && !is_rotary(*axis) && parameters_.empty()) {
      arguments_.push_back(*axis);
    } else if (symbol && !is_rotation(symbol->component) && !is_rotary(symbol->axis)) {
      parameters_.push_back(direction_of(symbol->component));
    } else {
      lines.fail(fmt::format("column {} is not read here", std::string(name.substr(0, 20))),
                 "arguments X Y Z first, then displacements EXX ... EZZ; angles need the controller's "
                 "kinematic model");
    }
  }

  std::vector<AxisName> arguments_;
  std::vector<int> parameters_;  ///< direction 0..2
  std::vector<std::array<double, 3>> points_;
  std::vector<SourcePlace> places_;
  CorrectionGrid grid_;
};

/// Keys of the list that change what the tables mean must have the values written here.
void check_isg_list(const TableFile& file) {
  TableLines lines(file);
  std::map<std::string, std::string> values;
  while (lines.advance_to_content()) {
    const auto words = words_of(lines.current());
    if (words[0].front() == '#') continue;
    if (words.size() != 2) lines.fail("the line is no key and value", "write a key, a blank and its value");
    const std::string key(words[0]);
    if (!values.emplace(key, std::string(words[1])).second)
      lines.fail("key " + key.substr(0, 40) + " is given twice", "delete one");
    const bool known = key == "X" || key == "Y" || key == "Z" || key == "workpiece_axes" ||
                       key == "interpolation" || key == "file[0]" || key == "file_format[0]";
    if (!known) lines.fail("key " + key.substr(0, 40) + " is not read here", "remove it to check the tables");
  }
  const std::pair<const char*, std::string> expected[] = {{"workpiece_axes", "0"},
                                                          {"interpolation", "GRID"},
                                                          {"file[0]", std::string(kIsgFile)},
                                                          {"file_format[0]", "ISG_CSV"}};
  for (const auto& [key, value] : expected) {
    if (values[key] != value)
      throw InputError({file.name, 0}, std::string(key) + " is \"" + values[key].substr(0, 40) + "\"",
                       "write " + std::string(key) + " " + value);
  }
}

CompensationTables read_isg(std::span<const TableFile> files) {
  check_isg_list(file_named(files, kIsgList));
  TableLines lines(file_named(files, kIsgFile));
  CompensationTables result;
  std::optional<IsgBlock> block;
  while (lines.advance_to_content()) {
    const std::string_view line = trimmed_text(lines.current());
    if (line.starts_with("//")) continue;
    if (line.front() == '#') {
      if (!block) lines.fail("# stands where a header is expected", "write # between two blocks only");
      result.terms.push_back(std::move(*block).term(lines));
      block.reset();
    } else if (!block) {
      block.emplace(lines);
    } else {
      block->add_row(lines);
    }
  }
  if (!block) lines.fail("the last block is missing", "write a header and rows");
  result.terms.push_back(std::move(*block).term(lines));
  std::ranges::move(ssfk_terms(files), std::back_inserter(result.terms));
  return result;
}

}  // namespace

const TableFormat& isg_csv_format() {
  static const TableFormat format = {
      .name = "isg-csv",
      .summary =
          "volumetric compensation of the ISG kernel and Beckhoff TwinCAT TF5280, ISG_CSV: displacements "
          "of the functional point by axis, or on a grid of X Y Z; volcomp.lis names the axes",
      .source =
          "Beckhoff, TF5280 TwinCAT 3 CNC Volumetric compensation: ISG CSV format, Units of measure (mm), "
          "Interpolation mode GRID (linear); names of ISO 230-1, so errors",
      .verified =
          "read back by volcal; not tried on a controller, and that the control subtracts the errors "
          "follows from their names only: move one axis over one large value first",
      .supported = CompensationType::volumetric(),
      .refusal = "it holds every type of the linear axes",
      .limits = {.resolution = 1e-12},
      .settings = kIsgSettings,
      .write = write_isg,
      .read = read_isg};
  return format;
}

}  // namespace volcal
