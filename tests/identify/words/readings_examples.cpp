// Readings and their noise.

#include "tests/identify/words/finding_examples.h"

namespace volcal {
namespace {

Finding rows_repeated(bool at_other_times) {
  return {FindingCode::ReadingsRowsRepeated,
          {{"setup", "X"},
           {"file", "line.csv"},
           {"repeats", std::int64_t{5}},
           {"rows", std::int64_t{10}},
           {"line", std::int64_t{7}},
           {"first_line", std::int64_t{2}},
           {"at_other_times", at_other_times}}};
}

}  // namespace

std::vector<WordedFinding> examples_of_readings() {
  return {
      {{FindingCode::ReadingsColumnsUnused,
        {{"setup", "X"}, {"file", "line.csv"}, {"columns", Texts{"Remark"}}}},
       "setup \"X\": Remark of line.csv is not read"},
      {{FindingCode::ReadingsColumnsUnused,
        {{"setup", "X"},
         {"file", "line.csv"},
         {"columns", Texts{"t \"ms\"", "Remark"}},
         {"meant", Texts{"time_s"}},
         {"meant_columns", Texts{"t \"ms\""}},
         {"milliseconds", true}}},
       "setup \"X\": t \"ms\", Remark of line.csv are not read; to read what is meant, add columns = { "
       "time_s = \"t \\\"ms\\\"\" } and scale = { time_s = 0.001 }"},
      {rows_repeated(false),
       "setup \"X\" (line.csv): 5 of 10 rows repeat an earlier row in every column, line 7 that of line 2: "
       "each counts as a measurement of its own; remove the copies"},
      {rows_repeated(true),
       "setup \"X\" (line.csv): 5 of 10 rows repeat an earlier row in all but its time, line 7 that of line "
       "2: "
       "each counts as a measurement of its own; remove the copies, unless the readings were computed "
       "without "
       "noise"},
      {{FindingCode::ReadingsAgainstDirection,
        {{"setup", "X"},
         {"file", "line.csv"},
         {"against", std::int64_t{9}},
         {"moves", std::int64_t{10}},
         {"axis", "X"},
         {"column", "dir_x"}}},
       "setup \"X\" (line.csv): 9 of 10 moves of X go against dir_x: if its sign is reversed add scale = { "
       "dir_x = -1 }"},
      {{FindingCode::ReadingsTimesFarApart,
        {{"setup", "X"},
         {"file", "line.csv"},
         {"step", FindingNumber{5000.0, "s"}},
         {"span", FindingNumber{146880.0, "s"}}}},
       "setup \"X\" (line.csv): its readings are 5000 s apart and span 1.7 days: if the times are in "
       "milliseconds add scale = { time_s = 0.001 }"},
      {{FindingCode::ReadingsMovesTooFast,
        {{"setup", "X"}, {"file", "line.csv"}, {"speed", FindingNumber{12.4, "m/s"}}}},
       "setup \"X\" (line.csv): by its times the machine moved at 12 m/s between readings: are they in "
       "minutes, hours or days? add scale = { time_s = 60.0 }, 3600.0 or 86400.0"},
      {{FindingCode::ReadingsAnglesMisread,
        {{"setup", "S1"},
         {"file", "s1.csv"},
         {"columns", Texts{"b_deg", "c_deg"}},
         {"factors", std::vector<FindingNumber>{{-1.0}, {57.29577951308232}}},
         {"miss", FindingNumber{0.3104, "mm", 1e-3}},
         {"better", FindingNumber{0.00021, "mm", 1e-3}}}},
       "setup \"S1\" (s1.csv): its positions miss what the instrument allows by 310.4 mm, with b_deg "
       "reversed, c_deg in radians by 0.2 mm: if so add scale = { b_deg = -1, c_deg = 57.2957795131 }"},
      {{FindingCode::ReadingsPositionsMisread,
        {{"setup", "S1"}, {"file", "s1.csv"}, {"miss", FindingNumber{0.1053, "mm", 1e-3}}}},
       "setup \"S1\" (s1.csv): with its tool the nominal tool point scatters by 105.3 mm where it stands at "
       "one sphere: are its positions those of the machine's axes (a control with tool centre point motion "
       "shows others), is the tool the right one?"},
      {{FindingCode::ReadingsAnglesInRadians,
        {{"setup", "C"}, {"file", "c.csv"}, {"columns", Texts{"c_deg"}}}},
       "setup \"C\" (c.csv): c_deg holds values that are not round in degrees but are whole degrees if it is "
       "in radians: if so add scale = { c_deg = 57.2957795131 }"},
      {{FindingCode::ReadingsMisread,
        {{"setups", std::vector<std::string>{"A", "B"}},
         {"columns", std::vector<std::string>{"dx_um", "dy_um"}},
         {"factor", FindingNumber{-1.0}}}},
       "setups \"A\", \"B\": the other readings expect their dx_um, dy_um with the opposite sign: if so add "
       "scale = { dx_um = -1, dy_um = -1 }"},
      {{FindingCode::ReadingsMisread,
        {{"setups", std::vector<std::string>{"A"}},
         {"columns", std::vector<std::string>{"deviation_um"}},
         {"factor", FindingNumber{1000.0}}}},
       "setup \"A\": the other readings expect its deviation_um 1000 times as large: if so add scale = { "
       "deviation_um = 1000 }"},
      {{FindingCode::ReadingsDuplicated, {{"setup", "X2"}, {"first_setup", "X"}}},
       "setups \"X\" and \"X2\" hold the same readings: they count twice; remove one of them"},
      {{FindingCode::ReadingsDirectionsDerived,
        {{"columns", Texts{"dir_x", "dir_y"}}, {"setups", Texts{"X"}}}},
       "directions of approach that the files do not record (dir_x, dir_y in X) follow from the order of the "
       "readings along each line; if they do not stand in the order in which they were measured, set "
       "directions = \"as-recorded\""},
      {{FindingCode::ReadingsHalfTurns,
        {{"readings", std::int64_t{4}}, {"axis", "C"}, {"column", "dir_c"}, {"setups", Texts{"R"}}}},
       "half a turn of C goes either way: the direction of approach of 4 readings after it in R is not "
       "known; "
       "add the column dir_c"},
      {{FindingCode::MachineCentreAssumed, {{"axes", Texts{"C"}}}},
       "the machine file does not say where the line of C is: it is taken to pass through the machine's "
       "origin; state a point of it, centre_mm below [axes.C]"},
      {{FindingCode::MachineCentreAssumed, {{"axes", Texts{"C", "A"}}}},
       "the machine file does not say where the lines of C, A are: they are taken to pass through the "
       "machine's origin; state a point of each, centre_mm below [axes.C]"},
      {{FindingCode::ReadingsLeftOut, {{"setup", "X"}, {"rows", Integers{8}}, {"reason", "slip"}}},
       "setup \"X\" leaves out row 8: slip"},
      {{FindingCode::ReadingsLeftOut, {{"setup", "X"}, {"rows", Integers{8, 9, 10}}, {"reason", "slip"}}},
       "setup \"X\" leaves out rows 8, 9, 10: slip"},
      {{FindingCode::ReadingsFlagged, {{"readings", std::int64_t{3}}, {"some_removed", false}}},
       "3 readings are flagged by the w-test and still in the adjustment; they are listed in residuals.csv "
       "(--outliers remove takes them out)"},
      {{FindingCode::ReadingsFlagged, {{"readings", std::int64_t{3}}, {"some_removed", true}}},
       "3 readings are flagged by the w-test and still in the adjustment; they are listed in residuals.csv "
       "(so many were removed before that the model or the stated noise must be in doubt: run `volcal "
       "compare`)"},
      {{FindingCode::ReadingsRemoved, {{"readings", std::int64_t{4}}}},
       "4 readings were removed by the w-test; they are listed in residuals.csv"},
      {{FindingCode::NoiseSigmaContradicted, {{"instrument", "ball-bar"}, {"times", FindingNumber{1.3149}}}},
       "ball-bar: its residuals scatter 1.31 times as much as its stated sigma; weights and uncertainties "
       "use the estimated value"},
      {{FindingCode::NoiseSigmaContradicted,
        {{"instrument", "ball-bar"},
         {"times", FindingNumber{988.0}},
         {"unit_slip", true},
         {"independent_part", true}}},
       "ball-bar: the independent part of its residuals scatters 988 times as much as its stated sigma; "
       "weights and uncertainties use the estimated value; is its noise stated in a unit 1000 times too "
       "small (nm for um)? check the noise table of its setups and the unit of the readings"},
      {{FindingCode::NoiseSigmaContradicted,
        {{"instrument", "r-test"}, {"times", FindingNumber{0.00102}}, {"too_quiet", true}}},
       "r-test: its residuals scatter 0.00102 times as much as its stated sigma; weights and uncertainties "
       "use the estimated value; an instrument's readings hardly scatter so little: are they in a larger "
       "unit than their columns say (mm for um, then add scale = { COLUMN = 1000 } to its setups), or were "
       "they computed?"},
      {{FindingCode::NoiseSigmaContradicted,
        {{"instrument", "ball-bar"}, {"times", FindingNumber{5.0}}, {"hardly_noise", true}}},
       "ball-bar: its residuals scatter 5 times as much as its stated sigma; weights and uncertainties use "
       "the estimated value; the instrument alone hardly explains this: the model may lack an effect, or the "
       "noise table may be wrong"},
      {{FindingCode::NoiseMoreThanWhite,
        {{"instrument", "laser-tracer"},
         {"drift", FindingNumber{0.41e-6, "um", 1e-6}},
         {"drift_time", FindingNumber{580.2, "s"}},
         {"line_offsets", FindingNumber{0.3e-6, "um", 1e-6}},
         {"per_metre", FindingNumber{0.2e-6, "um/m", 1e-6}}}},
       "laser-tracer: its noise is not independent (correlated drift of 0.41 um over 580 s, offsets of lines "
       "of 0.3 um, 0.2 um/m in proportion to length); weights and uncertainties allow for it"},
      {{FindingCode::NoiseSeveralTimesStated,
        {{"instrument", "laser-tracer"}, {"times", FindingNumber{3.456}}}},
       "laser-tracer: all its noise together is 3.46 times what is stated; the instrument alone hardly "
       "explains this: the model may lack an effect, or the noise table may be wrong"},
      {{FindingCode::NoiseTakenAsIndependent},
       "robust loss: readings are taken as independent; correlated drift and offsets of lines were not "
       "looked for"},
  };
}

}  // namespace volcal
