#pragma once
/// Numbers as the report writes them: edge units, few digits, so that the page stays small.

#include <string>
#include <vector>

#include "volcal/identify/report/page.h"
#include "volcal/model/description/units.h"

namespace volcal::report {

/// `value` with `digits` significant decimal digits, and a thousandth at least, so that no page that shows
/// fixed decimals invents one; not-a-number and infinity become null.
Json rounded(double value, int digits = 5);
/// Of a value that is shown with the decimals of its uncertainty.
inline constexpr int kDigitsBesideU = 12;
Json rounded_array(const std::vector<double>& values, double factor, int digits = 5);
/// A length in m as um; what is below a picometre is rounding and becomes 0.
Json rounded_micrometres(double metres, int digits = 4);
/// Lower triangle row by row, with the diagonal or without.
Json rounded_triangle(const Eigen::MatrixXd& symmetric, int digits, bool with_diagonal);
Json rounded_vector(const Eigen::Vector3d& vector, double factor, int digits = 5);

/// Edge units of an axis's position per m or rad.
double position_factor(AxisName axis);
std::string axis_letter(AxisName axis);
/// Of the axis of an error with a symbol; empty for an effect.
std::string axis_letter_of(const MachineError& error);
/// Unit as printed: "um/m/K" becomes "µm/(m K)", "urad/mm3" becomes "µrad/mm³".
std::string shown_unit(const std::string& edge_unit);

/// Entry of the rank report; nullptr when the error has none.
const Observability* find_observability(const FitResult& result, const MachineError& error);

}  // namespace volcal::report
