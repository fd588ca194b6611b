#pragma once
/// The codes of findings: one more is one line here, one in finding.cpp and one sentence in identify/words.

#include <span>

#include "volcal/model/description/finding.h"

namespace volcal {

enum class FindingCode : std::uint8_t {
  Verbatim,  ///< a sentence of a file without codes, or of a code of another version
  ReadingsColumnsUnused,
  ReadingsRowsRepeated,
  ReadingsAgainstDirection,
  ReadingsTimesFarApart,
  ReadingsMovesTooFast,
  ReadingsAnglesMisread,
  ReadingsAnglesInRadians,
  ReadingsDuplicated,
  ReadingsDirectionsDerived,
  ReadingsLeftOut,
  ReadingsFlagged,
  ReadingsRemoved,
  NoiseSigmaContradicted,
  NoiseMoreThanWhite,
  NoiseSeveralTimesStated,
  NoiseTakenAsIndependent,
  NotVisibleVerbatim,
  NotVisibleAxisAtRest,
  NotVisibleToolsOnOneAxis,
  NotVisibleNoLeverArm,
  NotVisibleNoReadingChanges,
  NotVisibleFewPositions,
  NotVisibleLikeStraightness,
  NotVisibleReadingsTooFew,
  NotVisibleExchangeable,
  RankHeldByPrior,
  PriorContradicted,
  StationFarFromGuess,
  StationsInPlane,
  EffectDriverUnrecorded,
  FitLackOfFit,
  FitNotConverged,
  ModelContradicted,
  DiagnosisNamed,
  DiagnosisUnknown,
  DiagnosisOneOf,
  DiagnosisNearest,
  DiagnosisChoice,
  DiagnosisDrawn,
  DiagnosisTried,
  DiagnosisMoreOneOf,
  DiagnosisMoreInCatalogue,
  DiagnosisMoreUnknown,
  DiagnosisHeldoutNotReduced,
  DiagnosisNothingAbove,
  DiagnosisNotVisible,
  DiagnosisReadingsReinstated,
  DiagnosisResolution,
  RejectedLeavesMore,
  RejectedDriverStillMoves,
  RejectedAmplitudeVaries,
  RejectedShapeBeyondScan,
  RejectedUnnamedExceeds,
  DirectionsUnrecorded,
  TimesUnrecorded,
  MeasurementNoneSeparates,
  MeasurementSeparates,
  MeasurementShows,
  PlanSetupMore,
  PlanEffectsKnown,
  StandardsRemovedReadingsUsed,
  StandardsLinesOwnZero,
  StandardsTargetsSpread,
  StandardsApproachUnknown,
  StandardsTargetsOneSided,
  StandardsRepeatabilityUndefined,
  StandardsBarUncalibrated,
  StandardsRigidMotionRemoved,
  NoTestWithoutReadings,
  NoTestRotaryAxisMoves,
  NoTestNoAxisMoves,
  NoTestNotTwoAxesMove,
  NoTestNoCircle,
  NoTestNoStraightLine,
  NoTestBeamAcross,
  NoTestComponentsMissing,
  ErrorsHeldBeyondReadings,
  ErrorsFadedBeyondReadings,
  ConditionBeyondReadings,
  ConditionWithoutEffect,
  ConditionOnPathsAlone,
  ErrorsOfTables,
  TablesOfOtherTool,
  TablesOfOtherConditions,
  EffectInNoTable,
  EffectInNoFigure,
  RotaryErrorsInNoTable,
  RotaryErrorsPartlyInTables,
  RotaryErrorsUnknownToTables,
  LeversOfTiltedHead,
  TablesOffIdeal,
  RotaryTablesOffIdeal,
  TablesLeaveMore,
  RotaryErrorsNotInModel,
  RotaryHarmonicsHidden,
  End,  ///< none: how many there are
};

struct FindingCodeRow {
  FindingCode code;
  std::string_view name;
  Severity severity;
};
/// All codes, in the order of the enumeration.
std::span<const FindingCodeRow> finding_codes();

}  // namespace volcal
