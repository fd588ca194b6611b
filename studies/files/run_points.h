#pragma once
/// Commanded positions of a run in a CSV file: x_mm, y_mm, z_mm; optional a_deg, b_deg, c_deg (0), dir_x ...
/// (0), line (0), run (0). Other columns are ignored, so that the readings of a campaign or of a plan can be
/// given.

#include <string>
#include <vector>

#include "volcal/model/description/errors.h"
#include "volcal/sim/study.h"

namespace volcal {

/// Throws InputError with file, line, problem and remedy. `named_at`: what names the file.
std::vector<sim::CommandedPoint> read_run_points(const std::string& path, const SourcePlace& named_at);
/// The same from text; `file` names it in errors.
std::vector<sim::CommandedPoint> parse_run_points(const std::string& text, const std::string& file);

}  // namespace volcal
