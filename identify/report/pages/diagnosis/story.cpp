/// The ladder as a story: the error before, what was missing and how we know, the error after, what would not
/// have been found.

#include <fmt/format.h>

#include <cmath>

#include "volcal/identify/report/finding_json.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/values/detectable_groups.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {
namespace {

std::string micrometres(double metres) { return fmt::format("{:.3g} µm", metres * kPerMicro); }

Json step_json(const LadderStep& step) {
  return {{"model", step.model},
          {"added", step.added},
          {"rms_fit_um", rounded(step.rms_fit * kPerMicro)},
          {"rms_heldout_um", rounded(step.rms_heldout * kPerMicro)},
          {"noise_floor_um", rounded(step.noise_floor * kPerMicro)},
          {"systematic_um", rounded(step.systematic * kPerMicro)},
          {"systematic_low_um", rounded(step.systematic_low * kPerMicro)},
          {"systematic_high_um", rounded(step.systematic_high * kPerMicro)},
          {"reduced_chi2", rounded(step.reduced_chi2, 4)},
          {"heldout_loglik_gain", rounded(step.heldout_loglik_gain, 4)}};
}

std::string level(Verdict verdict) {
  switch (verdict) {
    case Verdict::Named:
    case Verdict::NothingAbove:
      return "good";
    case Verdict::NamedMoreRemains:
    case Verdict::OneOf:
    case Verdict::NotVisible:
      return "warning";
    case Verdict::Unknown:
      break;
  }
  return "bad";
}

std::string headline_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::Named:
      return "Named: the missing effect is known";
    case Verdict::NamedMoreRemains:
      return "Named, more remains";
    case Verdict::OneOf:
      return "One of several effects is missing";
    case Verdict::Unknown:
      return "An effect that is not in the catalogue";
    case Verdict::NothingAbove:
      return "Nothing above the noise";
    case Verdict::NotVisible:
      return "Not visible with this measurement";
  }
  return "";
}

std::string interval(const LadderStep& step) {
  return fmt::format("{} (95 %: {:.3g} to {:.3g} µm)", micrometres(step.systematic),
                     step.systematic_low * kPerMicro, step.systematic_high * kPerMicro);
}

std::string before_text(const LadderStep& given) {
  if (std::isnan(given.rms_heldout)) {
    return fmt::format("The given model leaves {} RMS on the readings. No lines could be held out.",
                       micrometres(given.rms_fit));
  }
  return fmt::format(
      "On lines that were held out the given model is wrong by {} RMS. The noise of these readings accounts "
      "for {}; "
      "what is above it, the systematic error, is {}.",
      micrometres(given.rms_heldout), micrometres(given.noise_floor), interval(given));
}

std::string how_known(const EffectFinding& effect, const LadderStep* step) {
  std::string text = fmt::format(
      "chance of so much in a right model 10^{:.0f} over all effects tested; visible "
      "fraction {:.2f}",
      effect.log10_p, effect.visible_fraction);
  if (step != nullptr && std::isfinite(step->heldout_loglik_gain)) {
    text += fmt::format("; log-likelihood of the held-out lines {:+.1f}", step->heldout_loglik_gain);
  }
  return text;
}

const LadderStep* step_of(const Diagnosis& diagnosis, const EffectFinding& effect) {
  for (const LadderStep& step : diagnosis.ladder) {
    if (step.added == effect.label) return &step;
  }
  return nullptr;
}

Json missing_json(const Diagnosis& diagnosis) {
  Json json = Json::array();
  const auto add = [&](const std::vector<EffectFinding>& effects) {
    for (const EffectFinding& effect : effects) {
      Json one = finding_json(effect);
      one["how"] = how_known(effect, step_of(diagnosis, effect));
      one.update(meaning_json(effect.name));
      json.push_back(std::move(one));
    }
  };
  add(diagnosis.effects);
  add(diagnosis.model_changes);
  return json;
}

Json after_json(const Diagnosis& diagnosis) {
  const LadderStep& first = diagnosis.ladder.front();
  const LadderStep& last = diagnosis.ladder.back();
  Json lines = Json::array();
  if (diagnosis.ladder.size() < 2) {
    lines.push_back("The given model is the model reached.");
    if (!diagnosis.unknown.empty()) {
      lines.push_back("The noise was estimated beside what remains, and its floor may hold part of that.");
    }
  } else if (std::isfinite(last.rms_heldout)) {
    const bool only_alternative =
        diagnosis.effects.empty() && diagnosis.model_changes.empty() && diagnosis.surfaces.empty();
    const std::string with =
        only_alternative ? fmt::format("With {}, one of the alternatives, the", last.added) : "The";
    lines.push_back(
        fmt::format("{} systematic error on held-out lines falls from {} to {}; RMS from {} to {}, the noise "
                    "floor being {}.",
                    with, micrometres(first.systematic), interval(last), micrometres(first.rms_heldout),
                    micrometres(last.rms_heldout), micrometres(last.noise_floor)));
  }
  for (const UnknownFinding& unknown : remaining_unknown(diagnosis)) {
    lines.push_back(
        fmt::format("Still seen by the scan without a catalogue: {}, along {}, "
                    "about {} RMS (log10 p {:.1f}).",
                    unknown.in_words(), unknown.action(), micrometres(unknown.rms), unknown.log10_p));
    if (lines.size() == 5) break;
  }
  return lines;
}

/// What would not have been found, by kind.
Json below_json(const Diagnosis& diagnosis) {
  Json json = Json::array();
  for (const DetectableGroup& group : detectable_groups(diagnosis.detectable)) {
    Json one = {{"kind", group.kind},
                {"unit", shown_unit(group.unit)},
                {"effects", group.effects},
                {"not_visible", group.not_visible}};
    if (group.easiest != nullptr) {
      one["smallest"] = rounded(group.easiest->mdb / group.si_per_unit, 3);
      one["largest"] = rounded(group.hardest->mdb / group.si_per_unit, 3);
      one["smallest_label"] = group.easiest->label;
      one["largest_label"] = group.hardest->label;
    }
    json.push_back(std::move(one));
  }
  return json;
}

}  // namespace

Json story_page(const DiagnosisInput& input) {
  const Diagnosis& diagnosis = input.diagnosis;
  Json ladder = Json::array();
  for (const LadderStep& step : diagnosis.ladder) ladder.push_back(step_json(step));
  Json surfaces = Json::array();
  for (const SurfaceFinding& surface : diagnosis.surfaces) surfaces.push_back(surface_json(surface));
  Json one_of = Json::array();
  for (const auto* set : sets_of_alternatives(diagnosis)) {
    Json alternatives = Json::array();
    for (const EffectFinding& effect : *set) {
      alternatives.push_back(finding_json(effect));
      alternatives.back().update(meaning_json(effect.name));
    }
    one_of.push_back(std::move(alternatives));
  }
  return {{"verdict", to_string(diagnosis.verdict)},
          {"level", level(diagnosis.verdict)},
          {"headline", headline_of(diagnosis.verdict)},
          {"words", sentences(diagnosis.findings)},
          {"before", Json::array({before_text(diagnosis.ladder.front())})},
          {"missing", missing_json(diagnosis)},
          {"surfaces", std::move(surfaces)},
          {"one_of", std::move(one_of)},
          {"after", after_json(diagnosis)},
          {"next_measurement", sentences(findings_of(diagnosis.proposals))},
          {"ladder", std::move(ladder)},
          {"below", below_json(diagnosis)},
          {"families", diagnosis.families},
          {"generic_tests", diagnosis.generic_tests},
          {"removed_readings", diagnosis.removed_readings.size()}};
}

}  // namespace volcal::report
