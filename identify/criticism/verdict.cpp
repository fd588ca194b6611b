#include "volcal/identify/criticism/verdict.h"

#include <fmt/format.h>

#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr std::size_t kMostAmplitudesInWords = 3;
constexpr const char* kNotReducedWords =
    "More remains: readings that were held out are still off by more than noise, hardly less than before. "
    "The effect may be another one that acts in the same places.";
constexpr const char* kKnownMore =
    "More remains, and the catalogue has a name for it: extend the model and diagnose again, or climb with "
    "--auto.";

std::string names(const std::vector<EffectFinding>& findings) {
  std::string text;
  for (const EffectFinding& each : findings) text += (text.empty() ? "" : "; ") + each.label;
  return text;
}

std::string sentence(const EffectFinding& effect) {
  std::string text = effect.label + " (" + effect.name.kind + ")";
  if (effect.amplitudes.size() > kMostAmplitudesInWords) return text;
  for (const AmplitudeFigure& amplitude : effect.amplitudes) {
    text +=
        fmt::format(", {} = {:.3g} +- {:.2g} {}", amplitude.label, amplitude.value / amplitude.si_per_unit,
                    kCoverageFactor * amplitude.u / amplitude.si_per_unit, amplitude.unit);
  }
  return text + (effect.shape_text.empty() ? "" : ", " + effect.shape_text);
}

std::string sentence(const UnknownFinding& unknown) {
  const std::string variables =
      unknown.variables.empty() ? "nothing recorded that was tried" : unknown.dependence();
  return fmt::format("it depends on {}, acts along {}, and is {:.2g} um RMS on the readings", variables,
                     unknown.action(), unknown.rms * kPerMicro);
}

/// "Drawn for it: surface EAY by y z, up to 12.3 +- 0.8 urad at y = 310, z = -120. It cannot say ..."
std::string sentence(const SurfaceFinding& surface) {
  std::string place;
  for (std::size_t i = 0; i < surface.at.size(); ++i)
    place += fmt::format("{}{} = {:.4g}", i > 0 ? ", " : "", surface.drivers[i], surface.at[i]);
  std::string text = fmt::format(
      "Drawn for it: {}, up to {:.3g} +- {:.2g} {} at {}; extend the model with it "
      "and the error falls.",
      surface.label, surface.largest / surface.si_per_unit,
      kCoverageFactor * surface.largest_u / surface.si_per_unit, surface.unit, place);
  for (const FormulaFinding& formula : surface.formulas) {
    text += fmt::format(" {} {}{}, {:.3g} +- {:.2g} {}.",
                        &formula == &surface.formulas.front() ? "A law that explains as much:" : "Or:",
                        formula.label, formula.shape_text.empty() ? "" : " with " + formula.shape_text,
                        formula.amplitude / formula.si_per_unit,
                        kCoverageFactor * formula.u / formula.si_per_unit, formula.unit);
  }
  for (const std::string& free : surface.free) text += " These readings leave open " + free + ".";
  return text;
}

void conclude_named(const Remarks& remarks, Diagnosis& diagnosis) {
  const auto sets = sets_of_alternatives(diagnosis);
  const bool more = !diagnosis.unknown.empty();
  const bool not_reduced = heldout_error_not_reduced(diagnosis.ladder);
  const bool open = more || !sets.empty() || remarks.more_is_known || not_reduced;
  auto& words = diagnosis.words;
  diagnosis.verdict = open ? Verdict::NamedMoreRemains : Verdict::Named;
  for (const EffectFinding& effect : diagnosis.effects)
    words.push_back("The missing effect is: " + sentence(effect));
  for (const auto* set : sets) words.push_back("More remains, one of: " + names(*set));
  if (remarks.more_is_known) words.emplace_back(kKnownMore);
  if (more) words.push_back("More remains: " + sentence(diagnosis.unknown.front()));
  if (not_reduced) words.emplace_back(kNotReducedWords);
}

void conclude_unknown(Diagnosis& diagnosis) {
  auto& words = diagnosis.words;
  diagnosis.verdict = Verdict::Unknown;
  words.push_back("An effect that is in no catalogue: " + sentence(diagnosis.unknown.front()));
  for (const auto* set : sets_of_alternatives(diagnosis)) {
    words.push_back("Nearest in the catalogue, but not all of it: " + names(*set));
  }
}

void conclude_one_of(const Remarks& remarks, Diagnosis& diagnosis) {
  auto& words = diagnosis.words;
  diagnosis.verdict = Verdict::OneOf;
  for (const auto* set : sets_of_alternatives(diagnosis)) {
    words.push_back("One of these is missing, and these readings do not tell them apart: " + names(*set));
  }
  if (remarks.more_is_known) words.emplace_back(kKnownMore);
}

void conclude_nothing(Diagnosis& diagnosis) {
  if (2 * diagnosis.not_visible.size() > diagnosis.detectable.size()) {
    diagnosis.verdict = Verdict::NotVisible;
    diagnosis.words.push_back(fmt::format(
        "Nothing is above the noise, but {} of {} effects would not be visible with this measurement.",
        diagnosis.not_visible.size(), diagnosis.families));
  } else {
    diagnosis.verdict = Verdict::NothingAbove;
    diagnosis.words.emplace_back(
        "Nothing is above the noise; what would have been found is in the table of smallest detectable "
        "amplitudes.");
  }
}

void add_remarks(const Remarks& remarks, Diagnosis& diagnosis) {
  auto& words = diagnosis.words;
  for (const auto& [label, reason] : remarks.rejected)
    words.push_back("Not named " + label + ": " + reason + ".");
  for (const SurfaceFinding& surface : diagnosis.surfaces) words.push_back(sentence(surface));
  if (const std::size_t back = remarks.removed_by_fit - diagnosis.removed_readings.size(); back > 0) {
    words.push_back(
        fmt::format("{} of {} readings that the outlier test had removed agree with the model "
                    "reached and are used again.",
                    back, remarks.removed_by_fit));
  }
  for (const EffectFinding& change : diagnosis.model_changes) {
    words.push_back("The error function " + change.name.target + " needs more knots.");
  }
}

}  // namespace

void conclude(const Remarks& remarks, Diagnosis& diagnosis) {
  if (!diagnosis.effects.empty()) {
    conclude_named(remarks, diagnosis);
  } else if (!diagnosis.unknown.empty()) {
    conclude_unknown(diagnosis);
  } else if (!sets_of_alternatives(diagnosis).empty()) {
    conclude_one_of(remarks, diagnosis);
  } else {
    conclude_nothing(diagnosis);
  }
  add_remarks(remarks, diagnosis);
}

}  // namespace volcal
