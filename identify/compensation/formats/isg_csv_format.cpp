#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <utility>

#include "volcal/identify/compensation/formats/isg_chain.h"
#include "volcal/identify/compensation/formats/isg_ssfk_lists.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& isg_csv_format();

namespace {

constexpr std::string_view kIsgList = "volcomp.lis";
constexpr std::string_view kIsgFile = "volcomp.csv";

constexpr std::string_view kIsgRelative = "// workpiece side: errors of the tool relative to the workpiece";
constexpr std::string_view kIsgComponent = "// workpiece side: error motions of the axes themselves";

constexpr std::array<TableSetting, 2> kIsgSettings = {
    {{"workpiece_errors",
      "relative or component: with types of rotary axes on a machine with axes on the workpiece side, "
      "whether "
      "the control takes their error motions as those of the tool relative to the workpiece or as those of "
      "the axis itself, which are minus these; not confirmed publicly: enter one large EXC of a table alone "
      "and look which way X moves at 0 degrees: towards - means relative",
      "", "relative"},
     {"reversal",
      "lists or none: with lists, what positioning of every axis differs by towards + and towards - as "
      "leadscrew lists (isg-ssfk) beside the volumetric tables, which know no direction, where the type has "
      "L-POS; for axes that have no leadscrew compensation of their own",
      "none", "lists"}}};

bool has_rotary_blocks(const TableFormatOptions& options) { return !options.type.rotary().empty(); }

/// Whether error motions on the workpiece side are those of the axes themselves.
bool is_of_component(const Machine& machine, const TableFormatOptions& options) {
  const auto& joints = machine.structure.joints;
  if (!has_rotary_blocks(options) || std::ranges::none_of(joints, &Joint::workpiece_side)) return false;
  return is_first_word(kIsgSettings, options, "workpiece_errors", "component", "relative");
}

/// -1 for the axes whose errors are written as those of the axis itself.
using IsgSigns = std::function<double(AxisName)>;

IsgSigns isg_signs(const Machine& machine, const TableFormatOptions& options) {
  const bool component = is_of_component(machine, options);
  return [structure = machine.structure, component](AxisName axis) {
    return component && structure.is_on_workpiece_side(axis) ? -1.0 : 1.0;
  };
}

/// Without errors of rotary axes all axes count as tool axes: displacements alone are written, and they add
/// whatever carries the axis.
std::string isg_list(const Machine& machine, bool chain) {
  std::string text = chain ? isg_chain_lines(machine) : "workpiece_axes 0\n";
  int number = 0;
  for (const AxisName axis : kAllAxes) {
    if (machine.has_axis(axis) && (chain || !is_rotary(axis)))
      text +=
          fmt::format("{} {}\n", letter_of(axis), is_rotary(axis) ? ++number + 3 : direction_of(axis) + 1);
  }
  return text + fmt::format("interpolation GRID\nfile[0] {}\nfile_format[0] ISG_CSV\n", kIsgFile);
}

/// Errors: minus the corrections, mm.
std::string error_mm(double correction) {
  return fmt::format(" {:.9f}", without_negative_zero(-correction) / kMetrePerMillimetre);
}

/// One block per axis: its position, then the displacements that it causes.
std::string isg_axis_blocks(const std::vector<SampledTable>& tables, const IsgSigns& sign) {
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
      for (const SampledTable* column : columns) text += error_mm(sign(input) * column->table.forward[i]);
      text += '\n';
    }
  }
  return text;
}

std::string isg_grid(const CorrectionGrid& grid, const IsgSigns& sign) {
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "X Y Z EXX EYY EZZ\n");
  for_each_node(grid.nodes, [&](std::size_t index, const AxisPosition& node) {
    fmt::format_to(out, "{:.6f} {:.6f} {:.6f}", node[0] / kMetrePerMillimetre, node[1] / kMetrePerMillimetre,
                   node[2] / kMetrePerMillimetre);
    for (const AxisName axis : kLinearAxes)
      fmt::format_to(out, "{}", error_mm(sign(axis) * grid.mean[index][direction_of(axis)]));
    fmt::format_to(out, "\n");
  });
  return fmt::to_string(text);
}

constexpr ApproachDirection kTowardsMinus = {-1, -1, -1, -1, -1, -1, -1, -1, -1};

bool has_reversal_lists(const TableFormatOptions& options) {
  return is_first_word(kIsgSettings, options, "reversal", "lists", "none") &&
         options.type.has(CompensationPart::Positioning);
}

/// What positioning along the specific lines differs by from the mean of both directions, which the tables
/// hold: both are zero at home, the lists approached towards +.
std::vector<TableFile> isg_reversal_lists(const FitResult& result, TableFormatOptions options) {
  options.type = CompensationPart::Positioning;
  std::vector<TableFile> files;
  for (const SampledTable& sampled : sample_axis_tables(isg_ssfk_format(), result, options)) {
    const double at_home = -0.5 * sampled.table.value(home_of(result.machine), kTowardsMinus);
    AxisTable differing = sampled.table;
    for (std::size_t i = 0; i < differing.position.size(); ++i) {
      const double half = 0.5 * (sampled.table.forward[i] - sampled.table.backward[i]);
      differing.forward[i] = half - at_home;
      differing.backward[i] = -half - at_home;
    }
    files.push_back(ssfk_file(sampled.output, differing));
  }
  return files;
}

/// Of the linear axes' types, then of the rotary axes'.
std::string isg_blocks(const FitResult& result, const TableFormatOptions& options) {
  const IsgSigns sign = isg_signs(result.machine, options);
  std::string text;
  if (!options.type.is_separable()) {
    text = isg_grid(sample_grid(isg_csv_format(), result, options), sign);
  } else if (!options.type.linear().empty()) {
    text = isg_axis_blocks(sample_axis_tables(isg_csv_format(), result, options), sign);
  }
  if (!has_rotary_blocks(options)) return text;
  const bool component = is_of_component(result.machine, options);
  for (const std::string& block : isg_rotary_blocks(isg_csv_format(), result, options, component))
    text += (text.empty() ? "" : "#\n") + block;
  return std::string(component ? kIsgComponent : kIsgRelative) + "\n" + text;
}

/// A grid, the list of axes and the chain are of X, Y and Z.
void require_three_axes(const Machine& machine) {
  if (machine.main_linear_axes().size() == kLinearAxes.size()) return;
  throw InputError({}, "isg-csv: the volumetric compensation needs the three linear axes X, Y and Z",
                   "write --format isg-ssfk, which holds L-POS of every axis, or csv, which holds the errors "
                   "of every axis");
}

std::vector<TableFile> write_isg(const FitResult& result, const TableFormatOptions& options) {
  require_three_axes(result.machine);
  std::vector<TableFile> files = {
      {std::string(kIsgList), isg_list(result.machine, has_rotary_blocks(options))},
      {std::string(kIsgFile), isg_blocks(result, options)}};
  if (has_reversal_lists(options))
    std::ranges::move(isg_reversal_lists(result, options), std::back_inserter(files));
  return files;
}

/// One block of a file: arguments, parameters, rows.
class IsgBlock {
 public:
  IsgBlock(const TableLines& lines, IsgSigns sign) : sign_(std::move(sign)) {
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
      correction[direction_of(parameters_[i].component)] -=
          sign_(parameters_[i].axis) * lines.number(words[arguments_.size() + i], "the error") *
          kMetrePerMillimetre;
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
    if (axis && !is_rotary(*axis) && !is_parallel(*axis) && parameters_.empty()) {
      arguments_.push_back(*axis);
    } else if (symbol && !is_rotation(symbol->component) && !is_rotary(symbol->axis) &&
               !is_parallel(symbol->axis)) {
      parameters_.push_back(*symbol);
    } else {
      lines.fail(
          fmt::format("column {} is not read here", std::string(name.substr(0, 20))),
          "arguments X Y Z first, then displacements EXX ... EZZ; errors of rotary axes need a chain in "
          "volcomp.lis");
    }
  }

  std::vector<AxisName> arguments_;
  std::vector<ErrorSymbol> parameters_;
  IsgSigns sign_;
  std::vector<std::array<double, 3>> points_;
  std::vector<SourcePlace> places_;
  CorrectionGrid grid_;
};

/// Keys of the list that change what the tables mean must have the values written here.
std::map<std::string, std::string> read_isg_list(const TableFile& file) {
  TableLines lines(file);
  std::map<std::string, std::string> values;
  while (lines.advance_to_content()) {
    const auto words = words_of(lines.current());
    if (words[0].front() == '#') continue;
    if (words.size() != 2)
      lines.fail("the line is not a key and a value", "write a key, a blank and its value");
    const std::string key(words[0]);
    if (!values.emplace(key, std::string(words[1])).second)
      lines.fail("key " + key.substr(0, 40) + " is given twice", "delete one");
    const bool axis = key.size() == 1 && std::string_view("XYZABC").find(key) != std::string_view::npos;
    const bool known = axis || key == "workpiece_axes" || key == "chain" || key == "interpolation" ||
                       key == "file[0]" || key == "file_format[0]";
    if (!known) lines.fail("key " + key.substr(0, 40) + " is not read here", "remove it to check the tables");
  }
  const std::pair<const char*, std::string> expected[] = {
      {"interpolation", "GRID"}, {"file[0]", std::string(kIsgFile)}, {"file_format[0]", "ISG_CSV"}};
  for (const auto& [key, value] : expected) {
    if (values[key] != value)
      throw InputError({file.name, 0}, std::string(key) + " is \"" + values[key].substr(0, 40) + "\"",
                       "write " + std::string(key) + " " + value);
  }
  return values;
}

/// Without a chain every axis is one of the tool.
std::optional<IsgChainReader> chain_in(std::map<std::string, std::string>& list, const TableFile& file,
                                       bool component) {
  const std::string& number = list["workpiece_axes"];
  const bool digit = number.size() == 1 && number[0] >= '0' && number[0] <= '6';
  const bool chain = list.contains("chain");
  if (!digit || (!chain && number != "0"))
    throw InputError({file.name, 0}, "workpiece_axes is \"" + number.substr(0, 40) + "\"",
                     chain ? "write how many axes of the chain are on the side of the workpiece"
                           : "write workpiece_axes 0, or the chain of axes as well");
  if (!chain) return std::nullopt;
  return IsgChainReader(list["chain"], number[0] - '0', component, {file.name, 0});
}

/// Blocks of an ISG_CSV file, each as a term.
class IsgFile {
 public:
  IsgFile(const TableFile& file, std::optional<IsgChainReader> chain, bool component)
      : lines_(file), chain_(std::move(chain)) {
    sign_ = [this, component](AxisName axis) {
      return component && chain_ && chain_->is_on_workpiece_side(axis) ? -1.0 : 1.0;
    };
  }
  IsgFile(const IsgFile&) = delete;
  IsgFile& operator=(const IsgFile&) = delete;

  std::vector<CorrectionTerm> read() {
    while (lines_.advance_to_content()) {
      const std::string_view line = trimmed_text(lines_.current());
      if (line.starts_with("//")) continue;
      if (line.front() == '#') {
        close("# stands where a header is expected", "write # between two blocks only");
      } else if (block_) {
        block_->add_row(lines_);
      } else if (of_chain_) {
        chain_->add_row(lines_);
      } else if (chain_ && chain_->opens(lines_)) {
        of_chain_ = true;
      } else {
        block_.emplace(lines_, sign_);
      }
    }
    close("the last block is missing", "write a header and rows");
    if (chain_) {
      if (auto term = chain_->term()) terms_.push_back(std::move(*term));
    }
    return std::move(terms_);
  }

 private:
  void close(const char* problem, const char* remedy) {
    if (!block_ && !of_chain_) lines_.fail(problem, remedy);
    if (of_chain_) chain_->close(lines_);
    if (block_) terms_.push_back(std::move(*block_).term(lines_));
    block_.reset();
    of_chain_ = false;
  }

  TableLines lines_;
  std::optional<IsgChainReader> chain_;
  IsgSigns sign_;
  std::optional<IsgBlock> block_;
  bool of_chain_ = false;
  std::vector<CorrectionTerm> terms_;
};

CompensationTables read_isg(std::span<const TableFile> files) {
  const TableFile& list = file_named(files, kIsgList);
  const TableFile& file = file_named(files, kIsgFile);
  std::map<std::string, std::string> keys = read_isg_list(list);
  const bool component = file.content.starts_with(kIsgComponent);
  std::optional<IsgChainReader> chain = chain_in(keys, list, component);
  if (chain && !component && !file.content.starts_with(kIsgRelative))
    throw InputError({file.name, 1},
                     "the first line does not say whose errors those of the workpiece side are",
                     fmt::format("write \"{}\" or \"{}\" there", kIsgRelative, kIsgComponent));
  CompensationTables result;
  result.terms = IsgFile(file, std::move(chain), component).read();
  std::ranges::move(ssfk_terms(files), std::back_inserter(result.terms));
  return result;
}

}  // namespace

const TableFormat& isg_csv_format() {
  static const TableFormat format = {
      .name = "isg-csv",
      .summary =
          "volumetric compensation of the ISG kernel and Beckhoff TwinCAT TF5280, ISG_CSV: displacements "
          "of the functional point by axis, or on a grid of X Y Z; of rotary axes centres, location errors "
          "X0C ... C0C and error motions EXC ... ECC, which the linear axes correct; volcomp.lis names the "
          "axes and their chain",
      .source =
          "Beckhoff, TF5280 TwinCAT 3 CNC Volumetric compensation: ISG CSV format, Units of measure (mm, "
          "rad, "
          "positions of rotary axes in deg), List of parameters supported, Interpolation mode GRID (linear), "
          "chain (P-VOLC-00007), workpiece_axes (P-VOLC-00008); names of ISO 230-1, so errors",
      .verified =
          "read back by volcal; not tried on a controller, and that the control subtracts the errors "
          "follows from their names only: move one axis over one large value first. Of rotary axes it is "
          "inferred, not stated, that the chain begins at the workpiece, that error motions stand in the "
          "stator and that location errors are relative to the carrying axis",
      .supported = CompensationType::volumetric(),
      .rotary = CompensationType::rotary_volumetric(),
      .refusal = "it holds every type of the linear axes",
      .limits = {.resolution = 1e-12},
      .settings = kIsgSettings,
      .write = write_isg,
      .read = read_isg};
  return format;
}

}  // namespace volcal
