/// What to measure next: proposals of a diagnosis and setups that a plan could have in addition.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

constexpr std::size_t kEffectsInWords = 4;

/// "EXX reversal from EYX reversal"
std::string both_effects(const Finding& finding) {
  const std::vector<std::string> effects = finding.texts("effects");
  if (effects.size() != 2) throw std::invalid_argument("not two effects to be separated");
  return effects[0] + " from " + effects[1];
}

/// "Measure P1 again with tool short after 3 h (48 readings): "
std::string what_is_measured(const Finding& finding) {
  std::string text = finding.text("measurement");
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + fmt::format(" ({} readings): ", finding.count("readings"));
}

/// Two decimals where they matter: "1.04", "5.3", "150".
std::string factor_in_words(double gain) {
  return fmt::format("{:.{}f}", gain, gain < 2.0 ? 2 : gain < 20.0 ? 1 : 0);
}

std::string none_separates(const Finding& finding) {
  const std::string none = "No candidate measurement separates " + both_effects(finding);
  if (!finding.has("difference")) return none + ": they predict nearly the same readings.";
  return none + fmt::format(
                    " well enough to be worth its time. This does not matter: in the measured volume their "
                    "predictions differ by at most {:.2g} um (U {:.2g} um){}.",
                    finding.number("difference").in_unit(), finding.number("U").in_unit(),
                    at_conditions(finding));
}

std::string separates(const Finding& finding) {
  const double gain = finding.number("gain").si, plain = finding.number("plain_gain").si;
  std::string text = what_is_measured(finding) + "separates " + both_effects(finding);
  text += std::isinf(gain) ? ", which the present readings cannot do"
                           : " " + factor_in_words(gain) + " times better";
  text += "; as many more readings like the present ones ";
  return text +
         (std::isinf(plain) ? "would do so, too." : "do so " + factor_in_words(plain) + " times better.");
}

std::string shows(const Finding& finding) {
  const std::vector<std::string> effects = finding.texts("effects");
  std::string names;
  for (std::size_t k = 0; k < std::min(effects.size(), kEffectsInWords); ++k)
    names += (k > 0 ? ", " : "") + effects[k];
  if (effects.size() > kEffectsInWords) names += ", ...";
  if (finding.has("detectable")) {
    const FindingNumber& detectable = finding.number("detectable");
    return what_is_measured(finding) +
           fmt::format("makes {} visible from {:.2g} {} on.", names, detectable.in_unit(), detectable.unit);
  }
  return what_is_measured(finding) +
         fmt::format("makes {} of {} effects visible that are not visible now: {}.", effects.size(),
                     finding.count("of"), names);
}

/// "[500, -200, 350] mm"
std::string point_in_words(const std::vector<FindingNumber>& point) {
  if (point.size() != 3) throw std::invalid_argument("a point has three coordinates");
  return fmt::format("[{:.0f}, {:.0f}, {:.0f}] {}", point[0].in_unit(), point[1].in_unit(),
                     point[2].in_unit(), point[0].unit);
}

/// "tool side_x at P1", "a further station at [...] mm with tool short"
std::string setup_more(const Finding& finding) {
  const std::string tool = finding.has("offset_of_new_tool")
                               ? "a tool of offset " + point_in_words(finding.numbers("offset_of_new_tool"))
                               : "tool " + finding.text("tool");
  if (!finding.has("new_place")) return tool + " at " + finding.text("place");
  return fmt::format("a further {} at {} with {}", finding.text("kind_of_place"),
                     point_in_words(finding.numbers("new_place")), tool);
}

std::string effects_known(const Finding& finding) {
  const std::string known = "The plan takes as known, as the model states it: " +
                            fmt::format("{}", fmt::join(finding.texts("effects"), "; ")) + ".";
  if (!finding.has("columns")) return known + " It belongs to setups of the campaign in which it was found.";
  return known + " Positions are planned, not conditions; where readings record " +
         fmt::format("{}", fmt::join(finding.texts("columns"), ", ")) +
         " and that changes, a fit identifies it anew.";
}

std::string options_left(const Finding& /*finding*/) {
  return "What one setup more would bring is not in this plan: the search for it was interrupted.";
}

}  // namespace

std::span<const SentenceMaker> measurement_sentences() {
  static constexpr auto kSentences = std::to_array<SentenceMaker>({
      {FindingCode::MeasurementNoneSeparates, none_separates},
      {FindingCode::MeasurementSeparates, separates},
      {FindingCode::MeasurementShows, shows},
      {FindingCode::PlanSetupMore, setup_more},
      {FindingCode::PlanEffectsKnown, effects_known},
      {FindingCode::PlanOptionsLeft, options_left},
  });
  return kSentences;
}

}  // namespace volcal
