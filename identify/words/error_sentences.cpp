/// Where errors are stated without readings, and what of them no table holds.

#include <fmt/format.h>

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

std::string effect_in_no_table(const Finding& finding) {
  return finding.text("effect") + " was identified and is in no table: it acts along a path or in one setup";
}

std::string rotary_in_no_table(const Finding& finding) {
  const std::string& axis = finding.text("axis");
  return fmt::format(
      "errors of axis {} were identified and are in no table: tables are for linear axes with {} at 0", axis,
      axis);
}

std::string rotary_partly_in_tables(const Finding& finding) {
  return fmt::format("of the errors of axis {} the tables hold {} alone", finding.text("axis"),
                     finding.text("type"));
}

std::string rotary_not_in_model(const Finding& finding) {
  const std::string& axis = finding.text("axis");
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
      "axis {} stood at {} positions, on a grid of {:.4g} deg: waves of more than {} a turn look "
      "there like longer ones and are in no error motion; add positions of {} off that grid",
      axis, finding.count("positions"), finding.number("spacing").in_unit(), finding.count("told"), axis);
}

}  // namespace

std::span<const SentenceMaker> error_sentences() {
  static constexpr auto kSentences = std::to_array<SentenceMaker>({
      {FindingCode::ErrorsHeldBeyondReadings, held_beyond_readings},
      {FindingCode::ErrorsFadedBeyondReadings, faded_beyond_readings},
      {FindingCode::ConditionBeyondReadings, condition_beyond_readings},
      {FindingCode::EffectInNoTable, effect_in_no_table},
      {FindingCode::RotaryErrorsInNoTable, rotary_in_no_table},
      {FindingCode::RotaryErrorsPartlyInTables, rotary_partly_in_tables},
      {FindingCode::RotaryErrorsNotInModel, rotary_not_in_model},
      {FindingCode::RotaryHarmonicsHidden, harmonics_hidden},
  });
  return kSentences;
}

}  // namespace volcal
