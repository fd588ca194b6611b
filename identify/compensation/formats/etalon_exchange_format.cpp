#include <fmt/format.h>

#include <set>
#include <utility>

#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

const TableFormat& etalon_exchange_format();

namespace {

constexpr std::string_view kEtalonFile = "volcomp.txt";

std::vector<TableFile> write_etalon(const FitResult& result, const TableFormatOptions& options) {
  std::string text;
  for (const SampledTable& sampled : sample_axis_tables(etalon_exchange_format(), result, options)) {
    const AxisTable& table = sampled.table;
    text += fmt::format("[E{}{}]\nGridpoints = {{\n", letter_of(sampled.output), letter_of(table.input));
    for (std::size_t i = 0; i < table.position.size(); ++i)
      text += fmt::format("{:.6f} {:.9f}\n", without_negative_zero(table.position[i] / kMetrePerMillimetre),
                          without_negative_zero(-table.forward[i]) / kMetrePerMillimetre);
    text += "}\n";
  }
  return {{std::string(kEtalonFile), std::move(text)}};
}

class EtalonReader {
 public:
  explicit EtalonReader(const TableFile& file) : lines_(file) {}

  CompensationTables read() {
    CompensationTables result;
    while (next()) result.terms.push_back(block());
    if (result.terms.empty()) lines_.fail("the file holds no error", "write a block [EXX]");
    return result;
  }

 private:
  /// Next line that is neither blank nor a comment, without a comment behind it.
  bool next() {
    while (lines_.advance_to_content()) {
      line_ = lines_.current();
      line_ = trimmed_text(line_.substr(0, line_.find("//")));
      if (!line_.empty()) return true;
    }
    line_ = {};
    return false;
  }

  ErrorSymbol symbol() {
    const bool closed = line_.size() > 2 && line_.front() == '[' && line_.back() == ']';
    const auto symbol =
        closed ? ErrorSymbol::parse(line_.substr(1, line_.size() - 2)) : std::optional<ErrorSymbol>();
    if (!symbol || is_rotation(symbol->component) || is_rotary(symbol->axis))
      lines_.fail("a block must begin with a displacement in brackets",
                  "write [EXX] ... [EZZ]; angles and location errors need the controller's kinematic model");
    if (!seen_.insert(*symbol).second) lines_.fail(symbol->name() + " is given twice", "delete one block");
    return *symbol;
  }

  CorrectionTerm block() {
    const ErrorSymbol error = symbol();
    if (!next() || line_ != "Gridpoints = {")
      lines_.fail("Gridpoints = { is missing below [" + error.name() + "]", "write Gridpoints = {");
    AxisTable table{.input = error.axis, .position = {}, .forward = {}, .backward = {}};
    while (next() && line_ != "}") {
      const auto words = words_of(line_);
      if (words.size() != 2) lines_.fail("a row needs a position and an error", "write two numbers");
      const double position = lines_.number(words[0], "the position") * kMetrePerMillimetre;
      require_ascending(table.position, position, lines_.place());
      table.position.push_back(position);
      table.forward.push_back(-lines_.number(words[1], "the error") * kMetrePerMillimetre);
    }
    if (line_ != "}") lines_.fail("the block of " + error.name() + " does not end", "write } below its rows");
    if (table.position.size() < 2) lines_.fail(error.name() + " has less than two rows", "add rows");
    table.backward = table.forward;
    return axis_term(kLinearAxes[static_cast<std::size_t>(direction_of(error.component))], std::move(table));
  }

  TableLines lines_;
  std::string_view line_;
  std::set<ErrorSymbol> seen_;
};

CompensationTables read_etalon(std::span<const TableFile> files) {
  return EtalonReader(file_named(files, kEtalonFile)).read();
}

}  // namespace

const TableFormat& etalon_exchange_format() {
  static const TableFormat format = {
      .name = "etalon-exchange",
      .summary =
          "ETALON_EXCHANGE file for the volumetric compensation of the ISG kernel and Beckhoff TwinCAT "
          "TF5280: one block per displacement of an axis",
      .source =
          "Beckhoff, TF5280 TwinCAT 3 CNC Volumetric compensation: Etalon Exchange Format, Units of measure "
          "(mm), Interpolation mode GRID (linear); names of ISO 230-1, so errors",
      .verified =
          "read back by volcal; not tried on a controller, and that the control subtracts the errors "
          "follows from their names only: move one axis over one large value first",
      .supported = CompensationType(CompensationPart::Positioning) | CompensationPart::Straightness |
                   CompensationPart::Squareness,
      .refusal =
          "its tables have one argument, and where the control puts the pivots of angular errors is not "
          "documented publicly; isg-csv holds them on a grid",
      .limits = {.resolution = 1e-12},
      .settings = {},
      .write = write_etalon,
      .read = read_etalon};
  return format;
}

}  // namespace volcal
