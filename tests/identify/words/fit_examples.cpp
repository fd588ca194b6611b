// What a fit does not determine, or contradicts.

#include "tests/identify/words/finding_examples.h"
#include "volcal/model/description/units.h"

namespace volcal {

std::vector<WordedFinding> examples_of_fit() {
  return {
      {{FindingCode::NotVisibleVerbatim, {{"error", "ECZ"}, {"reason", "so it is"}, {"remedy", "measure"}}},
       "ECZ: not visible, so it is; measure"},
      {{FindingCode::NotVisibleAxisAtRest, {{"error", "EXX"}, {"axis", "X"}}},
       "EXX: not visible, axis X does not move in this campaign; measure along axis X"},
      {{FindingCode::NotVisibleToolsOnOneAxis, {{"error", "ECZ"}, {"about", "Z"}}},
       "ECZ: not visible, every tool offset lies on Z; add setups with a tool offset sideways to Z (100 mm "
       "or more)"},
      {{FindingCode::NotVisibleNoLeverArm, {{"error", "ECZ"}, {"about", "Z"}}},
       "ECZ: not visible, no reading has a lever arm about Z; add setups with another tool offset, or an "
       "angle instrument about Z"},
      {{FindingCode::NotVisibleNoLeverArm, {{"error", "ECC"}, {"about", "Z"}, {"table", "C"}}},
       "ECC: not visible, no reading stands to the side of the axis of C, across Z; measure at places on the "
       "table 100 mm or more from that axis, or with an angle instrument about Z"},
      {{FindingCode::NotVisibleNoReadingChanges, {{"error", "EXX"}, {"switch", "functions"}}},
       "EXX: not visible, no reading changes when it changes; add readings that are sensitive to it, or "
       "switch it off in the model ([functions] EXX = { basis = \"zero\" })"},
      {{FindingCode::NotVisibleNoReadingChanges, {{"error", "EC0Y"}, {"switch", "locations"}}},
       "EC0Y: not visible, no reading changes when it changes; add readings that are sensitive to it, or "
       "switch it off in the model ([locations] EC0Y = \"zero\")"},
      {{FindingCode::NotVisibleNoReadingChanges, {{"error", "reversal EXX"}}},
       "reversal EXX: not visible, no reading changes when it changes; add readings that are sensitive to "
       "it, or switch it off in the model"},
      {{FindingCode::NotVisibleFewPositions, {{"error", "EXY"}, {"axis", "Y"}}},
       "EXY: not visible, the readings stand at too few positions of axis Y to tell its course between them; "
       "add positions along axis Y"},
      {{FindingCode::NotVisibleFewPositions,
        {{"error", "EXC"},
         {"axis", "C"},
         {"positions", std::int64_t{12}},
         {"told", std::int64_t{5}},
         {"harmonics", std::int64_t{8}},
         {"spacing", FindingNumber{kRadianPerDegree * 30.0, "deg", kRadianPerDegree}}}},
       "EXC: not visible, the readings stand at 12 different positions of axis C, on a grid of 30 deg; "
       "nothing there tells waves of more than 5 a turn from longer ones, and its function has up to 8; add "
       "positions of axis C off that grid, 17 or more in all, or give its function degree = 5"},
      {{FindingCode::NotVisibleLikeStraightness, {{"error", "EC0Y"}, {"axis", "Y"}, {"straightness", "EXY"}}},
       "EC0Y: not visible, the readings stand at too few positions of axis Y, or on too little of its "
       "travel, to tell it from EXY; add positions along the whole travel of axis Y"},
      {{FindingCode::NotVisibleReadingsTooFew, {{"error", "EC0Y"}}},
       "EC0Y: not visible, the readings that depend on it are too few or too noisy; add readings far from "
       "its pivot"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "EAZ"},
         {"partners", Texts{"EYZ", "station P1"}},
         {"remedies", Texts{"stations", "second-tool"}}}},
       "EAZ: not visible, a change of it can be exchanged with EYZ and station P1 without changing any "
       "reading; measure from more stations (four, well apart) and repeat with a second tool offset, "
       "sideways and of another length"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "ECB"},
         {"partners", Texts{"EYB"}},
         {"remedies", Texts{"second-tool", "mandrel"}},
         {"turning", "B"}}},
       "ECB: not visible, a change of it can be exchanged with EYB without changing any reading; turn B with "
       "a second tool offset, sideways and of another length: other tools are in use where it stands still "
       "and turn B with a mandrel whose tip lies 60 mm or more to the side of the spindle's axis"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "EAZ"},
         {"partners", Texts{"EYZ"}},
         {"remedies", Texts{"positions", "third-tool", "holding-instrument"}},
         {"axis", "Z"},
         {"third_tool_across", "Y"}}},
       "EAZ: not visible, a change of it can be exchanged with EYZ without changing any reading; add "
       "positions along axis Z, repeat with a third tool, its tip 100 mm or more to the side in Y (those of "
       "the tools in use lie on one line) and add an instrument that holds position or direction over the "
       "whole travel (tracer, straightness, square)"},
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
       "over its travel, -90 to 90 deg, or state in the machine file the -90 to 30 deg that were measured"},
      {{FindingCode::NotVisibleExchangeable,
        {{"error", "EAZ"}, {"partners", Texts{"EYZ"}}, {"remedies", Texts{"other-lines"}}}},
       "EAZ: not visible, a change of it can be exchanged with EYZ without changing any reading; add lines "
       "at other offsets, straightness or angle readings that tell them apart"},
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
       "deviation of 0.1 mm; correct the value, or state a larger one"},
      {{FindingCode::PriorContradicted,
        {{"block", "scale"},
         {"parameter", ""},
         {"miss", FindingNumber{6e-6, "ppm", 1e-6}},
         {"sigma", FindingNumber{1e-6, "ppm", 1e-6}}}},
       "scale: estimated 6 ppm away from what the files say, 6 times its stated standard deviation of 1 ppm; "
       "correct the value, or state a larger one"},
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
       "0.021 of a displacement along Y, and with its square; errors along Y and their U95 are not to be "
       "trusted; place stations to both sides of that plane, half the travel away or more"},
      {{FindingCode::EffectDriverUnrecorded,
        {{"effect", "EXX by T_air"}, {"readings", std::int64_t{12}}, {"driver", "T_air"}}},
       "EXX by T_air: 12 readings do not record T_air and carry nothing of the effect"},
      {{FindingCode::FitLackOfFit, {{"times", FindingNumber{1.846}}}},
       "lack of fit: residuals are 1.85 times the stated noise; run `volcal compare` to see where the model "
       "fails"},
      {{FindingCode::FitLackOfFit, {{"times", FindingNumber{1.846}}, {"more_than_white", true}}},
       "lack of fit: residuals are 1.85 times the stated noise; an effect that the model lacks can look like "
       "the noise found here, which `volcal diagnose` tells; run `volcal compare` to see where the model "
       "fails"},
      {{FindingCode::FitNotConverged}, "not converged: the cost still fell after the last iteration"},
      {{FindingCode::ModelContradicted,
        {{"leading", "EAX by z^2"},
         {"rms", FindingNumber{1.24e-6, "um", 1e-6}},
         {"log10_p", FindingNumber{-12.34}},
         {"tests", std::int64_t{812}}}},
       "the residuals are not noise: EAX by z^2 would explain 1.2 um RMS of the readings (log10 p -12.3, all "
       "812 tests counted); `volcal diagnose` tells which effect the model lacks"},
      {{FindingCode::ModelContradicted,
        {{"leading", "EAX by z^2"},
         {"rms", FindingNumber{1.24e-6, "um", 1e-6}},
         {"log10_p", FindingNumber{-12.34}},
         {"tests", std::int64_t{812}},
         {"sampled", std::int64_t{50000}}}},
       "the residuals are not noise: EAX by z^2 would explain 1.2 um RMS of the readings (log10 p -12.3, all "
       "812 tests counted, 50000 readings evenly chosen); `volcal diagnose` tells which effect the model "
       "lacks"},
  };
}

}  // namespace volcal
