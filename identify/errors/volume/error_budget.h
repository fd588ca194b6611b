#pragma once
/// Which error contributes how much to the error of the volume: every contribution of the error field over
/// the travel of the linear axes, approached from both sides, and of the rotary axes that were identified, at
/// places without a period (volume_points.h), after the best rigid motion in workpiece coordinates, which a
/// frame's alignment takes up (ISO/TR 16907:2015, 11; the error budget of Slocum).
///
/// Shares are <e_c, e> / <e, e> over the volume, e the whole error: they sum to 1, and a contribution that
/// cancels part of the others has a negative one. Uncertainties are of the same displacements, correlations
/// of the parameters included: u^2 = trace(C M) (volume_moments.h), and of curves and surfaces what has faded
/// out at the stated conditions (faded_in_volume.h). Expected shares are (<e_c, e> + u_c^2) /
/// (<e, e> + u^2); they sum to 1 where the contributions are uncorrelated, as at the design stage.

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_field.h"

namespace volcal {

/// The cause that stands for all effects of a model together.
inline constexpr const char* kCauseOfEffects = "effects beyond the rigid body";

struct BudgetLine {
  std::string name;                        ///< of the contribution, or of the cause
  std::optional<ErrorSource> source = {};  ///< of a contribution
  std::vector<Variable> depends_on = {};   ///< of a contribution
  double rms = 0.0;                        ///< of the displacement, m
  double max = 0.0;                        ///< at these places and at the ends of travel, m
  double share = 0.0;                      ///< of the mean square of the whole error
  double u_rms = 0.0;           ///< root mean square of the standard uncertainty of the contribution, m
  double expected_share = 0.0;  ///< of the mean square that is expected with the uncertainty

  /// "y", "z dir_y", "x T_column"; empty for a constant and a cause.
  std::string depends_on_text() const;
  /// Root of the mean square that is expected with the uncertainty, m.
  double expected_rms() const { return std::hypot(rms, u_rms); }
};

struct ErrorBudget {
  BudgetLine total;
  std::vector<BudgetLine> contributions;  ///< largest RMS first
  std::vector<BudgetLine> causes;  ///< positioning, straightness, squareness, angles ...; largest first
  /// RMS of the whole error that 95 % of such machines do not exceed, m: of normally distributed parameters
  /// whose expectation is no error; 0 where there is an expected error or no uncertainty.
  double rms_95 = 0.0;
  std::vector<AxisName> turned;   ///< rotary axes over whose travel it is
  std::vector<AxisName> at_rest;  ///< rotary axes at 0 in all poses, whose errors away from 0 are not in it
};

/// Where rotary axes stand in the poses of a budget.
enum class RotaryPoses {
  AtRest,     ///< at 0, as tables of linear axes take them
  OverTravel  ///< those with errors over their travel, a turn at most; others at 0
};

/// At spread_places() of `cells_per_axis`. Rotary axes take a position of their own at each of these places
/// and directions of approach, spread evenly over their travel.
ErrorBudget error_budget(const FitResult& result, const Tool& tool, const Conditions& conditions,
                         int cells_per_axis, RotaryPoses rotary = RotaryPoses::OverTravel);

}  // namespace volcal
