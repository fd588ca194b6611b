#include "volcal/identify/compensation/made_tables.h"

namespace volcal {

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
  made.effects_left_out = errors_in_no_table(result);
  return made;
}

}  // namespace volcal
