#include "volcal/model/description/finding.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

constexpr auto kFindingCodes = [] {
  using enum FindingCode;
  return std::to_array<FindingCodeRow>({
      {Verbatim, "verbatim", Severity::Warning},
      {ReadingsColumnsUnused, "readings.columns-unused", Severity::Warning},
      {ReadingsRowsRepeated, "readings.rows-repeated", Severity::Warning},
      {ReadingsAgainstDirection, "readings.against-direction", Severity::Warning},
      {ReadingsTimesFarApart, "readings.times-far-apart", Severity::Warning},
      {ReadingsMovesTooFast, "readings.moves-too-fast", Severity::Warning},
      {ReadingsAnglesMisread, "readings.angles-misread", Severity::Warning},
      {ReadingsPositionsMisread, "readings.positions-misread", Severity::Warning},
      {ReadingsAnglesInRadians, "readings.angles-in-radians", Severity::Warning},
      {ReadingsMisread, "readings.misread", Severity::Warning},
      {ReadingsDuplicated, "readings.duplicated", Severity::Warning},
      {ReadingsDirectionsDerived, "readings.directions-derived", Severity::Note},
      {ReadingsHalfTurns, "readings.half-turns", Severity::Note},
      {MachineCentreAssumed, "machine.centre-assumed", Severity::Note},
      {ReadingsLeftOut, "readings.left-out", Severity::Note},
      {ReadingsFlagged, "readings.flagged", Severity::Warning},
      {ReadingsRemoved, "readings.removed", Severity::Warning},
      {NoiseSigmaContradicted, "noise.sigma-contradicted", Severity::Warning},
      {NoiseMoreThanWhite, "noise.more-than-white", Severity::Note},
      {NoiseSeveralTimesStated, "noise.several-times-stated", Severity::Warning},
      {NoiseTakenAsIndependent, "noise.taken-as-independent", Severity::Note},
      {NotVisibleVerbatim, "rank.not-visible", Severity::Failure},
      {NotVisibleAxisAtRest, "rank.not-visible.axis-at-rest", Severity::Failure},
      {NotVisibleToolsOnOneAxis, "rank.not-visible.tools-on-one-axis", Severity::Failure},
      {NotVisibleNoLeverArm, "rank.not-visible.no-lever-arm", Severity::Failure},
      {NotVisibleNoReadingChanges, "rank.not-visible.no-reading-changes", Severity::Failure},
      {NotVisibleFewPositions, "rank.not-visible.few-positions", Severity::Failure},
      {NotVisibleLikeStraightness, "rank.not-visible.like-straightness", Severity::Failure},
      {NotVisibleReadingsTooFew, "rank.not-visible.readings-too-few", Severity::Failure},
      {NotVisibleExchangeable, "rank.not-visible.exchangeable", Severity::Failure},
      {RankHeldByPrior, "rank.held-by-prior", Severity::Note},
      {PriorContradicted, "prior.contradicted", Severity::Warning},
      {StationFarFromGuess, "station.guess-contradicted", Severity::Warning},
      {StationsInPlane, "station.in-plane", Severity::Warning},
      {EffectDriverUnrecorded, "effect.driver-unrecorded", Severity::Warning},
      {FitLackOfFit, "fit.lack-of-fit", Severity::Failure},
      {FitNotConverged, "fit.not-converged", Severity::Failure},
      {ModelContradicted, "model.contradicted", Severity::Failure},
      {DiagnosisNamed, "diagnosis.named", Severity::Warning},
      {DiagnosisUnknown, "diagnosis.unknown", Severity::Warning},
      {DiagnosisOneOf, "diagnosis.one-of", Severity::Warning},
      {DiagnosisNearest, "diagnosis.nearest", Severity::Note},
      {DiagnosisChoice, "diagnosis.choice", Severity::Note},
      {DiagnosisDrawn, "diagnosis.drawn", Severity::Note},
      {DiagnosisTried, "diagnosis.tried", Severity::Note},
      {DiagnosisWithoutSurfaces, "diagnosis.without-surfaces", Severity::Note},
      {DiagnosisMoreOneOf, "diagnosis.more-one-of", Severity::Warning},
      {DiagnosisMoreInCatalogue, "diagnosis.more-in-catalogue", Severity::Warning},
      {DiagnosisMoreUnknown, "diagnosis.more-unknown", Severity::Warning},
      {DiagnosisHeldoutNotReduced, "diagnosis.heldout-error-not-reduced", Severity::Warning},
      {DiagnosisNothingAbove, "diagnosis.nothing-above", Severity::Note},
      {DiagnosisNotVisible, "diagnosis.not-visible", Severity::Warning},
      {DiagnosisReadingsReinstated, "diagnosis.readings-reinstated", Severity::Note},
      {DiagnosisResolution, "diagnosis.resolution", Severity::Note},
      {RejectedLeavesMore, "diagnosis.rejected.leaves-more", Severity::Note},
      {RejectedDriverStillMoves, "diagnosis.rejected.driver-still-moves", Severity::Note},
      {RejectedAmplitudeVaries, "diagnosis.rejected.amplitude-varies", Severity::Note},
      {RejectedShapeBeyondScan, "diagnosis.rejected.shape-beyond-scan", Severity::Note},
      {RejectedUnnamedExceeds, "diagnosis.rejected.unnamed-exceeds", Severity::Note},
      {DirectionsUnrecorded, "diagnosis.directions-unrecorded", Severity::Note},
      {TimesUnrecorded, "diagnosis.times-unrecorded", Severity::Note},
      {MeasurementNoneSeparates, "measurement.none-separates", Severity::Note},
      {MeasurementSeparates, "measurement.separates", Severity::Note},
      {MeasurementShows, "measurement.shows", Severity::Note},
      {PlanSetupMore, "plan.setup-more", Severity::Note},
      {PlanEffectsKnown, "plan.effects-known", Severity::Note},
      {PlanOptionsLeft, "plan.options-left", Severity::Note},
      {StandardsRemovedReadingsUsed, "standards.removed-readings-used", Severity::Note},
      {StandardsLinesOwnZero, "standards.lines-own-zero", Severity::Note},
      {StandardsTargetsSpread, "standards.targets-spread", Severity::Note},
      {StandardsApproachUnknown, "standards.approach-unknown", Severity::Warning},
      {StandardsTargetsOneSided, "standards.targets-one-sided", Severity::Note},
      {StandardsRepeatabilityUndefined, "standards.repeatability-undefined", Severity::Note},
      {StandardsBarUncalibrated, "standards.bar-uncalibrated", Severity::Note},
      {StandardsRigidMotionRemoved, "standards.rigid-motion-removed", Severity::Note},
      {NoTestWithoutReadings, "standards.no-test.without-readings", Severity::Note},
      {NoTestRotaryAxisMoves, "standards.no-test.rotary-axis-moves", Severity::Note},
      {NoTestNoAxisMoves, "standards.no-test.no-axis-moves", Severity::Note},
      {NoTestSeveralAxesMove, "standards.no-test.several-axes-move", Severity::Note},
      {NoTestAngleNotRead, "standards.no-test.angle-not-read", Severity::Note},
      {NoTestNotTwoAxesMove, "standards.no-test.not-two-axes-move", Severity::Note},
      {NoTestNoCircle, "standards.no-test.no-circle", Severity::Note},
      {NoTestNoStraightLine, "standards.no-test.no-straight-line", Severity::Note},
      {NoTestBeamAcross, "standards.no-test.beam-across", Severity::Note},
      {NoTestComponentsMissing, "standards.no-test.components-missing", Severity::Note},
      {ErrorsHeldBeyondReadings, "errors.held-beyond-readings", Severity::Warning},
      {ErrorsFadedBeyondReadings, "errors.faded-beyond-readings", Severity::Warning},
      {ConditionBeyondReadings, "errors.condition-beyond-readings", Severity::Warning},
      {ConditionWithoutEffect, "errors.condition-without-effect", Severity::Warning},
      {ConditionOnPathsAlone, "errors.condition-on-paths-alone", Severity::Warning},
      {ErrorsOfTables, "errors.of-tables", Severity::Warning},
      {TablesOfOtherTool, "errors.tables-of-other-tool", Severity::Warning},
      {TablesOfOtherConditions, "errors.tables-of-other-conditions", Severity::Warning},
      {EffectInNoTable, "effect.in-no-table", Severity::Warning},
      {EffectInNoFigure, "effect.in-no-figure", Severity::Warning},
      {RotaryErrorsInNoTable, "errors.rotary-in-no-table", Severity::Warning},
      {RotaryErrorsPartlyInTables, "errors.rotary-partly-in-tables", Severity::Warning},
      {RotaryErrorsUnknownToTables, "errors.rotary-unknown-to-tables", Severity::Warning},
      {LeversOfTiltedHead, "compensation.levers-of-tilted-head", Severity::Warning},
      {ErrorAtHomeTurns, "compensation.error-at-home-turns", Severity::Warning},
      {TablesOffIdeal, "compensation.tables-off-ideal", Severity::Warning},
      {RotaryTablesOffIdeal, "compensation.rotary-tables-off-ideal", Severity::Warning},
      {RotaryTablesWithoutDirections, "compensation.rotary-tables-without-directions", Severity::Warning},
      {TablesLeaveMore, "compensation.tables-leave-more", Severity::Failure},
      {RotaryTablesMayWorsen, "compensation.rotary-may-worsen", Severity::Warning},
      {RotaryErrorsNotInModel, "errors.rotary-not-in-model", Severity::Warning},
      {RotaryHarmonicsHidden, "errors.rotary-harmonics-hidden", Severity::Note},
      {CompensationsDiffer, "compensation.active-differ", Severity::Warning},
      {CompensationsUnstated, "compensation.active-unstated", Severity::Warning},
      {CompensationsInTables, "compensation.active-in-tables", Severity::Warning},
  });
}();
static_assert(kFindingCodes.size() == static_cast<std::size_t>(FindingCode::End), "every code has one name");
static_assert(
    [] {
      for (std::size_t i = 0; i < kFindingCodes.size(); ++i) {
        if (kFindingCodes[i].code != static_cast<FindingCode>(i)) return false;
      }
      return true;
    }(),
    "codes and names stand in the same order");

const FindingCodeRow& row_of(FindingCode code) { return kFindingCodes.at(static_cast<std::size_t>(code)); }

template <class T>
const T& value_of(const Finding& finding, const std::string& key) {
  const auto found = finding.data.find(key);
  const T* value = found == finding.data.end() ? nullptr : std::get_if<T>(&found->second);
  if (value == nullptr) {
    throw std::invalid_argument("a finding \"" + std::string(to_string(finding.code)) + "\" without its \"" +
                                key + "\"");
  }
  return *value;
}

template <class T>
T value_or_none(const Finding& finding, const std::string& key) {
  return finding.has(key) ? value_of<T>(finding, key) : T{};
}

}  // namespace

std::string_view to_string(Severity severity) {
  switch (severity) {
    case Severity::Note:
      return "note";
    case Severity::Warning:
      return "warning";
    case Severity::Failure:
      return "failure";
  }
  return "";
}

std::span<const FindingCodeRow> finding_codes() { return kFindingCodes; }

std::string_view to_string(FindingCode code) { return row_of(code).name; }

std::optional<FindingCode> finding_code(std::string_view name) {
  const auto found = std::ranges::find(kFindingCodes, name, &FindingCodeRow::name);
  return found == kFindingCodes.end() ? std::nullopt : std::optional(found->code);
}

Severity Finding::severity() const { return row_of(code).severity; }

const std::string& Finding::text(const std::string& key) const { return value_of<std::string>(*this, key); }

std::int64_t Finding::count(const std::string& key) const { return value_of<std::int64_t>(*this, key); }

const FindingNumber& Finding::number(const std::string& key) const {
  return value_of<FindingNumber>(*this, key);
}

bool Finding::flag(const std::string& key) const { return value_or_none<bool>(*this, key); }

std::vector<std::string> Finding::texts(const std::string& key) const {
  return value_or_none<std::vector<std::string>>(*this, key);
}

std::vector<std::int64_t> Finding::counts(const std::string& key) const {
  return value_or_none<std::vector<std::int64_t>>(*this, key);
}

std::vector<FindingNumber> Finding::numbers(const std::string& key) const {
  return value_or_none<std::vector<FindingNumber>>(*this, key);
}

Finding verbatim(std::string text) { return {FindingCode::Verbatim, {{"text", std::move(text)}}}; }

}  // namespace volcal
