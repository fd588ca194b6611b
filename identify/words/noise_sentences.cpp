/// Noise that is not what the setups state.

#include <fmt/format.h>

#include <array>

#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

constexpr const char* kHardlyNoise =
    "; the instrument alone hardly explains this: the model may lack an effect, or the noise table may be "
    "wrong";

std::string sigma_contradicted(const Finding& finding) {
  std::string text = fmt::format(
      "{}: {}{:.3g} times as much as its stated sigma; weights and uncertainties use the estimated value",
      finding.text("instrument"),
      finding.flag("independent_part") ? "the independent part of its residuals scatters "
                                       : "its residuals scatter ",
      finding.number("times").si);
  if (finding.flag("unit_slip")) {
    text +=
        "; is its noise stated in a unit 1000 times too small (nm for um)? check the noise table of its "
        "setups and the unit of the readings";
  }
  if (finding.flag("too_quiet")) {
    text +=
        "; an instrument's readings hardly scatter so little: are they in a larger unit than their columns "
        "say (mm for um, then add scale = { COLUMN = 1000 } to its setups), or were they computed?";
  }
  if (finding.flag("hardly_noise")) text += kHardlyNoise;
  return text;
}

/// "0.41 um"
std::string figure(const FindingNumber& number) {
  return fmt::format("{:.2g} {}", number.in_unit(), number.unit);
}

std::string more_than_white(const Finding& finding) {
  std::vector<std::string> terms;
  if (finding.has("drift")) {
    terms.push_back("correlated drift of " + figure(finding.number("drift")));
    if (finding.has("drift_time"))
      terms.back() += fmt::format(" over {:.0f} s", finding.number("drift_time").si);
  }
  if (finding.has("line_offsets"))
    terms.push_back("offsets of lines of " + figure(finding.number("line_offsets")));
  if (finding.has("per_metre"))
    terms.push_back(figure(finding.number("per_metre")) + " in proportion to length");
  return fmt::format("{}: its noise is not independent ({}); weights and uncertainties allow for it",
                     finding.text("instrument"), fmt::join(terms, ", "));
}

std::string several_times_stated(const Finding& finding) {
  return fmt::format("{}: all its noise together is {:.3g} times what is stated{}",
                     finding.text("instrument"), finding.number("times").si, kHardlyNoise);
}

std::string taken_as_independent(const Finding&) {
  return "robust loss: readings are taken as independent; correlated drift and offsets of lines were not "
         "looked "
         "for";
}

}  // namespace

std::span<const SentenceMaker> noise_sentences() {
  static constexpr auto kSentences = std::to_array<SentenceMaker>({
      {FindingCode::NoiseSigmaContradicted, sigma_contradicted},
      {FindingCode::NoiseMoreThanWhite, more_than_white},
      {FindingCode::NoiseSeveralTimesStated, several_times_stated},
      {FindingCode::NoiseTakenAsIndependent, taken_as_independent},
  });
  return kSentences;
}

}  // namespace volcal
