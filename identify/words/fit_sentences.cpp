/// What a finished adjustment shows of the readings, the files and the model.

#include <fmt/format.h>

#include <array>

#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

std::string flagged(const Finding& finding) {
  return fmt::format(
      "{} readings are flagged by the w-test and still in the adjustment; they are listed in "
      "residuals.csv ({})",
      finding.count("readings"),
      finding.flag("some_removed") ? "so many were removed before that the model or the stated "
                                     "noise must be in doubt: run `volcal compare`"
                                   : "--outliers remove takes them out");
}

std::string removed(const Finding& finding) {
  return fmt::format("{} readings were removed by the w-test; they are listed in residuals.csv",
                     finding.count("readings"));
}

std::string prior_contradicted(const Finding& finding) {
  const FindingNumber& miss = finding.number("miss");
  const FindingNumber& sigma = finding.number("sigma");
  const std::string& parameter = finding.text("parameter");
  return fmt::format(
      "{}{}: estimated {:.3g} {} away from what the files say, {:.3g} times its {} standard deviation of "
      "{:.3g} {}; correct the value, or state a larger one",
      finding.text("block"), parameter.empty() ? "" : " " + parameter, miss.in_unit(), miss.unit,
      miss.si / sigma.si, finding.flag("default") ? "default" : "stated", sigma.in_unit(), sigma.unit);
}

std::string station_far_from_guess(const Finding& finding) {
  return fmt::format(
      "{}: found {:.0f} mm from its guess; write [{:.0f}, {:.0f}, {:.0f}] mm in the campaign file{}",
      finding.text("block"), finding.number("distance").si * 1e3, finding.number("x").si * 1e3,
      finding.number("y").si * 1e3, finding.number("z").si * 1e3,
      finding.flag("guess_in_metres") ? " (is the guess in m?)" : "");
}

std::string stations_in_plane(const Finding& finding) {
  const std::string& across = finding.text("axis");
  return fmt::format(
      "every station stands close to the plane in which the machine moves: a length changes by at most "
      "{:.2g} "
      "of a displacement along {}, and with its square; errors along {} and their U95 are not to be "
      "trusted; place stations to both sides of that plane, half the travel away or more",
      finding.number("share").si, across, across);
}

std::string driver_unrecorded(const Finding& finding) {
  return fmt::format("{}: {} readings do not record {} and carry nothing of the effect",
                     finding.text("effect"), finding.count("readings"), finding.text("driver"));
}

std::string lack_of_fit(const Finding& finding) {
  return fmt::format(
      "lack of fit: residuals are {:.3g} times the stated noise; {}run `volcal compare` to see where "
      "the model fails",
      finding.number("times").si,
      finding.flag("more_than_white")
          ? "an effect that the model lacks can look like the noise found here, which `volcal "
            "diagnose` tells; "
          : "");
}

std::string not_converged(const Finding&) {
  return "not converged: the cost still fell after the last iteration";
}

}  // namespace

std::span<const SentenceMaker> fit_sentences() {
  static constexpr auto kSentences = std::to_array<SentenceMaker>({
      {FindingCode::ReadingsFlagged, flagged},
      {FindingCode::ReadingsRemoved, removed},
      {FindingCode::PriorContradicted, prior_contradicted},
      {FindingCode::StationFarFromGuess, station_far_from_guess},
      {FindingCode::StationsInPlane, stations_in_plane},
      {FindingCode::EffectDriverUnrecorded, driver_unrecorded},
      {FindingCode::FitLackOfFit, lack_of_fit},
      {FindingCode::FitNotConverged, not_converged},
  });
  return kSentences;
}

}  // namespace volcal
