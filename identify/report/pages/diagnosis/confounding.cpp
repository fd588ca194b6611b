/// Which hypotheses the readings hardly separate, and which measurement would.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/effects/registry.h"

namespace volcal::report {
namespace {

constexpr int kCosineDigits = 6;  // the page tells a squared sine of same_squared_sine from zero

const EffectFinding* find_in(const std::vector<EffectFinding>& findings, const EffectName& name) {
  const auto found = std::ranges::find(findings, name, &EffectFinding::name);
  return found == findings.end() ? nullptr : &*found;
}

/// What became of a hypothesis: "added", "alternative" (ONE_OF), "candidate".
struct Place {
  const char* role = "candidate";
  const EffectFinding* finding = nullptr;
};

Place place_of(const Diagnosis& diagnosis, const EffectName& name) {
  for (const auto* list : {&diagnosis.effects, &diagnosis.model_changes}) {
    if (const EffectFinding* finding = find_in(*list, name)) return {"added", finding};
  }
  for (const auto* set : sets_of_alternatives(diagnosis)) {
    if (const EffectFinding* finding = find_in(*set, name)) return {"alternative", finding};
  }
  for (const auto* list : {&diagnosis.ranking, &diagnosis.not_visible}) {
    if (const EffectFinding* finding = find_in(*list, name)) return {"candidate", finding};
  }
  return {};
}

/// MDB and MIB of the amplitudes; a MIB that is null beside a rival: not separable from it.
Json limits_json(const EffectFinding& finding) {
  Json limits = Json::array();
  for (const AmplitudeFigure& each : finding.amplitudes) {
    limits.push_back({{"label", each.label},
                      {"mdb", rounded(each.mdb / each.si_per_unit, 3)},
                      {"mib", rounded(each.mib / each.si_per_unit, 3)},
                      {"rival", each.mib_rival},
                      {"unit", shown_unit(each.unit)}});
  }
  return limits;
}

Json effect_json(const Diagnosis& diagnosis, const EffectName& name, const std::string& label) {
  const auto [role, finding] = place_of(diagnosis, name);
  return {{"label", label},
          {"kind", name.kind},
          {"driver", name.driver.name()},
          {"name", full_name(name)},
          {"role", role},
          {"can_be_asked", find_effect(name.kind) != nullptr},
          {"limits", finding == nullptr ? Json::array() : limits_json(*finding)}};
}

/// Name of an effect as findings are labelled.
std::string label_of(const Diagnosis& diagnosis, const EffectName& name) {
  const EffectFinding* finding = place_of(diagnosis, name).finding;
  return finding == nullptr ? full_name(name) : finding->label;
}

/// What is done, without what it is good for: "Measure P1 with tool short again after 3 h".
std::string what_is_done(const MeasurementProposal& proposal) {
  if (proposal.action.empty()) return "No candidate measurement";
  const std::string words = sentence(proposal.finding);
  return words.substr(0, words.find(fmt::format(" ({} readings)", proposal.readings)));
}

/// Separations in standard deviations; gains are null over nothing.
Json proposal_json(const Diagnosis& diagnosis, const MeasurementProposal& proposal) {
  const auto names = [&](const std::vector<EffectName>& effects) {
    Json json = Json::array();
    for (const EffectName& each : effects) {
      json.push_back({{"label", label_of(diagnosis, each)}, {"name", full_name(each)}});
    }
    return json;
  };
  return {{"what", what_is_done(proposal)},
          {"helps", !proposal.action.empty()},
          {"readings", proposal.readings},
          {"separates", names(proposal.separates)},
          {"makes_visible", names(proposal.makes_visible)},
          {"now", rounded(std::sqrt(proposal.separation), 3)},
          {"reached", rounded(std::sqrt(proposal.reached), 3)},
          {"plain", rounded(std::sqrt(proposal.plain), 3)},
          {"gain", rounded(proposal.gain, 3)},
          {"plain_gain", rounded(proposal.plain_gain, 3)}};
}

}  // namespace

Json confounding_page(const DiagnosisInput& input) {
  const Diagnosis& diagnosis = input.diagnosis;
  const Confounding& confounding = diagnosis.confounding;
  Json effects = Json::array();
  for (std::size_t i = 0; i < confounding.names.size(); ++i) {
    effects.push_back(effect_json(diagnosis, confounding.names[i], confounding.labels[i]));
  }
  Json proposals = Json::array();
  for (const MeasurementProposal& each : diagnosis.proposals) {
    proposals.push_back(proposal_json(diagnosis, each));
  }
  return {{"effects", std::move(effects)},
          {"cosine", rounded_triangle(confounding.cosine, kCosineDigits, false)},
          {"same", kThresholds.same_squared_sine},
          {"proposals", std::move(proposals)}};
}

}  // namespace volcal::report
