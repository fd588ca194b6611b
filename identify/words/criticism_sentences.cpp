/// What model criticism finds.

#include <fmt/format.h>

#include <array>
#include <stdexcept>

#include "volcal/identify/text/uncertain_number.h"
#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"

namespace volcal {
namespace {

std::string model_contradicted(const Finding& finding) {
  return contradiction(finding) + "; `volcal diagnose` tells which effect the model lacks";
}

constexpr std::size_t kMostAmplitudesInWords = 3;

std::string named(const Finding& finding) {
  std::string text = "The missing effect is: " + finding.text("effect") + " (" + finding.text("kind") + ")";
  const std::vector<std::string> amplitudes = finding.texts("amplitudes");
  const std::vector<FindingNumber> values = finding.numbers("values");
  const std::vector<FindingNumber> expanded = finding.numbers("U");
  if (values.size() != amplitudes.size() || expanded.size() != amplitudes.size())
    throw std::invalid_argument("there is not one value and one U for each amplitude");
  if (amplitudes.size() > kMostAmplitudesInWords) return text;
  for (std::size_t i = 0; i < amplitudes.size(); ++i) {
    text += fmt::format(", {} = {} {}", amplitudes[i],
                        value_with_u(values[i].in_unit(), expanded[i].in_unit()), values[i].unit);
  }
  return text + (finding.text("shape").empty() ? "" : ", " + finding.text("shape"));
}

std::string dependence(const Finding& finding) {
  const std::vector<std::string> variables = finding.texts("depends_on");
  if (variables.empty()) return "nothing recorded that was tried";
  std::string text = fmt::format("{}", fmt::join(variables, " and "));
  if (finding.has("and_one_of"))
    text += fmt::format(" and one of {}", fmt::join(finding.texts("and_one_of"), ", "));
  return text;
}

std::string unnamed(const Finding& finding) {
  std::string action = finding.text("direction");
  if (finding.has("rotation")) {
    action += ", as " + finding.text("rotation");
  } else if (finding.has("period")) {
    action += fmt::format(", every {:.4g} mm", finding.number("period").si * 1e3);
  }
  std::string text = fmt::format("it depends on {}, and acts along {}", dependence(finding), action);
  if (!finding.flag("drawn"))
    text += fmt::format("; its strongest test explains {:.2g} um RMS of the readings",
                        finding.number("rms").si * kPerMicro);
  return text;
}

std::string unknown(const Finding& finding) {
  return "An effect that is not in the catalogue: " + unnamed(finding);
}

std::string more_unknown(const Finding& finding) { return "More remains: " + unnamed(finding); }

std::string names(const Finding& finding) {
  return fmt::format("{}", fmt::join(finding.texts("effects"), "; "));
}

std::string one_of(const Finding& finding) {
  return "One of these is missing, and these readings do not tell them apart: " + names(finding);
}

std::string nearest(const Finding& finding) {
  return "Nearest in the catalogue, but not all of it: " + names(finding);
}

/// Of alternatives, the one that the extended model holds.
std::string choice(const Finding& finding) {
  const std::string chosen = "The extended model goes on with the simplest, " + finding.text("chosen");
  if (!finding.has("difference")) return chosen + ".";
  const std::string differ = fmt::format("{:.2g} um (U {:.2g} um){}", finding.number("difference").in_unit(),
                                         finding.number("U").in_unit(), at_conditions(finding));
  if (!finding.flag("matters"))
    return chosen + "; in the volume it does not matter: predictions differ by at most " + differ + ".";
  return chosen + "; it matters in the volume: with " + finding.text("other") +
         " predictions differ by up to " + differ + ".";
}

/// " A law that explains as much: EAY by y * z^2 with p = 120, 1.2 +- 0.1 urad."
std::string laws(const Finding& finding) {
  const std::vector<std::string> labels = finding.texts("laws"), shapes = finding.texts("law_shapes");
  const std::vector<FindingNumber> amplitudes = finding.numbers("law_amplitudes");
  const std::vector<FindingNumber> expanded = finding.numbers("law_U");
  const std::size_t count = labels.size();
  if (shapes.size() != count || amplitudes.size() != count || expanded.size() != count)
    throw std::invalid_argument("there is not one shape, amplitude and U for each law");
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += fmt::format(" {} {}{}, {} {}.", i == 0 ? "A law that explains as much:" : "Or:", labels[i],
                        shapes[i].empty() ? "" : " with " + shapes[i],
                        value_with_u(amplitudes[i].in_unit(), expanded[i].in_unit()), amplitudes[i].unit);
  }
  return text;
}

/// "Drawn for it: surface EAY by y z, up to 12.3 +- 0.8 urad at y = 310 mm, z = -120 mm; ..."
std::string drawn(const Finding& finding) {
  const std::vector<std::string> drivers = finding.texts("drivers");
  const std::vector<FindingNumber> numbers = finding.numbers("at");
  if (drivers.size() != numbers.size()) throw std::invalid_argument("there is not one value for each driver");
  std::vector<double> at;
  for (const FindingNumber& number : numbers) at.push_back(number.si);
  const FindingNumber& largest = finding.number("largest");
  std::string text =
      fmt::format("Drawn for it: {}, up to {} {} at {}", finding.text("effect"),
                  value_with_u(largest.in_unit(), finding.number("U").in_unit()), largest.unit,
                  place_in_words(variables_in(fmt::format("{}", fmt::join(drivers, " "))), at));
  if (finding.has("removes"))
    text +=
        fmt::format("; it removes {:.2g} um RMS from the readings", finding.number("removes").si * kPerMicro);
  text += "; extend the model with it and the error falls.";
  text += laws(finding);
  for (const std::string& part : finding.texts("left_open"))
    text += " These readings leave open " + part + ".";
  return text;
}

/// What became of an effect that the user thought of.
std::string tried(const Finding& finding) {
  const std::string effect = "Your own, " + finding.text("effect") + ": ";
  if (!finding.flag("visible")) return effect + "these readings do not see it.";
  const std::string became = finding.flag("added")         ? "it is what was missing"
                             : finding.flag("alternative") ? "it is one of those that explain the readings"
                                                           : "the readings do not support it";
  std::string text =
      fmt::format("{}{} (log10 p {:.1f} with all {} tests counted, gain {:.3g})", effect, became,
                  finding.number("log10_p").si, finding.count("tests"), finding.number("gain").si);
  if (finding.has("systematic")) {
    const auto um = [&finding](const char* key) { return finding.number(key).si * 1e6; };
    text += fmt::format("; held-out readings keep {:.2g} um of systematic error with it", um("systematic"));
    const bool is_explained = finding.flag("added") || finding.flag("alternative");
    if (!is_explained) text += fmt::format(", {:.2g} um without it", um("systematic_reached"));
    text += fmt::format(", {:.2g} um as given", um("systematic_given"));
  }
  if (finding.has("nearest"))
    text += fmt::format("; nearest to it in these readings is {}, cosine {:.3f}", finding.text("nearest"),
                        finding.number("cosine").si);
  return text + ".";
}

std::string without_surfaces(const Finding& finding) {
  return "The model was criticised without what laws were looked for in the place of, " + names(finding) +
         "; the extended model and `volcal extend` leave this out, too.";
}

std::string more_one_of(const Finding& finding) { return "More remains, one of: " + names(finding); }

std::string more_in_catalogue(const Finding&) {
  return "More remains, and the catalogue has a name for it: extend the model and diagnose again, or climb "
         "with "
         "--auto.";
}

std::string heldout_not_reduced(const Finding&) {
  return "More remains: readings that were held out are still off by more than noise, hardly less than "
         "before. "
         "The effect may be another one that acts in the same places.";
}

std::string nothing_above(const Finding&) {
  return "Nothing is above the noise; what would have been found is in the table of smallest detectable "
         "amplitudes.";
}

std::string effects_not_visible(const Finding& finding) {
  return fmt::format(
      "Nothing is above the noise, but {} of {} effects would not be visible with this measurement.",
      finding.count("not_visible"), finding.count("families"));
}

std::string reinstated(const Finding& finding) {
  return fmt::format(
      "{} of {} readings that the outlier test had removed agree with the model reached and are used "
      "again.",
      finding.count("readings"), finding.count("of"));
}

std::string resolution(const Finding& finding) {
  return "The error function " + finding.text("function") + " needs more knots.";
}

std::string not_named(const Finding& finding, const std::string& reason) {
  return "Not named " + finding.text("effect") + ": " + reason + ".";
}

std::string leaves_more(const Finding& finding) {
  return not_named(finding, "what it leaves exceeds the noise more than it does");
}

std::string driver_still_moves(const Finding& finding) {
  return not_named(finding,
                   fmt::format("{} still moves what it leaves", fmt::join(finding.texts("drivers"), " or ")));
}

std::string amplitude_varies(const Finding& finding) {
  return not_named(finding, fmt::format("its amplitude varies with {} (log10 p {:.1f})",
                                        finding.text("variable"), finding.number("log10_p").si));
}

std::string shape_beyond_scan(const Finding& finding) {
  return not_named(finding, "its " + finding.text("shape") + " lies beyond what was looked for");
}

std::string unnamed_exceeds(const Finding& finding) {
  return not_named(finding, "what has no name exceeds the noise more than it does");
}

std::string directions_unrecorded(const Finding& finding) {
  return fmt::format("Not looked for, as no reading records {}: {}.",
                     fmt::join(finding.texts("columns"), ", "), fmt::join(finding.texts("kinds"), ", "));
}

std::string times_unrecorded(const Finding& finding) {
  return fmt::format("Not looked for, as no reading records its time (time_s): {}.",
                     fmt::join(finding.texts("kinds"), ", "));
}

}  // namespace

std::string contradiction(const Finding& finding) {
  const std::string readings =
      finding.has("sampled") ? fmt::format(", {} readings evenly chosen", finding.count("sampled")) : "";
  return fmt::format(
      "the residuals are not noise: {} would explain {:.2g} um RMS of the readings (log10 p {:.1f}, all {} "
      "tests counted{})",
      finding.text("leading"), finding.number("rms").si * 1e6, finding.number("log10_p").si,
      finding.count("tests"), readings);
}

std::string at_conditions(const Finding& finding) {
  if (!finding.has("conditions")) return {};
  const std::vector<std::string> names = finding.texts("conditions");
  const std::vector<FindingNumber> values = finding.numbers("condition_values");
  if (names.size() != values.size()) throw std::invalid_argument("there is not one value for each condition");
  std::vector<double> at;
  for (const FindingNumber& value : values) at.push_back(value.in_unit());
  return " at " + place_in_words(variables_in(fmt::format("{}", fmt::join(names, " "))), at);
}

std::span<const SentenceMaker> criticism_sentences() {
  static constexpr auto kSentences = std::to_array<SentenceMaker>({
      {FindingCode::ModelContradicted, model_contradicted},
      {FindingCode::DiagnosisNamed, named},
      {FindingCode::DiagnosisUnknown, unknown},
      {FindingCode::DiagnosisOneOf, one_of},
      {FindingCode::DiagnosisNearest, nearest},
      {FindingCode::DiagnosisChoice, choice},
      {FindingCode::DiagnosisDrawn, drawn},
      {FindingCode::DiagnosisTried, tried},
      {FindingCode::DiagnosisWithoutSurfaces, without_surfaces},
      {FindingCode::DiagnosisMoreOneOf, more_one_of},
      {FindingCode::DiagnosisMoreInCatalogue, more_in_catalogue},
      {FindingCode::DiagnosisMoreUnknown, more_unknown},
      {FindingCode::DiagnosisHeldoutNotReduced, heldout_not_reduced},
      {FindingCode::DiagnosisNothingAbove, nothing_above},
      {FindingCode::DiagnosisNotVisible, effects_not_visible},
      {FindingCode::DiagnosisReadingsReinstated, reinstated},
      {FindingCode::DiagnosisResolution, resolution},
      {FindingCode::RejectedLeavesMore, leaves_more},
      {FindingCode::RejectedDriverStillMoves, driver_still_moves},
      {FindingCode::RejectedAmplitudeVaries, amplitude_varies},
      {FindingCode::RejectedShapeBeyondScan, shape_beyond_scan},
      {FindingCode::RejectedUnnamedExceeds, unnamed_exceeds},
      {FindingCode::DirectionsUnrecorded, directions_unrecorded},
      {FindingCode::TimesUnrecorded, times_unrecorded},
  });
  return kSentences;
}

}  // namespace volcal
