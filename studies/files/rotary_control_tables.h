#pragma once
/// The simulated control's reading of tables of rotary axes, the part of control_tables.cpp for them: apart
/// from the formats' own readers. A number or a word that is not there throws a std::logic_error.

#include <array>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/text/table_text.h"
#include "volcal/sim/machine/control.h"
#include "volcal/studies/files/control_words.h"

namespace volcal {

/// rotary_axis_corrections.csv and rotary_compensation_grid_*.csv of neutral-csv, where they are there.
void add_neutral_rotary_tables(std::span<const TableFile> files, sim::ControlTables& tables);

/// volcal.rotary of linuxcnc-grid, as volcalkins.c takes it.
void add_kins_rotary_tables(const TableFile& file, sim::ControlTables& tables);

/// pivots.hal of linuxcnc-trt, as trtfuncs.c takes its pins; what they replace stands in its comments.
void add_trt_pivots(const TableFile& file, sim::ControlTables& tables);

/// Volumetric compensation of the ISG kernel with a chain of axes (P-VOLC-00007, P-VOLC-00008): it computes
/// the position of the tool with centres, location errors and error motions, and corrects it by linear axes.
class IsgChainControl {
 public:
  /// `list`: volcomp.lis; `file`: volcomp.csv, whose first line says whose errors are meant.
  IsgChainControl(const std::string& list, const std::string& file);

  /// +1; -1 for error motions of an axis on the workpiece side where they are those of the axis itself.
  const std::array<double, kAxisCount>& signs() const { return signs_; }
  /// Whether a header is that of constants or of a rotary axis.
  bool opens(const Words& header);
  void add_row(const Words& row);
  void move_to(sim::ControlTables& tables);

 private:
  sim::ControlModel model_;
  std::array<double, kAxisCount> signs_{};
  Words header_;
};

}  // namespace volcal
