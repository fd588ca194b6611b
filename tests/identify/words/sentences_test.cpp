// Findings: every code has one name, one sentence and keeps its data in JSON.

#include "volcal/identify/words/sentences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <regex>
#include <set>
#include <stdexcept>

#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Texts = std::vector<std::string>;
using Integers = std::vector<std::int64_t>;
using Numbers = std::vector<FindingNumber>;

struct WordedFinding {
  Finding finding;
  std::string sentence;
};

/// One at least of every code.
const std::vector<WordedFinding>& examples() {
  static const std::vector<WordedFinding> all = {
      {verbatim("as it was"), "as it was"},
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
       "time_s = \"t "
       "\\\"ms\\\"\" } and scale = { time_s = 0.001 }"},
      {{FindingCode::ReadingsRowsRepeated,
        {{"setup", "X"},
         {"file", "line.csv"},
         {"repeats", std::int64_t{5}},
         {"rows", std::int64_t{10}},
         {"line", std::int64_t{7}},
         {"first_line", std::int64_t{2}},
         {"at_other_times", false}}},
       "setup \"X\" (line.csv): 5 of 10 rows repeat an earlier row in every column, line 7 that of line 2: "
       "each counts "
       "as a measurement of its own; remove the copies"},
      {{FindingCode::ReadingsAgainstDirection,
        {{"setup", "X"},
         {"file", "line.csv"},
         {"against", std::int64_t{9}},
         {"moves", std::int64_t{10}},
         {"axis", "X"},
         {"column", "dir_x"}}},
       "setup \"X\" (line.csv): 9 of 10 moves of X go against dir_x: if its sign is reversed add scale = { "
       "dir_x = -1 "
       "}"},
      {{FindingCode::ReadingsTimesFarApart,
        {{"setup", "X"},
         {"file", "line.csv"},
         {"step", FindingNumber{5000.0, "s"}},
         {"span", FindingNumber{146880.0, "s"}}}},
       "setup \"X\" (line.csv): its readings are 5000 s apart and span 1.7 days: if the times are in "
       "milliseconds add "
       "scale = { time_s = 0.001 }"},
      {{FindingCode::ReadingsMovesTooFast,
        {{"setup", "X"}, {"file", "line.csv"}, {"speed", FindingNumber{12.4, "m/s"}}}},
       "setup \"X\" (line.csv): by its times the machine moved at 12 m/s between readings: are they in "
       "minutes, hours "
       "or days? add scale = { time_s = 60.0 }, 3600.0 or 86400.0"},
      {{FindingCode::ReadingsAnglesMisread,
        {{"setup", "S1"},
         {"file", "s1.csv"},
         {"columns", Texts{"b_deg", "c_deg"}},
         {"factors", std::vector<FindingNumber>{{-1.0}, {57.29577951308232}}},
         {"miss", FindingNumber{0.3104, "mm", 1e-3}},
         {"better", FindingNumber{0.00021, "mm", 1e-3}}}},
       "setup \"S1\" (s1.csv): its positions miss what the instrument allows by 310.4 mm, with b_deg "
       "reversed, "
       "c_deg in radians by 0.2 mm: if so add scale = { b_deg = -1, c_deg = 57.2957795131 }"},
      {{FindingCode::ReadingsPositionsMisread,
        {{"setup", "S1"}, {"file", "s1.csv"}, {"miss", FindingNumber{0.1053, "mm", 1e-3}}}},
       "setup \"S1\" (s1.csv): with its tool the nominal tool point scatters by 105.3 mm where it stands at "
       "one "
       "sphere: are its positions those of the machine's axes (a control with tool centre point motion shows "
       "others), is the tool the right one?"},
      {{FindingCode::ReadingsAnglesInRadians,
        {{"setup", "C"}, {"file", "c.csv"}, {"columns", Texts{"c_deg"}}}},
       "setup \"C\" (c.csv): c_deg holds values that are not round in degrees but are whole degrees if it is "
       "in radians: if so add scale = { c_deg = 57.2957795131 }"},
      {{FindingCode::ReadingsMisread,
        {{"setups", std::vector<std::string>{"A", "B"}},
         {"columns", std::vector<std::string>{"dx_um", "dy_um"}},
         {"factor", FindingNumber{-1.0}}}},
       "setups \"A\", \"B\": the other readings expect their dx_um, dy_um with the opposite sign: if so add "
       "scale "
       "= { dx_um = -1, dy_um = -1 }"},
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
       "readings "
       "along each line; if they do not stand in the order in which they were measured, set directions = "
       "\"as-recorded\""},
      {{FindingCode::ReadingsLeftOut, {{"setup", "X"}, {"rows", Integers{8}}, {"reason", "slip"}}},
       "setup \"X\" leaves out row 8: slip"},
      {{FindingCode::ReadingsLeftOut, {{"setup", "X"}, {"rows", Integers{8, 9, 10}}, {"reason", "slip"}}},
       "setup \"X\" leaves out rows 8, 9, 10: slip"},
      {{FindingCode::ReadingsFlagged, {{"readings", std::int64_t{3}}, {"some_removed", false}}},
       "3 readings are flagged by the w-test and still in the adjustment; they are listed in residuals.csv "
       "(--outliers "
       "remove takes them out)"},
      {{FindingCode::ReadingsFlagged, {{"readings", std::int64_t{3}}, {"some_removed", true}}},
       "3 readings are flagged by the w-test and still in the adjustment; they are listed in residuals.csv "
       "(so many "
       "were removed before that the model or the stated noise must be in doubt: run `volcal compare`)"},
      {{FindingCode::ReadingsRemoved, {{"readings", std::int64_t{4}}}},
       "4 readings were removed by the w-test; they are listed in residuals.csv"},
      {{FindingCode::NoiseSigmaContradicted, {{"instrument", "ball-bar"}, {"times", FindingNumber{1.3149}}}},
       "ball-bar: its residuals scatter 1.31 times as much as its stated sigma; weights and uncertainties "
       "use the "
       "estimated value"},
      {{FindingCode::NoiseSigmaContradicted,
        {{"instrument", "ball-bar"},
         {"times", FindingNumber{988.0}},
         {"unit_slip", true},
         {"independent_part", true}}},
       "ball-bar: the independent part of its residuals scatters 988 times as much as its stated sigma; "
       "weights and "
       "uncertainties use the estimated value; is its noise stated in a unit 1000 times too small (nm for "
       "um)? check "
       "the noise table of its setups and the unit of the readings"},
      {{FindingCode::NoiseSigmaContradicted,
        {{"instrument", "r-test"}, {"times", FindingNumber{0.00102}}, {"too_quiet", true}}},
       "r-test: its residuals scatter 0.00102 times as much as its stated sigma; weights and uncertainties "
       "use the "
       "estimated value; an instrument's readings hardly scatter so little: are they in a larger unit than "
       "their "
       "columns say (mm for um, then add scale = { COLUMN = 1000 } to its setups), or were they computed?"},
      {{FindingCode::NoiseSigmaContradicted,
        {{"instrument", "ball-bar"}, {"times", FindingNumber{5.0}}, {"hardly_noise", true}}},
       "ball-bar: its residuals scatter 5 times as much as its stated sigma; weights and uncertainties use "
       "the "
       "estimated value; the instrument alone hardly explains this: the model may lack an effect, or the "
       "noise "
       "table may be wrong"},
      {{FindingCode::NoiseMoreThanWhite,
        {{"instrument", "laser-tracer"},
         {"drift", FindingNumber{0.41e-6, "um", 1e-6}},
         {"drift_time", FindingNumber{580.2, "s"}},
         {"line_offsets", FindingNumber{0.3e-6, "um", 1e-6}},
         {"per_metre", FindingNumber{0.2e-6, "um/m", 1e-6}}}},
       "laser-tracer: its noise is not independent (correlated drift of 0.41 um over 580 s, offsets of lines "
       "of 0.3 um, "
       "0.2 um/m in proportion to length); weights and uncertainties allow for it"},
      {{FindingCode::NoiseSeveralTimesStated,
        {{"instrument", "laser-tracer"}, {"times", FindingNumber{3.456}}}},
       "laser-tracer: all its noise together is 3.46 times what is stated; the instrument alone hardly "
       "explains this: the model may lack an effect, or the noise table may be wrong"},
      {{FindingCode::NoiseTakenAsIndependent},
       "robust loss: readings are taken as independent; correlated drift and offsets of lines were not "
       "looked for"},
      {{FindingCode::NotVisibleVerbatim, {{"error", "ECZ"}, {"reason", "so it is"}, {"remedy", "measure"}}},
       "ECZ: not visible, so it is; measure"},
      {{FindingCode::NotVisibleAxisAtRest, {{"error", "EXX"}, {"axis", "X"}}},
       "EXX: not visible, axis X does not move in this campaign; measure along axis X"},
      {{FindingCode::NotVisibleToolsOnOneAxis, {{"error", "ECZ"}, {"about", "Z"}}},
       "ECZ: not visible, every tool offset lies on Z; add setups with a tool offset sideways to Z (100 mm "
       "or more)"},
      {{FindingCode::NotVisibleNoLeverArm, {{"error", "ECZ"}, {"about", "Z"}}},
       "ECZ: not visible, no reading has a lever arm about Z; add setups with another tool offset, or an "
       "angle "
       "instrument about Z"},
      {{FindingCode::NotVisibleNoLeverArm, {{"error", "ECC"}, {"about", "Z"}, {"table", "C"}}},
       "ECC: not visible, no reading stands to the side of the axis of C, across Z; measure at places on the "
       "table 100 mm or more from that axis, or with an angle instrument about Z"},
      {{FindingCode::NotVisibleNoReadingChanges, {{"error", "EXX"}, {"switch", "functions"}}},
       "EXX: not visible, no reading changes when it changes; add readings that are sensitive to it, or "
       "switch it off "
       "in the model ([functions] EXX = { basis = \"zero\" })"},
      {{FindingCode::NotVisibleNoReadingChanges, {{"error", "EC0Y"}, {"switch", "locations"}}},
       "EC0Y: not visible, no reading changes when it changes; add readings that are sensitive to it, or "
       "switch it off "
       "in the model ([locations] EC0Y = \"zero\")"},
      {{FindingCode::NotVisibleNoReadingChanges, {{"error", "reversal EXX"}}},
       "reversal EXX: not visible, no reading changes when it changes; add readings that are sensitive to "
       "it, or switch "
       "it off in the model"},
      {{FindingCode::NotVisibleFewPositions, {{"error", "EXY"}, {"axis", "Y"}}},
       "EXY: not visible, the readings stand at too few positions of axis Y to tell its course between them; "
       "add "
       "positions along axis Y"},
      {{FindingCode::NotVisibleFewPositions,
        {{"error", "EXC"},
         {"axis", "C"},
         {"positions", std::int64_t{12}},
         {"told", std::int64_t{5}},
         {"harmonics", std::int64_t{8}},
         {"spacing", FindingNumber{kRadianPerDegree * 30.0, "deg", kRadianPerDegree}}}},
       "EXC: not visible, the readings stand at 12 different positions of axis C, on a grid of 30 deg; "
       "nothing "
       "there tells waves of more than 5 a turn from longer ones, and its function has up to 8; add "
       "positions "
       "of axis C off that grid, 17 or more in all, or give its function degree = 5"},
      {{FindingCode::NotVisibleLikeStraightness, {{"error", "EC0Y"}, {"axis", "Y"}, {"straightness", "EXY"}}},
       "EC0Y: not visible, the readings stand at too few positions of axis Y, or on too little of its "
       "travel, to tell "
       "it from EXY; add positions along the whole travel of axis Y"},
      {{FindingCode::NotVisibleReadingsTooFew, {{"error", "EC0Y"}}},
       "EC0Y: not visible, the readings that depend on it are too few or too noisy; add readings far from "
       "its pivot"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "EAZ"},
         {"partners", Texts{"EYZ", "station P1"}},
         {"remedies", Texts{"stations", "second-tool"}}}},
       "EAZ: not visible, a change of it can be exchanged with EYZ and station P1 without changing any "
       "reading; measure "
       "from more stations (four, well apart) and repeat with a second tool offset, sideways and of another "
       "length"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "ECB"},
         {"partners", Texts{"EYB"}},
         {"remedies", Texts{"second-tool", "mandrel"}},
         {"turning", "B"}}},
       "ECB: not visible, a change of it can be exchanged with EYB without changing any reading; turn B with "
       "a "
       "second tool offset, sideways and of another length: other tools are in use where it stands still and "
       "turn B with a mandrel whose tip lies 60 mm or more to the side of the spindle's axis"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "EAZ"},
         {"partners", Texts{"EYZ"}},
         {"remedies", Texts{"positions", "third-tool", "holding-instrument"}},
         {"axis", "Z"},
         {"third_tool_across", "Y"}}},
       "EAZ: not visible, a change of it can be exchanged with EYZ without changing any reading; add "
       "positions along "
       "axis Z, repeat with a third tool, its tip 100 mm or more to the side in Y (those of the tools in use "
       "lie on one "
       "line) and add an instrument that holds position or direction over the whole travel (tracer, "
       "straightness, "
       "square)"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "EBA"},
         {"partners", Texts{"EB0A"}},
         {"remedies", Texts{"measured-travel"}},
         {"partly", "A"},
         {"from", FindingNumber{-90.0 * kRadianPerDegree, "deg", kRadianPerDegree}},
         {"to", FindingNumber{30.0 * kRadianPerDegree, "deg", kRadianPerDegree}},
         {"travel_from", FindingNumber{-90.0 * kRadianPerDegree, "deg", kRadianPerDegree}},
         {"travel_to", FindingNumber{90.0 * kRadianPerDegree, "deg", kRadianPerDegree}}}},
       "EBA: not visible, a change of it can be exchanged with EB0A without changing any reading; measure A "
       "over its "
       "travel, -90 to 90 deg, or state in the machine file the -90 to 30 deg that were measured"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "EAZ"}, {"partners", Texts{"EYZ"}}, {"remedies", Texts{"other-lines"}}}},
       "EAZ: not visible, a change of it can be exchanged with EYZ without changing any reading; add lines "
       "at other "
       "offsets, straightness or angle readings that tell them apart"},
      {{FindingCode::RotaryHarmonicsHidden,
        {{"axis", "C"},
         {"positions", std::int64_t{12}},
         {"told", std::int64_t{5}},
         {"spacing", FindingNumber{kRadianPerDegree * 30.0, "deg", kRadianPerDegree}}}},
       "axis C stood at 12 positions, on a grid of 30 deg: waves of more than 5 a turn look there like "
       "longer ones and are in none of the error motions; add positions of C off that grid"},
      {{FindingCode::RankHeldByPrior,
        {{"block", "bb1: centre"}, {"parameter", "z"}, {"sigma", FindingNumber{1e-4, "mm", 1e-3}}}},
       "bb1: centre z: held at its guess +- 0.1 mm"},
      {{FindingCode::PriorContradicted,
        {{"block", "bb1: centre"},
         {"parameter", "x"},
         {"miss", FindingNumber{0.03, "mm", 1e-3}},
         {"sigma", FindingNumber{1e-4, "mm", 1e-3}},
         {"default", true}}},
       "bb1: centre x: estimated 30 mm away from what the files say, 300 times its default standard "
       "deviation of 0.1 "
       "mm; correct the value, or state a larger one"},
      {{FindingCode::PriorContradicted,
        {{"block", "scale"},
         {"parameter", ""},
         {"miss", FindingNumber{6e-6, "ppm", 1e-6}},
         {"sigma", FindingNumber{1e-6, "ppm", 1e-6}}}},
       "scale: estimated 6 ppm away from what the files say, 6 times its stated standard deviation of 1 ppm; "
       "correct "
       "the value, or state a larger one"},
      {{FindingCode::StationFarFromGuess,
        {{"block", "station P1"},
         {"distance", FindingNumber{0.5385, "mm", 1e-3}},
         {"x", FindingNumber{0.1, "mm", 1e-3}},
         {"y", FindingNumber{-0.65, "mm", 1e-3}},
         {"z", FindingNumber{0.02, "mm", 1e-3}},
         {"guess_in_metres", true}}},
       "station P1: found 538 mm from its guess; write [100, -650, 20] mm in the campaign file (is the guess "
       "in m?)"},
      {{FindingCode::StationsInPlane, {{"axis", "Y"}, {"share", FindingNumber{0.0213}}}},
       "every station stands close to the plane in which the machine moves: a length changes by at most "
       "0.021 "
       "of a displacement along Y, and with its square; errors along Y and their U95 are not to be trusted; "
       "place stations to both sides of that plane, half the travel away or more"},
      {{FindingCode::EffectDriverUnrecorded,
        {{"effect", "EXX by T_air"}, {"readings", std::int64_t{12}}, {"driver", "T_air"}}},
       "EXX by T_air: 12 readings do not record T_air and carry nothing of the effect"},
      {{FindingCode::FitLackOfFit, {{"times", FindingNumber{1.846}}}},
       "lack of fit: residuals are 1.85 times the stated noise; run `volcal compare` to see where the model "
       "fails"},
      {{FindingCode::FitLackOfFit, {{"times", FindingNumber{1.846}}, {"more_than_white", true}}},
       "lack of fit: residuals are 1.85 times the stated noise; an effect that the model lacks can look like "
       "the noise "
       "found here, which `volcal diagnose` tells; run `volcal compare` to see where the model fails"},
      {{FindingCode::FitNotConverged}, "not converged: the cost still fell after the last iteration"},
      {{FindingCode::ModelContradicted,
        {{"leading", "EAX by z^2"},
         {"rms", FindingNumber{1.24e-6, "um", 1e-6}},
         {"log10_p", FindingNumber{-12.34}},
         {"tests", std::int64_t{812}}}},
       "the residuals are not noise: EAX by z^2 would explain 1.2 um RMS of the readings (log10 p -12.3, all "
       "812 tests "
       "counted); `volcal diagnose` tells which effect the model lacks"},
      {{FindingCode::ModelContradicted,
        {{"leading", "EAX by z^2"},
         {"rms", FindingNumber{1.24e-6, "um", 1e-6}},
         {"log10_p", FindingNumber{-12.34}},
         {"tests", std::int64_t{812}},
         {"sampled", std::int64_t{50000}}}},
       "the residuals are not noise: EAX by z^2 would explain 1.2 um RMS of the readings (log10 p -12.3, all "
       "812 tests counted, 50000 readings evenly chosen); `volcal diagnose` tells which effect the model "
       "lacks"},
      {{FindingCode::DiagnosisNamed,
        {{"effect", "EYY reversal"},
         {"kind", "reversal"},
         {"target", "EYY"},
         {"driver", "dir_y"},
         {"shape", "period 10 mm"},
         {"amplitudes", Texts{"EYY reversal"}},
         {"values", std::vector<FindingNumber>{{1.5e-6, "um", 1e-6}}},
         {"U", std::vector<FindingNumber>{{0.196e-6, "um", 1e-6}}}}},
       "The missing effect is: EYY reversal (reversal), EYY reversal = 1.5 +- 0.2 um, period 10 mm"},
      {{FindingCode::DiagnosisNamed, {{"effect", "many"}, {"kind", "custom"}, {"shape", ""}}},
       "The missing effect is: many (custom)"},
      {{FindingCode::DiagnosisUnknown, {{"direction", "X"}, {"rms", FindingNumber{0.5e-6, "um", 1e-6}}}},
       "An effect that is not in the catalogue: it depends on nothing recorded that was tried, and acts "
       "along X; "
       "its strongest test alone explains 0.5 um RMS of the readings"},
      {{FindingCode::DiagnosisMoreUnknown,
        {{"direction", "X"},
         {"rms", FindingNumber{0.5e-6, "um", 1e-6}},
         {"depends_on", Texts{"dir_x", "z"}},
         {"and_one_of", Texts{"T_air", "time"}},
         {"period", FindingNumber{10.02e-3, "mm", 1e-3}}}},
       "More remains: it depends on dir_x and z and one of T_air, time, and acts along X, every 10.02 mm; "
       "its "
       "strongest test alone explains 0.5 um RMS of the readings"},
      {{FindingCode::DiagnosisMoreUnknown,
        {{"direction", "Z"},
         {"rms", FindingNumber{0.5e-6, "um", 1e-6}},
         {"depends_on", Texts{"x"}},
         {"rotation", "EBX"}}},
       "More remains: it depends on x, and acts along Z, as EBX; its strongest test alone explains 0.5 um "
       "RMS "
       "of the readings"},
      {{FindingCode::DiagnosisOneOf, {{"effects", Texts{"a", "b"}}}},
       "One of these is missing, and these readings do not tell them apart: a; b"},
      {{FindingCode::DiagnosisNearest, {{"effects", Texts{"a", "b"}}}},
       "Nearest in the catalogue, but not all of it: a; b"},
      {{FindingCode::DiagnosisChoice, {{"chosen", "a"}}}, "The extended model goes on with the simplest, a."},
      {{FindingCode::DiagnosisChoice,
        {{"chosen", "a"},
         {"other", "b"},
         {"difference", FindingNumber{0.41e-6, "um", 1e-6}},
         {"U", FindingNumber{1.23e-6, "um", 1e-6}},
         {"matters", false}}},
       "The extended model goes on with the simplest, a; in the volume it does not matter: predictions "
       "differ "
       "by at most 0.41 um (U 1.2 um)."},
      {{FindingCode::DiagnosisChoice,
        {{"chosen", "a"},
         {"other", "b"},
         {"difference", FindingNumber{12.3e-6, "um", 1e-6}},
         {"U", FindingNumber{2.1e-6, "um", 1e-6}},
         {"matters", true}}},
       "The extended model goes on with the simplest, a; it matters in the volume: with b predictions differ "
       "by up to 12 um (U 2.1 um)."},
      {{FindingCode::DiagnosisDrawn,
        {{"effect", "EAY by y z"},
         {"largest", FindingNumber{12.34e-6, "urad", 1e-6}},
         {"U", FindingNumber{0.82e-6, "urad", 1e-6}},
         {"drivers", Texts{"y", "z"}},
         {"at", std::vector<FindingNumber>{{310.0}, {-120.0}}},
         {"laws", Texts{"EAY by y * (z - p)^2", "EAY by y * z"}},
         {"law_shapes", Texts{"p = 120 mm", ""}},
         {"law_amplitudes",
          std::vector<FindingNumber>{{1.234e-6, "urad/mm3", 1e-6}, {2e-6, "urad/mm2", 1e-6}}},
         {"law_U", std::vector<FindingNumber>{{0.12e-6, "urad/mm3", 1e-6}, {0.3e-6, "urad/mm2", 1e-6}}},
         {"left_open", Texts{"what is straight in y: the rest of the model holds it"}}}},
       "Drawn for it: EAY by y z, up to 12.3 +- 0.82 urad at y = 310 mm, z = -120 mm; extend the model with "
       "it and the error falls. A law that explains as much: EAY by y * (z - p)^2 with p = 120 mm, 1.23 +- "
       "0.12 urad/mm3. Or: EAY by y * z, 2 +- 0.3 urad/mm2. These readings leave open what is straight in y: "
       "the rest of the model holds it."},
      {{FindingCode::DiagnosisDrawn,
        {{"effect", "EXX by t since_c"},
         {"largest", FindingNumber{1e-6, "um", 1e-6}},
         {"U", FindingNumber{0.2e-6, "um", 1e-6}},
         {"drivers", Texts{"t", "since_c"}},
         {"at", std::vector<FindingNumber>{{60.0}, {15.0}}}}},
       "Drawn for it: EXX by t since_c, up to 1 +- 0.2 um at t = 60 s, since_c = 15 deg; extend the model "
       "with it "
       "and the error falls."},
      {{FindingCode::DiagnosisTried,
        {{"effect", "a"},
         {"added", true},
         {"alternative", false},
         {"visible", true},
         {"gain", FindingNumber{45.6}},
         {"log10_p", FindingNumber{-12.3}},
         {"tests", std::int64_t{400}},
         {"nearest", "b"},
         {"cosine", FindingNumber{0.912}}}},
       "Your own, a: it is what was missing (log10 p -12.3 with all 400 tests counted, gain 45.6); nearest "
       "to "
       "it in these readings is b, cosine 0.912."},
      {{FindingCode::DiagnosisTried,
        {{"effect", "a"},
         {"added", true},
         {"visible", true},
         {"gain", FindingNumber{45.6}},
         {"log10_p", FindingNumber{-12.3}},
         {"systematic", FindingNumber{0.11e-6}},
         {"systematic_given", FindingNumber{0.72e-6}},
         {"systematic_reached", FindingNumber{0.11e-6}},
         {"tests", std::int64_t{400}}}},
       "Your own, a: it is what was missing (log10 p -12.3 with all 400 tests counted, gain 45.6); held-out "
       "readings keep 0.11 um of systematic error with it, 0.72 um as given."},
      {{FindingCode::DiagnosisTried,
        {{"effect", "a"},
         {"visible", true},
         {"gain", FindingNumber{-5.0}},
         {"log10_p", FindingNumber{0.0}},
         {"systematic", FindingNumber{0.4e-6}},
         {"systematic_given", FindingNumber{0.72e-6}},
         {"systematic_reached", FindingNumber{0.41e-6}},
         {"tests", std::int64_t{400}}}},
       "Your own, a: the readings do not support it (log10 p 0.0 with all 400 tests counted, gain -5); "
       "held-out readings keep 0.4 um of systematic error with it, 0.41 um without it, 0.72 um as given."},
      {{FindingCode::DiagnosisTried,
        {{"effect", "a"},
         {"visible", true},
         {"gain", FindingNumber{-5.0}},
         {"log10_p", FindingNumber{0.0}},
         {"tests", std::int64_t{400}}}},
       "Your own, a: the readings do not support it (log10 p 0.0 with all 400 tests counted, gain -5)."},
      {{FindingCode::DiagnosisTried,
        {{"effect", "a"},
         {"gain", FindingNumber{0.0}},
         {"log10_p", FindingNumber{0.0}},
         {"tests", std::int64_t{400}}}},
       "Your own, a: these readings do not see it."},
      {{FindingCode::DiagnosisMoreOneOf, {{"effects", Texts{"a", "b"}}}}, "More remains, one of: a; b"},
      {{FindingCode::DiagnosisMoreInCatalogue},
       "More remains, and the catalogue has a name for it: extend the model and diagnose again, or climb "
       "with --auto."},
      {{FindingCode::DiagnosisHeldoutNotReduced},
       "More remains: readings that were held out are still off by more than noise, hardly less than before. "
       "The effect "
       "may be another one that acts in the same places."},
      {{FindingCode::DiagnosisNothingAbove},
       "Nothing is above the noise; what would have been found is in the table of smallest detectable "
       "amplitudes."},
      {{FindingCode::DiagnosisNotVisible, {{"not_visible", std::int64_t{3}}, {"families", std::int64_t{4}}}},
       "Nothing is above the noise, but 3 of 4 effects would not be visible with this measurement."},
      {{FindingCode::DiagnosisReadingsReinstated, {{"readings", std::int64_t{3}}, {"of", std::int64_t{5}}}},
       "3 of 5 readings that the outlier test had removed agree with the model reached and are used again."},
      {{FindingCode::DiagnosisResolution, {{"function", "EYX"}}}, "The error function EYX needs more knots."},
      {{FindingCode::RejectedLeavesMore, {{"effect", "a"}}},
       "Not named a: what it leaves exceeds the noise more than it does."},
      {{FindingCode::RejectedDriverStillMoves, {{"effect", "a"}, {"drivers", Texts{"x", "z"}}}},
       "Not named a: x or z still moves what it leaves."},
      {{FindingCode::RejectedAmplitudeVaries,
        {{"effect", "a"}, {"variable", "y"}, {"log10_p", FindingNumber{-7.26}}}},
       "Not named a: its amplitude varies with y (log10 p -7.3)."},
      {{FindingCode::RejectedShapeBeyondScan, {{"effect", "a"}, {"shape", "time constant"}}},
       "Not named a: its time constant lies beyond what was looked for."},
      {{FindingCode::RejectedUnnamedExceeds, {{"effect", "a"}}},
       "Not named a: what has no name exceeds the noise more than it does."},
      {{FindingCode::DirectionsUnrecorded, {{"columns", Texts{"dir_x"}}, {"kinds", Texts{"reversal"}}}},
       "Not looked for, as no reading records dir_x: reversal."},
      {{FindingCode::TimesUnrecorded, {{"kinds", Texts{"station-drift", "thermal-drift"}}}},
       "Not looked for, as no reading records its time (time_s): station-drift, thermal-drift."},
      {{FindingCode::MeasurementNoneSeparates, {{"effects", Texts{"EXX reversal", "P1 drift"}}}},
       "No candidate measurement separates EXX reversal from P1 drift: they predict nearly the same "
       "readings."},
      {{FindingCode::MeasurementNoneSeparates,
        {{"effects", Texts{"EXX reversal", "P1 drift"}},
         {"difference", FindingNumber{0.31e-6, "um", 1e-6}},
         {"U", FindingNumber{0.5e-6, "um", 1e-6}}}},
       "No candidate measurement separates EXX reversal from P1 drift well enough to be worth its time. This "
       "does not matter: in the measured volume their predictions differ by at most 0.31 um (U 0.5 um)."},
      {{FindingCode::MeasurementSeparates,
        {{"action", "revisit"},
         {"measurement", "measure P1 with tool short again after 3 h"},
         {"readings", std::int64_t{48}},
         {"effects", Texts{"EXX reversal", "P1 drift"}},
         {"gain", FindingNumber{150.4}},
         {"plain_gain", FindingNumber{1.042}}}},
       "Measure P1 with tool short again after 3 h (48 readings): separates EXX reversal from P1 drift 150 "
       "times better; as many more readings like the present ones do so 1.04 times better."},
      {{FindingCode::MeasurementSeparates,
        {{"action", "revisit"},
         {"measurement", "measure P1 again"},
         {"readings", std::int64_t{48}},
         {"effects", Texts{"a", "b"}},
         {"gain", FindingNumber{std::numeric_limits<double>::infinity()}},
         {"plain_gain", FindingNumber{std::numeric_limits<double>::infinity()}}}},
       "Measure P1 again (48 readings): separates a from b, which the present readings cannot do; as many "
       "more readings like the present ones would do so, too."},
      {{FindingCode::MeasurementShows,
        {{"action", "calibrated-length"},
         {"measurement", "measure a circle"},
         {"readings", std::int64_t{48}},
         {"effects", Texts{"length scale"}},
         {"of", std::int64_t{1}},
         {"detectable", FindingNumber{0.52e-6, "um/m", 1e-6}}}},
       "Measure a circle (48 readings): makes length scale visible from 0.52 um/m on."},
      {{FindingCode::MeasurementShows,
        {{"action", "calibrated-length"},
         {"measurement", "measure a circle"},
         {"readings", std::int64_t{48}},
         {"effects", Texts{"a", "b", "c", "d", "e"}},
         {"of", std::int64_t{7}}}},
       "Measure a circle (48 readings): makes 5 of 7 effects visible that are not visible now: a, b, c, d, "
       "...."},
      {{FindingCode::PlanSetupMore, {{"tool", "side_x"}, {"place", "P1"}, {"kind_of_place", "station"}}},
       "tool side_x at P1"},
      {{FindingCode::PlanSetupMore,
        {{"tool", "sideways"},
         {"place", "P3"},
         {"kind_of_place", "station"},
         {"offset_of_new_tool", Numbers{{0.1, "mm", 1e-3}, {0.0, "mm", 1e-3}, {-0.2, "mm", 1e-3}}},
         {"new_place", Numbers{{0.5, "mm", 1e-3}, {-0.2, "mm", 1e-3}, {0.35, "mm", 1e-3}}}}},
       "a further station at [500, -200, 350] mm with a tool of offset [100, 0, -200] mm"},
      {{FindingCode::PlanEffectsKnown,
        {{"effects", Texts{"surface EAY by y T_column", "EXX by x * (T_air - 20)"}},
         {"columns", Texts{"T_air_degC", "T_column_degC"}}}},
       "The plan takes as known, as the model states it: surface EAY by y T_column; EXX by x * (T_air - 20). "
       "Positions are planned, not conditions; where readings record T_air_degC, T_column_degC and that "
       "changes, "
       "a fit identifies it anew."},
      {{FindingCode::PlanEffectsKnown, {{"effects", Texts{"station drift P9 x"}}}},
       "The plan takes as known, as the model states it: station drift P9 x. It belongs to setups of the "
       "campaign "
       "in which it was found."},
      {{FindingCode::StandardsRemovedReadingsUsed, {{"readings", std::int64_t{3}}}},
       "3 readings that the adjustment left out are in these figures"},
      {{FindingCode::StandardsLinesOwnZero},
       "every line has its own zero: reversal and bidirectional figures are not seen"},
      {{FindingCode::StandardsLinesOwnZero, {{"targets_of_own", true}}},
       "every line has its own zero and targets of its own: no figure compares them"},
      {{FindingCode::StandardsTargetsSpread, {{"spread", FindingNumber{2.345e-6, "um", 1e-6}}}},
       "recorded positions within 2.3 um were taken as one target"},
      {{FindingCode::StandardsApproachUnknown, {{"readings", std::int64_t{4}}}},
       "4 readings of unknown approach are left out"},
      {{FindingCode::StandardsTargetsOneSided, {{"targets", std::int64_t{1}}, {"of", std::int64_t{3}}}},
       "1 of 3 targets were met from one direction only"},
      {{FindingCode::StandardsRepeatabilityUndefined},
       "R and A are undefined: they need two approaches of every target from a direction"},
      {{FindingCode::StandardsBarUncalibrated},
       "the bar is not calibrated: F and D contain its length error"},
      {{FindingCode::StandardsRigidMotionRemoved}, "readings and model each without their best rigid motion"},
      {{FindingCode::NoTestWithoutReadings, {{"setup", "bar"}}}, "bar: there are no readings"},
      {{FindingCode::NoTestRotaryAxisMoves, {{"setup", "bar"}}}, "bar: a rotary axis moves"},
      {{FindingCode::NoTestNoAxisMoves,
        {{"setup", "line_X"}, {"line", std::int64_t{3}}, {"more_lines", std::int64_t{0}}}},
       "line_X: line 3: no axis moves"},
      {{FindingCode::NoTestNotTwoAxesMove,
        {{"setup", "bar"}, {"line", std::int64_t{3}}, {"more_lines", std::int64_t{2}}}},
       "bar: line 3 and 2 more: the number of axes that move is not two"},
      {{FindingCode::NoTestNoCircle, {{"setup", "bar"}}}, "bar: the commanded points do not lie on a circle"},
      {{FindingCode::NoTestNoStraightLine, {{"setup", "line_X"}}},
       "line_X: the commanded points do not lie on a straight line"},
      {{FindingCode::NoTestBeamAcross, {{"setup", "line_X"}, {"path", "X"}}},
       "line_X: the beam does not lie along the motion of X"},
      {{FindingCode::NoTestComponentsMissing, {{"setup", "points"}, {"components", std::int64_t{1}}}},
       "points: one component of the error vectors only"},
      {{FindingCode::NoTestComponentsMissing, {{"setup", "points"}, {"components", std::int64_t{2}}}},
       "points: two components of the error vectors only"},
      {{FindingCode::ErrorsHeldBeyondReadings,
        {{"axis", "X"},
         {"measured_from", FindingNumber{0.05, "mm", 1e-3}},
         {"measured_to", FindingNumber{0.9, "mm", 1e-3}},
         {"travel_from", FindingNumber{0.0, "mm", 1e-3}},
         {"travel_to", FindingNumber{1.0, "mm", 1e-3}}}},
       "X was measured from 50 to 900 of 0 to 1000 mm: beyond it the last measured error is held"},
      {{FindingCode::ErrorsFadedBeyondReadings,
        {{"effect", "surface EAY by y T_column"}, {"readings", std::int64_t{12}}}},
       "surface EAY by y T_column fades out at 12 of these readings: they lie beyond those that it was drawn "
       "from"},
      {{FindingCode::ConditionBeyondReadings,
        {{"condition", "T_column"},
         {"value", FindingNumber{30.0, "degC", 1.0}},
         {"measured_from", FindingNumber{18.9, "degC", 1.0}},
         {"measured_to", FindingNumber{24.1, "degC", 1.0}}}},
       "T_column = 30 degC is beyond the readings, 18.9 to 24.1 degC: laws are continued to it, curves and "
       "surfaces fade out"},
      {{FindingCode::ConditionWithoutEffect, {{"condition", "T_air"}}},
       "no identified error depends on T_air: it changes nothing"},
      {{FindingCode::ConditionOnPathsAlone,
        {{"condition", "feed"}, {"effects", std::vector<std::string>{"following error X"}}}},
       "feed drives following error X alone, which acts along a path: it changes none of these figures"},
      {{FindingCode::ErrorsOfTables,
        {{"tool", "side"},
         {"conditions", std::vector<std::string>{"T_column", "time"}},
         {"values", std::vector<FindingNumber>{{25.0, "degC", 1.0}, {2000.0, "s", 1.0}}},
         {"shared_effects", std::vector<std::string>{"tool load EAZ", "coupling EAY Y Z"}},
         {"effects_in_no_table", std::vector<std::string>{"following error X"}}}},
       "these errors are those of tables for tool side, T_column 25 degC, time 2000 s; for tool load EAZ, "
       "coupling EAY Y Z they hold the nearest errors of a rigid body with that tool; following error X is "
       "in none of them"},
      {{FindingCode::ErrorsOfTables,
        {{"conditions", std::vector<std::string>{"T_column"}},
         {"values", std::vector<FindingNumber>{{25.0, "degC", 1.0}}}}},
       "these errors are those of tables for T_column 25 degC"},
      {{FindingCode::TablesOfOtherTool, {{"tool", "short"}, {"tables_tool", "side"}}},
       "the tables were made for tool side: for tool short they lack the effects that differ between tools"},
      {{FindingCode::TablesOfOtherConditions,
        {{"condition", "T_column"},
         {"value", FindingNumber{20.0, "degC", 1.0}},
         {"of_tables", FindingNumber{25.0, "degC", 1.0}}}},
       "the tables hold for T_column = 25 degC: T_column = 20 degC changes nothing in them"},
      {{FindingCode::EffectInNoTable, {{"effect", "following error X"}}},
       "following error X was identified but is in none of the tables: it acts along a path or in one setup"},
      {{FindingCode::EffectInNoFigure, {{"effect", "following error X"}}},
       "following error X was identified but is in none of these figures: it acts along a path or in one "
       "setup"},
      {{FindingCode::RotaryErrorsInNoTable, {{"axis", "C"}}},
       "errors of axis C were identified but are in none of the tables: tables are for linear axes with C at "
       "0"},
      {{FindingCode::RotaryErrorsPartlyInTables, {{"axis", "C"}, {"type", "R-POS"}}},
       "the tables hold only R-POS of the errors of axis C"},
      {{FindingCode::RotaryErrorsUnknownToTables, {{"axis", "C"}}},
       "errors of axis C were not identified: the tables hold with C at 0, and what C does elsewhere is in "
       "none "
       "of these figures; measure with C in several positions"},
      {{FindingCode::LeversOfTiltedHead,
        {{"axes", "CB"},
         {"rms", FindingNumber{1.9e-6, "um", 1e-6}},
         {"max", FindingNumber{4.3e-6, "um", 1e-6}}}},
       "tables of linear axes are made with the rotary axes at 0: where the head (CB) is tilted, angles of "
       "linear axes act by another lever, which leaves 1.90 um RMS, 4.30 um at most over all poses; volcal "
       "compensate corrects a program with the axes where they stand"},
      {{FindingCode::LeversOfTiltedHead,
        {{"axes", ""},
         {"rms", FindingNumber{1.9e-6, "um", 1e-6}},
         {"max", FindingNumber{4.3e-6, "um", 1e-6}}}},
       "tables of linear axes are made with the rotary axes at 0: what the errors of linear axes make of "
       "other "
       "positions of these leaves 1.90 um RMS, 4.30 um at most over all poses; volcal compensate corrects a "
       "program with the axes where they stand"},
      {{FindingCode::TablesOffIdeal, {{"off", FindingNumber{4.2e-6, "um", 1e-6}}}},
       "between their positions the tables are up to 4.20 um off the ideal compensation: --tolerance takes "
       "as many positions as that needs, --step or --positions as many as they say"},
      {{FindingCode::RotaryTablesWithoutDirections, {{"rms", FindingNumber{3.54e-6, "um", 1e-6}}}},
       "tables of rotary axes are the mean of both directions of approach: reversals of these axes leave "
       "3.54 um "
       "RMS; neutral-csv and linuxcnc-grid tell directions apart, others need the control's own backlash "
       "compensation"},
      {{FindingCode::RotaryTablesOffIdeal, {{"off", FindingNumber{12.3e-6, "um", 1e-6}}}},
       "tables of rotary axes are up to 12.30 um off what their types could correct: what changes within one "
       "of their steps, such as the errors of a worm, needs a finer --rotary-step; what depends on two axes "
       "at once is in grids of rotary axes alone"},
      {{FindingCode::RotaryTablesOffIdeal,
        {{"off", FindingNumber{12.3e-6, "um", 1e-6}}, {"constants", true}}},
       "the constants of rotary axes are up to 12.30 um off what R-POR could correct: they say where the "
       "axes are, "
       "not how they are tilted, which grids of rotary axes hold"},
      {{FindingCode::TablesLeaveMore,
        {{"with", FindingNumber{4.26e-6, "um", 1e-6}}, {"without", FindingNumber{3.53e-6, "um", 1e-6}}}},
       "the machine errs by 4.26 um RMS with these tables and by 3.53 without: do not load them; take a "
       "finer "
       "--step, --positions or --rotary-step, a format that holds more positions, or fewer types"},
      {{FindingCode::RotaryErrorsNotInModel, {{"axis", "C"}, {"in_uncertainty", true}}},
       "axis C moves in these readings, and the model has no errors of it: what they do is in the residuals, "
       "what they may be by their prior in the uncertainty of the model; identify them by volcal fit from "
       "readings that move C"},
      {{FindingCode::RotaryErrorsNotInModel, {{"axis", "C"}, {"by_model", true}}},
       "axis C moves in these readings, and the model file leaves out its errors: what they do is in the "
       "residuals; "
       "take default = { basis = \"zero\" } out of the model file, or name its functions and locations "
       "there"},
      {{FindingCode::RotaryErrorsNotInModel,
        {{"axis", "C"}, {"by_model", true}, {"locations", Texts{"EX0C", "EY0C"}}}},
       "axis C moves in these readings, and the model file leaves out its location errors EX0C, EY0C: what "
       "they do "
       "is in the residuals; add EX0C = 0.0 below [locations], or \"zero\" for each that is known to be "
       "none"},
      {{FindingCode::RotaryErrorsNotInModel, {{"axis", "C"}}},
       "axis C moves in these readings, and the model has no errors of it: what they do is in the residuals; "
       "identify them by volcal fit from readings that move C"},
  };
  return all;
}

TEST(FindingCodes, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const FindingCodeRow& row : finding_codes()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_EQ(row.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz.-"), std::string_view::npos) << row.name;
    EXPECT_EQ(finding_code(row.name), row.code);
  }
  EXPECT_EQ(finding_codes().size(), static_cast<std::size_t>(FindingCode::End));
  EXPECT_EQ(finding_code("rank"), std::nullopt);
}

TEST(Sentences, AreMadeByOneFunctionForEveryCode) {
  std::set<FindingCode> codes;
  for (const SentenceMaker& maker : sentence_makers())
    EXPECT_TRUE(codes.insert(maker.code).second) << to_string(maker.code);
  EXPECT_EQ(codes.size(), finding_codes().size());
}

TEST(Sentences, SayWhatIsFoundOfEveryCode) {
  std::set<FindingCode> seen;
  for (const WordedFinding& example : examples()) {
    EXPECT_EQ(sentence(example.finding), example.sentence);
    seen.insert(example.finding.code);
  }
  EXPECT_EQ(seen.size(), finding_codes().size());
}

/// "{}", "{0}", "{:.2f}" of a format that was never applied; "{ dir_x = -1 }" is TOML.
TEST(Sentences, HoldNoPlaceholder) {
  const std::regex placeholder(R"(\{[0-9]*(:[^}]*)?\})");
  for (const WordedFinding& example : examples())
    EXPECT_FALSE(std::regex_search(sentence(example.finding), placeholder)) << sentence(example.finding);
}

/// Sources that may find something: all but those that name and word the codes.
std::string sources_that_find() {
  std::string text;
  const std::filesystem::path root = VOLCAL_SOURCE_DIR;
  for (const char* part : {"model", "identify", "studies"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / part)) {
      const std::string path = entry.path().generic_string();
      const bool words =
          path.find("identify/words") != std::string::npos || path.ends_with("/finding_codes.h");
      if (words || !(path.ends_with(".cpp") || path.ends_with(".h"))) continue;
      std::ifstream file(entry.path());
      text.append(std::istreambuf_iterator<char>(file), {});
    }
  }
  return text;
}

/// Names of the enumeration in its order, from its header.
std::vector<std::string> names_of_codes() {
  std::ifstream file(std::filesystem::path(VOLCAL_SOURCE_DIR) / "model/description/finding_codes.h");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto from = text.find("enum class FindingCode"), to = text.find("  End,", from);
  const std::string enumeration = text.substr(from, to - from);
  const std::regex name(R"(\n  (\w+),)");
  std::vector<std::string> names;
  for (std::sregex_iterator found(enumeration.begin(), enumeration.end(), name), end; found != end; ++found)
    names.push_back((*found)[1]);
  return names;
}

/// docs/findings.md has a row of every code, with the sentence of its first example.
TEST(FindingCodes, StandOnTheirPage) {
  std::ifstream file(std::filesystem::path(VOLCAL_SOURCE_DIR) / "docs/findings.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  for (const FindingCodeRow& row : finding_codes()) {
    const auto example = std::ranges::find_if(
        examples(), [&](const WordedFinding& each) { return each.finding.code == row.code; });
    const std::string as = row.code == FindingCode::Verbatim ? "" : example->sentence + " |\n";
    EXPECT_THAT(page, HasSubstr("\n| `" + std::string(row.name) + "` | " +
                                std::string(to_string(row.severity)) + " | " + as));
  }
}

TEST(FindingCodes, AreAllFoundSomewhere) {
  const std::string sources = sources_that_find();
  const std::vector<std::string> names = names_of_codes();
  ASSERT_EQ(names.size(), finding_codes().size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::regex use("FindingCode::" + names[i] + R"(\b)");
    EXPECT_TRUE(std::regex_search(sources, use)) << names[i] << ", " << finding_codes()[i].name;
  }
}

TEST(Sentences, AreRefusedWithoutTheirData) {
  EXPECT_THROW(sentence({FindingCode::ReadingsRemoved}), std::invalid_argument);
  EXPECT_THROW(sentence({FindingCode::ReadingsRemoved, {{"readings", "many"}}}), std::invalid_argument);
  EXPECT_THROW(sentence({FindingCode::NotVisibleExchangeable,
                         {{"error", "EXX"}, {"partners", Texts{"EYX"}}, {"remedies", Texts{"pray"}}}}),
               std::invalid_argument);
  EXPECT_THROW(explanation(Finding{FindingCode::FitNotConverged}), std::invalid_argument);
  EXPECT_THAT(explanation(std::nullopt).reason, IsEmpty());
}

TEST(FindingJson, ReturnsEveryFinding) {
  for (const WordedFinding& example : examples()) {
    const auto json = nlohmann::ordered_json::parse(finding_json(example.finding).dump());
    EXPECT_EQ(json.at("code"), to_string(example.finding.code));
    EXPECT_EQ(json.at("severity"), to_string(example.finding.severity()));
    EXPECT_EQ(finding_from(json, verbatim("")), example.finding) << json;
  }
  const Finding none{
      FindingCode::NoiseSeveralTimesStated,
      {{"instrument", "angle"}, {"times", FindingNumber{std::numeric_limits<double>::infinity()}}}};
  EXPECT_EQ(finding_from(finding_json(none), verbatim("")), none);
}

TEST(FindingJson, TakesTheSentenceWhereTheCodeIsNotKnown) {
  const nlohmann::ordered_json later = {{"code", "rank.of-another-version"}, {"data", {{"x", 1}}}};
  EXPECT_EQ(finding_from(later, verbatim("in words")), verbatim("in words"));
  EXPECT_THAT(findings_from({}, {"one", "two"}), ::testing::ElementsAre(verbatim("one"), verbatim("two")));
  EXPECT_THROW(findings_from(nlohmann::ordered_json::array({later}), {"one", "two"}), std::invalid_argument);
  EXPECT_ANY_THROW(
      finding_from({{"code", "readings.removed"}, {"data", {{"readings", "many"}}}}, verbatim("")));
}

TEST(FindingJson, NotesStandInWordsAndAsCodes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  add_notes({}, json);
  EXPECT_TRUE(json.empty());
  add_notes({{FindingCode::ReadingsDuplicated, {{"setup", "X2"}, {"first_setup", "X"}}}}, json);
  EXPECT_THAT(json.at("notes").at(0).get<std::string>(), EndsWith("they count twice; remove one of them"));
  EXPECT_EQ(json.at("notes_findings").at(0).at("code"), "readings.duplicated");
}

}  // namespace
}  // namespace volcal
