/// Where errors are stated without readings, and what of them no table holds.

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

std::string held_beyond_readings(const Finding& finding) {
  return fmt::format(
      "{} was measured from {:g} to {:g} of {:g} to {:g} {}: beyond it the last measured error is held",
      finding.text("axis"), finding.number("measured_from").in_unit(),
      finding.number("measured_to").in_unit(), finding.number("travel_from").in_unit(),
      finding.number("travel_to").in_unit(), finding.number("travel_to").unit);
}

std::string faded_beyond_readings(const Finding& finding) {
  return fmt::format("{} fades out at {} of these readings: they lie beyond those that it was drawn from",
                     finding.text("effect"), finding.count("readings"));
}

std::string condition_beyond_readings(const Finding& finding) {
  const FindingNumber& value = finding.number("value");
  return fmt::format(
      "{} = {:.6g} {} is beyond the readings, {:.6g} to {:.6g} {}: laws are continued to it, curves and "
      "surfaces "
      "fade out",
      finding.text("condition"), value.in_unit(), value.unit, finding.number("measured_from").in_unit(),
      finding.number("measured_to").in_unit(), value.unit);
}

std::string condition_without_effect(const Finding& finding) {
  return "no identified error depends on " + finding.text("condition") + ": it changes nothing";
}

std::string condition_on_paths_alone(const Finding& finding) {
  return fmt::format("{} drives {} alone, which acts along a path: it changes none of these figures",
                     finding.text("condition"), fmt::join(finding.texts("effects"), ", "));
}

std::string errors_of_tables(const Finding& finding) {
  const std::vector<std::string> shared = finding.texts("shared_effects"),
                                 left_out = finding.texts("effects_in_no_table");
  std::vector<std::string> made_for;
  if (finding.has("tool")) made_for.push_back("tool " + finding.text("tool"));
  const std::vector<std::string> conditions = finding.texts("conditions");
  const std::vector<FindingNumber> values = finding.numbers("values");
  for (std::size_t i = 0; i < std::min(conditions.size(), values.size()); ++i)
    made_for.push_back(fmt::format("{} {:.6g} {}", conditions[i], values[i].in_unit(), values[i].unit));
  std::string text = "these errors are those of tables";
  if (!made_for.empty()) text += fmt::format(" for {}", fmt::join(made_for, ", "));
  if (!shared.empty())
    text += fmt::format("; for {} they hold the nearest errors of a rigid body {}", fmt::join(shared, ", "),
                        finding.has("tool") ? "with that tool" : "at the spindle reference");
  if (!left_out.empty())
    text += fmt::format("; {} {} in none of them", fmt::join(left_out, ", "),
                        left_out.size() == 1 ? "is" : "are");
  return text;
}

std::string tables_of_other_tool(const Finding& finding) {
  return fmt::format(
      "the tables were made for tool {}: for tool {} they lack the effects that differ between tools",
      finding.text("tables_tool"), finding.text("tool"));
}

std::string tables_of_other_conditions(const Finding& finding) {
  const FindingNumber &held = finding.number("of_tables"), &asked = finding.number("value");
  return fmt::format("the tables hold for {0} = {1:.6g} {3}: {0} = {2:.6g} {3} changes nothing in them",
                     finding.text("condition"), held.in_unit(), asked.in_unit(), asked.unit);
}

std::string effect_in_no_figure(const Finding& finding) {
  return finding.text("effect") +
         " was identified but is in none of these figures: it acts along a path or in one setup";
}

std::string effect_in_no_table(const Finding& finding) {
  return finding.text("effect") +
         " was identified but is in none of the tables: it acts along a path or in one setup";
}

std::string rotary_in_no_table(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  return fmt::format(
      "errors of axis {} were identified but are in none of the tables: tables are for linear axes with {} "
      "at 0",
      axis, axis);
}

std::string rotary_partly_in_tables(const Finding& finding) {
  return fmt::format("the tables hold only {1} of the errors of axis {0}", finding.text("axis"),
                     finding.text("type"));
}

std::string rotary_unknown_to_tables(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  return fmt::format(
      "errors of axis {} were not identified: the tables hold with {} at {:.6g} deg, and what {} does "
      "elsewhere "
      "is in none of these figures; measure with {} in several positions",
      axis, axis, finding.number("position").in_unit() + 0.0, axis, axis);
}

std::string levers_of_tilted_head(const Finding& finding) {
  if (finding.text("axes").empty())
    return fmt::format(
        "tables of linear axes are made with the rotary axes at 0: what the errors of linear axes make of "
        "other positions of these leaves {:.2f} um RMS, {:.2f} um at most over all poses; volcal compensate "
        "corrects a program with the axes where they stand",
        finding.number("rms").in_unit(), finding.number("max").in_unit());
  return fmt::format(
      "tables of linear axes are made with the rotary axes at 0: where the head ({}) is tilted, angles of "
      "linear axes act by another lever, which leaves {:.2f} um RMS, {:.2f} um at most over all poses; "
      "volcal compensate corrects a program with the axes where they stand",
      finding.text("axes"), finding.number("rms").in_unit(), finding.number("max").in_unit());
}

std::string error_at_home_turns(const Finding& finding) {
  return fmt::format(
      "tables of linear axes are zero at home: the error of these axes there, {:.2f} um, is left, and to the "
      "workpiece that a table ({}) turns it is a displacement of the table's line; R-POR corrects it, in a "
      "format that holds that",
      finding.number("error").in_unit(), finding.text("axes"));
}

std::string tables_off_ideal(const Finding& finding) {
  return fmt::format(
      "between their positions the tables are up to {:.2f} um off the ideal compensation: --tolerance takes "
      "as many positions as that needs, {}",
      finding.number("off").in_unit(),
      finding.flag("positions") ? "--step or --positions as many as they say" : "--step as many as it says");
}

std::string rotary_tables_off_ideal(const Finding& finding) {
  if (finding.flag("constants"))
    return fmt::format(
        "the constants of rotary axes are up to {:.2f} um off what R-POR could correct: they say where the "
        "axes are, not how they are tilted, which grids of rotary axes hold",
        finding.number("off").in_unit());
  return fmt::format(
      "tables of rotary axes are up to {:.2f} um off what their types could correct: what changes within one "
      "of their steps, such as the errors of a worm, needs a finer --rotary-step; what depends on two axes "
      "at once is in grids of rotary axes alone",
      finding.number("off").in_unit());
}

std::string rotary_tables_without_directions(const Finding& finding) {
  return fmt::format(
      "tables of rotary axes are the mean of both directions of approach: reversals of these axes leave "
      "{:.2f} "
      "um RMS; neutral-csv and linuxcnc-grid tell directions apart, others need the control's own backlash "
      "compensation",
      finding.number("rms").in_unit());
}

std::string tables_leave_more(const Finding& finding) {
  std::string finer;
  if (finding.flag("step")) finer = "a finer --step";
  if (finding.flag("positions")) finer += " or more --positions";
  if (finding.flag("rotary_step")) finer = "a finer --rotary-step";
  return fmt::format(
      "the machine errs by {:.2f} um RMS with these tables and by {:.2f} without: do not load them; take {}",
      finding.number("with").in_unit(), finding.number("without").in_unit(),
      finer.empty() ? "fewer types, or another format"
                    : finer + ", a format that holds more positions, or fewer types");
}

std::string rotary_may_worsen(const Finding& finding) {
  return fmt::format(
      "what the tables correct of rotary axes is known too badly: {:.2f} um RMS are to be expected with "
      "them, "
      "{:.2f} were identified without: away from the poses that were measured they can make the machine "
      "worse; "
      "measure what the fit names as not visible before they are loaded, or leave out the types R-",
      finding.number("expected").in_unit(), finding.number("before").in_unit());
}

std::string compensations_differ(const Finding& finding) {
  if (!finding.has("measured"))
    return fmt::format(
        "the errors were identified with {} active, which this campaign does not state: where it was "
        "measured without, the figures are of both together; state active_compensations in campaign.toml",
        finding.text("identified"));
  if (finding.has("identified"))
    return fmt::format(
        "these readings were taken with {} active, the errors were identified with {}: the figures are of "
        "both together; take readings and errors with the same compensations active",
        finding.text("measured"), finding.text("identified"));
  return fmt::format(
      "these readings were taken with {} active, which the errors do not know: the figures are of both "
      "together; validate --tables takes out what tables corrected",
      finding.text("measured"));
}

std::string compensations_in_tables(const Finding& finding) {
  return fmt::format(
      "the errors were identified with {} active: where the tables stand in place of these, as superimposed "
      "ones do, what these corrected was taken out twice; give the result that was identified without them",
      finding.text("identified"));
}

std::string compensations_unstated(const Finding& finding) {
  return fmt::format(
      "the campaign {}, and what the tables correct was taken out of its readings: state "
      "active_compensations in campaign.toml, or leave --tables out where they were not active",
      finding.has("stated") ? "states that no compensations were active"
                            : "does not state that tables were active");
}

std::string rotary_not_in_model(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  if (const std::vector<std::string> locations = finding.texts("locations"); !locations.empty())
    return fmt::format(
        "axis {} moves in these readings, and the model file leaves out its location errors {}: what they do "
        "is in the residuals; add {} = 0.0 below [locations], or \"zero\" for each that is known to be none",
        axis, fmt::join(locations, ", "), locations.front());
  if (finding.flag("by_model"))
    return fmt::format(
        "axis {} moves in these readings, and the model file leaves out its errors: what they do is in the "
        "residuals; take default = {{ basis = \"zero\" }} out of the model file, or name its functions and "
        "locations there",
        axis);
  return fmt::format(
      "axis {} moves in these readings, and the model has no errors of it: what they do is in the "
      "residuals{}; "
      "identify them by volcal fit from readings that move {}",
      axis,
      finding.flag("in_uncertainty") ? ", what they may be by their prior in the uncertainty of the model"
                                     : "",
      axis);
}

std::string harmonics_hidden(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  return fmt::format(
      "axis {} stood at {} positions, on a grid of {:.4g} deg: waves of more than {} a turn look there like "
      "longer ones and are in none of the error motions; add positions of {} off that grid",
      axis, finding.count("positions"), finding.number("spacing").in_unit(), finding.count("told"), axis);
}

}  // namespace

std::span<const SentenceMaker> error_sentences() {
  static constexpr auto kSentences = std::to_array<SentenceMaker>({
      {FindingCode::ErrorsHeldBeyondReadings, held_beyond_readings},
      {FindingCode::ErrorsFadedBeyondReadings, faded_beyond_readings},
      {FindingCode::ConditionBeyondReadings, condition_beyond_readings},
      {FindingCode::ConditionWithoutEffect, condition_without_effect},
      {FindingCode::ConditionOnPathsAlone, condition_on_paths_alone},
      {FindingCode::ErrorsOfTables, errors_of_tables},
      {FindingCode::TablesOfOtherTool, tables_of_other_tool},
      {FindingCode::TablesOfOtherConditions, tables_of_other_conditions},
      {FindingCode::EffectInNoTable, effect_in_no_table},
      {FindingCode::EffectInNoFigure, effect_in_no_figure},
      {FindingCode::RotaryErrorsInNoTable, rotary_in_no_table},
      {FindingCode::RotaryErrorsPartlyInTables, rotary_partly_in_tables},
      {FindingCode::RotaryErrorsUnknownToTables, rotary_unknown_to_tables},
      {FindingCode::LeversOfTiltedHead, levers_of_tilted_head},
      {FindingCode::ErrorAtHomeTurns, error_at_home_turns},
      {FindingCode::TablesOffIdeal, tables_off_ideal},
      {FindingCode::RotaryTablesOffIdeal, rotary_tables_off_ideal},
      {FindingCode::RotaryTablesWithoutDirections, rotary_tables_without_directions},
      {FindingCode::TablesLeaveMore, tables_leave_more},
      {FindingCode::RotaryTablesMayWorsen, rotary_may_worsen},
      {FindingCode::CompensationsDiffer, compensations_differ},
      {FindingCode::CompensationsUnstated, compensations_unstated},
      {FindingCode::CompensationsInTables, compensations_in_tables},
      {FindingCode::RotaryErrorsNotInModel, rotary_not_in_model},
      {FindingCode::RotaryHarmonicsHidden, harmonics_hidden},
  });
  return kSentences;
}

}  // namespace volcal
