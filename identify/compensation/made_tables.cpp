#include "volcal/identify/compensation/made_tables.h"

#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

/// What was identified and is in none of these tables, or partly.
std::vector<Finding> left_out_by(CompensationType type, const FitResult& result) {
  std::vector<Finding> findings;
  for (const Finding& finding : errors_in_no_table(result)) {
    const bool of_rotary = finding.code == FindingCode::RotaryErrorsInNoTable;
    if (!of_rotary || type.rotary().empty()) {
      findings.push_back(finding);
    } else if (!type.contains(CompensationType::rotary_volumetric())) {
      findings.push_back({FindingCode::RotaryErrorsPartlyInTables,
                          {{"axis", finding.text("axis")}, {"type", type.rotary().name()}}});
    }
  }
  return findings;
}

}  // namespace

MadeTables make_tables(const TableFormat& format, const FitResult& result, const TableFormatOptions& options,
                       double tolerance) {
  MadeTables made;
  made.format = &format;
  made.options = options;
  check_table_options(format, result, made.options);
  const bool own_positions = format.positions_of_own && tolerance == 0.0;
  if (options.step == 0.0 && !own_positions) {
    made.tolerance = tolerance > 0.0 ? tolerance : kDefaultTableTolerance;
    made.step = choose_step(format, result, made.options, made.tolerance);
    made.options.step = made.step.step;
  }
  if (format.step_of != nullptr) made.options.step = format.step_of(made.options);
  made.files = write_tables(format, result, made.options);
  made.read_back = format.read(made.files);
  made.check = check_in_volume(result, made.options, made.read_back);
  made.rotary_check = check_rotary_axes(format, result, made.options, made.read_back);
  made.effects_left_out = left_out_by(made.options.type, result);
  return made;
}

}  // namespace volcal
