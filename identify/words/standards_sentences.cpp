/// What the figures of the standards leave out or cannot say, and why a setup is no such test.

#include <fmt/format.h>

#include <array>

#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

std::string removed_readings_used(const Finding& finding) {
  return fmt::format("{} readings that the adjustment left out are in these figures",
                     finding.count("readings"));
}

std::string lines_own_zero(const Finding& finding) {
  if (finding.flag("targets_of_own"))
    return "every line has its own zero and targets of its own: no figure compares them";
  const std::string both = "every line has its own zero: reversal and bidirectional figures are not seen";
  if (!finding.has("direction")) return both;
  return fmt::format("{}; the lines towards {} do not share their targets: no figure of that direction", both,
                     finding.text("direction"));
}

std::string targets_spread(const Finding& finding) {
  const FindingNumber& spread = finding.number("spread");
  return fmt::format("recorded positions within {:.1f} {} were taken as one target", spread.in_unit(),
                     spread.unit);
}

std::string approach_unknown(const Finding& finding) {
  return fmt::format("{} readings of unknown approach are left out", finding.count("readings"));
}

std::string targets_one_sided(const Finding& finding) {
  return fmt::format("{} of {} targets were met from one direction only", finding.count("targets"),
                     finding.count("of"));
}

std::string repeatability_undefined(const Finding&) {
  return "R and A are undefined: they need two approaches of every target from a direction";
}

std::string bar_uncalibrated(const Finding&) {
  return "the bar is not calibrated: F and D contain its length error";
}

std::string rigid_motion_removed(const Finding&) {
  return "readings and model each without their best rigid motion";
}

/// "line_X: line 3 and 1 more: "
std::string place_of_test(const Finding& finding) {
  std::string text = finding.text("setup") + ": ";
  if (!finding.has("line")) return text;
  text += fmt::format("line {}", finding.count("line"));
  if (const std::int64_t more = finding.count("more_lines"); more > 0)
    text += fmt::format(" and {} more", more);
  return text + ": ";
}

std::string without_readings(const Finding& finding) {
  return place_of_test(finding) + "there are no readings";
}

std::string rotary_axis_moves(const Finding& finding) {
  return place_of_test(finding) + "a rotary axis moves";
}

std::string no_axis_moves(const Finding& finding) { return place_of_test(finding) + "no axis moves"; }

std::string several_axes_move(const Finding& finding) {
  return place_of_test(finding) + "more than one axis moves";
}

std::string angle_not_read(const Finding& finding) {
  return fmt::format("{}{} turns, but not about the axis or with the body that the readings show",
                     place_of_test(finding), finding.text("axis"));
}

std::string not_two_axes_move(const Finding& finding) {
  return place_of_test(finding) + "the number of axes that move is not two";
}

std::string no_circle(const Finding& finding) {
  return place_of_test(finding) + "the commanded points do not lie on a circle";
}

std::string no_straight_line(const Finding& finding) {
  return place_of_test(finding) + "the commanded points do not lie on a straight line";
}

std::string beam_across(const Finding& finding) {
  return place_of_test(finding) + "the beam does not lie along the motion of " + finding.text("path");
}

std::string components_missing(const Finding& finding) {
  return place_of_test(finding) + (finding.count("components") == 1
                                       ? "one component of the error vectors only"
                                       : "two components of the error vectors only");
}

}  // namespace

std::span<const SentenceMaker> standards_sentences() {
  static constexpr auto kSentences = std::to_array<SentenceMaker>({
      {FindingCode::StandardsRemovedReadingsUsed, removed_readings_used},
      {FindingCode::StandardsLinesOwnZero, lines_own_zero},
      {FindingCode::StandardsTargetsSpread, targets_spread},
      {FindingCode::StandardsApproachUnknown, approach_unknown},
      {FindingCode::StandardsTargetsOneSided, targets_one_sided},
      {FindingCode::StandardsRepeatabilityUndefined, repeatability_undefined},
      {FindingCode::StandardsBarUncalibrated, bar_uncalibrated},
      {FindingCode::StandardsRigidMotionRemoved, rigid_motion_removed},
      {FindingCode::NoTestWithoutReadings, without_readings},
      {FindingCode::NoTestRotaryAxisMoves, rotary_axis_moves},
      {FindingCode::NoTestNoAxisMoves, no_axis_moves},
      {FindingCode::NoTestSeveralAxesMove, several_axes_move},
      {FindingCode::NoTestAngleNotRead, angle_not_read},
      {FindingCode::NoTestNotTwoAxesMove, not_two_axes_move},
      {FindingCode::NoTestNoCircle, no_circle},
      {FindingCode::NoTestNoStraightLine, no_straight_line},
      {FindingCode::NoTestBeamAcross, beam_across},
      {FindingCode::NoTestComponentsMissing, components_missing},
  });
  return kSentences;
}

}  // namespace volcal
