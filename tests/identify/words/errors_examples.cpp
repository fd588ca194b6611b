// Figures of ISO 230, errors and tables.

#include "tests/identify/words/finding_examples.h"
#include "volcal/model/description/units.h"

namespace volcal {

std::vector<WordedFinding> examples_of_errors() {
  return {
      {{FindingCode::StandardsRemovedReadingsUsed, {{"readings", std::int64_t{3}}}},
       "3 readings that the adjustment left out are in these figures"},
      {{FindingCode::StandardsLinesOwnZero},
       "every line has its own zero: reversal and bidirectional figures are not seen"},
      {{FindingCode::StandardsLinesOwnZero, {{"targets_of_own", true}}},
       "every line has its own zero and targets of its own: no figure compares them"},
      {{FindingCode::StandardsLinesOwnZero, {{"direction", "-"}}},
       "every line has its own zero: reversal and bidirectional figures are not seen; the lines towards - do "
       "not share their targets: no figure of that direction"},
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
      {{FindingCode::NoTestSeveralAxesMove, {{"setup", "level"}}}, "level: more than one axis moves"},
      {{FindingCode::NoTestAngleNotRead, {{"setup", "level"}, {"axis", "C"}}},
       "level: C turns, but not about the axis or with the body that the readings show"},
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
      {{FindingCode::RotaryErrorsUnknownToTables,
        {{"axis", "C"}, {"position", FindingNumber{90.0 * kRadianPerDegree, "deg", kRadianPerDegree}}}},
       "errors of axis C were not identified: the tables hold with C at 90 deg, and what C does elsewhere is "
       "in none of these figures; measure with C in several positions"},
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
       "other positions of these leaves 1.90 um RMS, 4.30 um at most over all poses; volcal compensate "
       "corrects a program with the axes where they stand"},
      {{FindingCode::ErrorAtHomeTurns, {{"axes", "CA"}, {"error", FindingNumber{4e-6, "um", 1e-6}}}},
       "tables of linear axes are zero at home: the error of these axes there, 4.00 um, is left, and to the "
       "workpiece that a table (CA) turns it is a displacement of the table's line; R-POR corrects it, in a "
       "format that holds that"},
      {{FindingCode::TablesOffIdeal, {{"off", FindingNumber{4.2e-6, "um", 1e-6}}}},
       "between their positions the tables are up to 4.20 um off the ideal compensation: --tolerance takes "
       "as many positions as that needs, --step as many as it says"},
      {{FindingCode::TablesOffIdeal, {{"off", FindingNumber{4.2e-6, "um", 1e-6}}, {"positions", true}}},
       "between their positions the tables are up to 4.20 um off the ideal compensation: --tolerance takes "
       "as many positions as that needs, --step or --positions as many as they say"},
      {{FindingCode::RotaryTablesWithoutDirections, {{"rms", FindingNumber{3.54e-6, "um", 1e-6}}}},
       "tables of rotary axes are the mean of both directions of approach: reversals of these axes leave "
       "3.54 um RMS; neutral-csv and linuxcnc-grid tell directions apart, others need the control's own "
       "backlash compensation"},
      {{FindingCode::RotaryTablesOffIdeal, {{"off", FindingNumber{12.3e-6, "um", 1e-6}}}},
       "tables of rotary axes are up to 12.30 um off what their types could correct: what changes within one "
       "of their steps, such as the errors of a worm, needs a finer --rotary-step; what depends on two axes "
       "at once is in grids of rotary axes alone"},
      {{FindingCode::RotaryTablesOffIdeal,
        {{"off", FindingNumber{12.3e-6, "um", 1e-6}}, {"constants", true}}},
       "the constants of rotary axes are up to 12.30 um off what R-POR could correct: they say where the "
       "axes are, not how they are tilted, which grids of rotary axes hold"},
      {{FindingCode::TablesLeaveMore,
        {{"with", FindingNumber{4.26e-6, "um", 1e-6}},
         {"without", FindingNumber{3.53e-6, "um", 1e-6}},
         {"step", true}}},
       "the machine errs by 4.26 um RMS with these tables and by 3.53 without: do not load them; take a "
       "finer --step, a format that holds more positions, or fewer types"},
      {{FindingCode::TablesLeaveMore,
        {{"with", FindingNumber{4.26e-6, "um", 1e-6}},
         {"without", FindingNumber{3.53e-6, "um", 1e-6}},
         {"step", true},
         {"positions", true}}},
       "the machine errs by 4.26 um RMS with these tables and by 3.53 without: do not load them; take a "
       "finer --step or more --positions, a format that holds more positions, or fewer types"},
      {{FindingCode::TablesLeaveMore,
        {{"with", FindingNumber{4.26e-6, "um", 1e-6}},
         {"without", FindingNumber{3.53e-6, "um", 1e-6}},
         {"rotary_step", true}}},
       "the machine errs by 4.26 um RMS with these tables and by 3.53 without: do not load them; take a "
       "finer --rotary-step, a format that holds more positions, or fewer types"},
      {{FindingCode::TablesLeaveMore,
        {{"with", FindingNumber{4.26e-6, "um", 1e-6}}, {"without", FindingNumber{3.53e-6, "um", 1e-6}}}},
       "the machine errs by 4.26 um RMS with these tables and by 3.53 without: do not load them; take fewer "
       "types, or another format"},
      {{FindingCode::RotaryTablesMayWorsen,
        {{"expected", FindingNumber{232.6e-6, "um", 1e-6}}, {"before", FindingNumber{119.3e-6, "um", 1e-6}}}},
       "what the tables correct of rotary axes is known too badly: 232.60 um RMS are to be expected with "
       "them, "
       "119.30 were identified without: away from the poses that were measured they can make the machine "
       "worse; "
       "measure what the fit names as not visible before they are loaded, or leave out the types R-"},
      {{FindingCode::CompensationsDiffer, {{"measured", "L-VOL"}}},
       "these readings were taken with L-VOL active, which the errors do not know: the figures are of both "
       "together; validate --tables takes out what tables corrected"},
      {{FindingCode::CompensationsDiffer, {{"measured", "L-VOL"}, {"identified", "L-POS"}}},
       "these readings were taken with L-VOL active, the errors were identified with L-POS: the figures are "
       "of both together; take readings and errors with the same compensations active"},
      {{FindingCode::CompensationsDiffer, {{"identified", "L-POS"}}},
       "the errors were identified with L-POS active, which this campaign does not state: where it was "
       "measured without, the figures are of both together; state active_compensations in campaign.toml"},
      {{FindingCode::CompensationsUnstated},
       "the campaign does not state that tables were active, and what the tables correct was taken out of "
       "its readings: state active_compensations in campaign.toml, or leave --tables out where they were "
       "not active"},
      {{FindingCode::CompensationsUnstated, {{"stated", "none"}}},
       "the campaign states that no compensations were active, and what the tables correct was taken out of "
       "its readings: state active_compensations in campaign.toml, or leave --tables out where they were "
       "not active"},
      {{FindingCode::CompensationsInTables, {{"identified", "L-POS"}}},
       "the errors were identified with L-POS active: where the tables stand in place of these, as "
       "superimposed ones do, what these corrected was taken out twice; give the result that was identified "
       "without them"},
      {{FindingCode::RotaryErrorsNotInModel, {{"axis", "C"}, {"in_uncertainty", true}}},
       "axis C moves in these readings, and the model has no errors of it: what they do is in the residuals, "
       "what they may be by their prior in the uncertainty of the model; identify them by volcal fit from "
       "readings that move C"},
      {{FindingCode::RotaryErrorsNotInModel, {{"axis", "C"}, {"by_model", true}}},
       "axis C moves in these readings, and the model file leaves out its errors: what they do is in the "
       "residuals; take default = { basis = \"zero\" } out of the model file, or name its functions and "
       "locations there"},
      {{FindingCode::RotaryErrorsNotInModel,
        {{"axis", "C"}, {"by_model", true}, {"locations", Texts{"EX0C", "EY0C"}}}},
       "axis C moves in these readings, and the model file leaves out its location errors EX0C, EY0C: what "
       "they do is in the residuals; add EX0C = 0.0 below [locations], or \"zero\" for each that is known to "
       "be none"},
      {{FindingCode::RotaryErrorsNotInModel, {{"axis", "C"}}},
       "axis C moves in these readings, and the model has no errors of it: what they do is in the residuals; "
       "identify them by volcal fit from readings that move C"},
  };
}

}  // namespace volcal
