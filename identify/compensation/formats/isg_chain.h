#pragma once
/// Errors of rotary axes in files of the ISG kernel: the chain of axes in the list of the compensation, and
/// blocks of an ISG_CSV file with centres, location errors and error motions.
///
/// The control computes with its own kinematics: the letters of `chain` from the workpiece to the tool, the
/// first `workpiece_axes` of them on the side of the workpiece. P0X P0Y P0Z is the functional point with all
/// axes at 0, PXC PYC PZC the centre of C, mm; X0C ... C0C its location errors and EXC ... ECC its error
/// motions, mm and rad, by its position in deg. It moves linear axes alone: the position of the tool is
/// corrected, its orientation is not.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/compensation/table_format.h"

namespace volcal {

/// "chain CAXYZ" and "workpiece_axes 2", a line each.
std::string isg_chain_lines(const Machine& machine);

/// Blocks with the centres of all rotary axes and the rotary errors of the options' type. `component`: of
/// axes on the workpiece side, error motions of the component, minus those of the tool relative to it.
std::vector<std::string> isg_rotary_blocks(const TableFormat& format, const FitResult& result,
                                           const TableFormatOptions& options, bool component);

/// Takes the blocks of a file that it knows, and makes a term of them.
class IsgChainReader {
 public:
  /// `chain`: its letters; `workpiece_axes` of them on the side of the workpiece. Throws InputError.
  IsgChainReader(const std::string& chain, int workpiece_axes, bool component, const SourcePlace& place);

  /// Whether a header is that of a block for it; the block is then open.
  bool opens(const TableLines& lines);
  void add_row(const TableLines& lines);
  void close(const TableLines& lines);
  bool is_on_workpiece_side(AxisName axis) const;
  /// Nothing where no rotary axis has an error.
  std::optional<CorrectionTerm> term() const;

 private:
  void set_constant(const std::string& name, double value);

  Machine machine_;
  bool component_ = false;
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero();
  std::map<AxisName, std::map<Component, AxisTable>> motions_;
  std::array<std::array<double, 6>, kAxisCount> locations_{};
  bool holds_errors_ = false;

  std::vector<std::string> columns_;  ///< of the open block
  std::optional<AxisName> argument_;
  std::vector<double> positions_;
  std::vector<std::vector<double>> values_;  ///< per column behind the argument
};

}  // namespace volcal
