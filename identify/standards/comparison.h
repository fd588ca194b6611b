#pragma once
/// Where a model fails: the misfit of a campaign broken down by what a metrologist can act on. Residuals are
/// readings minus predictions; standardised by the record's sigma. SI.

#include <span>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

/// Size of the residuals of one kind (lengths in m, angles in rad).
struct ResidualSize {
  std::size_t count = 0;
  double mean = 0.0;  ///< signed, reading minus prediction; 0 without observations
  double rms = 0.0;   ///< 0 without observations
  double max = 0.0;   ///< of the absolute value
};

/// Observations that share something: a setup, a range of X, an approach ...
struct ComparisonCell {
  std::string label;
  std::size_t observations = 0;  ///< without removed ones
  double chi2 = 0.0;
  double dof = 0.0;  ///< expected chi2: sum of the redundancy numbers (1 each when the model was not fitted)
  ResidualSize lengths;
  ResidualSize angles;
  double probability = 1.0;  ///< of a chi2 at least this large when model and sigma are right
  bool significant =
      false;  ///< probability below the family risk divided by the number of cells (Bonferroni)
  /// Significantly worse than the rest of the campaign, whatever that is like: chi2 divided by the campaign's
  /// chi2/dof fails the same test.
  bool stands_out = false;

  double reduced_chi2() const { return dof > 0.0 ? chi2 / dof : 0.0; }
};

/// What the observations of a cell share.
struct Grouping {
  enum class Kind { Setup, Instrument, Tool, Position, Direction, Region, Line, Run, Time };
  Kind kind = Kind::Setup;
  AxisName axis = AxisName::X;  ///< of a position or direction of approach

  /// "setup", "instrument", "tool", "X", "direction of X", "region", "line", "run", "time"
  std::string name() const;
  friend bool operator==(const Grouping&, const Grouping&) = default;
};

struct Breakdown {
  Grouping by;
  std::vector<ComparisonCell> cells;  ///< natural order, empty cells left out
};

struct ComparisonOptions {
  int position_bins = 10;     ///< per axis, over its travel
  int time_bins = 10;         ///< over the campaign
  int region_blocks = 0;      ///< per linear axis; 0 = 3 when that leaves 30 observations per block, else 2
  std::size_t worst = 20;     ///< readings listed
  double family_risk = 0.05;  ///< chance that any cell of a right model is called significant
};

struct Comparison {
  ComparisonCell total;
  std::size_t removed = 0;  ///< observations that the adjustment left out; in no cell
  std::size_t cells = 0;    ///< tested, over all breakdowns
  std::vector<Breakdown> breakdowns;
  std::vector<std::size_t> worst;  ///< indices of records by falling |residual / sigma|, removed ones too

  const Breakdown* find(const Grouping& by) const;
  const ComparisonCell* find_cell(const Grouping& by, const std::string& label) const;
};

/// Breakdowns that would have a single cell (one tool, an axis that never moves, no time column) are left
/// out, except by setup.
Comparison compare(const Campaign& campaign, std::span<const ResidualRecord> records,
                   const ComparisonOptions& options = {});

}  // namespace volcal
