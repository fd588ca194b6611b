#pragma once
/// Which error contributes how much to the error of the volume: every contribution of the error field over
/// the travel of the linear axes, approached from both sides, after the best rigid motion, which a frame's
/// alignment takes up (ISO/TR 16907:2015, 11; the error budget of Slocum).
///
/// Shares are <e_c, e> / <e, e> over the volume, e the whole error: they sum to 1, and a contribution that
/// cancels part of the others has a negative one.

#include <string>
#include <vector>

#include "volcal/identify/errors/error_field.h"

namespace volcal {

struct BudgetLine {
  std::string name;        ///< of the contribution, or of the cause
  std::string depends_on;  ///< of a contribution
  double rms = 0.0;        ///< of the displacement, m
  double max = 0.0;        ///< m
  double share = 0.0;      ///< of the mean square of the whole error
  double u_rms = 0.0;      ///< root mean square of the standard uncertainty of the contribution, m
};

struct ErrorBudget {
  BudgetLine total;
  std::vector<BudgetLine> contributions;  ///< largest RMS first
  std::vector<BudgetLine> causes;  ///< positioning, straightness, squareness, angles ...; largest first
};

/// `per_axis` positions on every linear axis, ends of travel included; rotary axes at 0.
ErrorBudget error_budget(const FitResult& result, const Tool& tool, const Conditions& conditions,
                         int per_axis);

}  // namespace volcal
