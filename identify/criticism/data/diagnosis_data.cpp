#include "volcal/identify/criticism/data/diagnosis_data.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal {

std::string to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::Named:
      return "NAMED";
    case Verdict::NamedMoreRemains:
      return "NAMED_MORE_REMAINS";
    case Verdict::OneOf:
      return "ONE_OF";
    case Verdict::Unknown:
      return "UNKNOWN";
    case Verdict::NothingAbove:
      return "NOTHING_ABOVE";
    case Verdict::NotVisible:
      return "NOT_VISIBLE";
  }
  return "";
}

Verdict verdict_from(const std::string& text) {
  for (const Verdict verdict : {Verdict::Named, Verdict::NamedMoreRemains, Verdict::OneOf, Verdict::Unknown,
                                Verdict::NothingAbove, Verdict::NotVisible}) {
    if (to_string(verdict) == text) return verdict;
  }
  throw std::invalid_argument("\"" + text + "\" is not a verdict");
}

std::string UnknownFinding::dependence() const {
  std::string text = fmt::format("{}", fmt::join(names_of(variables), " and "));
  if (!with_one_of.empty()) text += fmt::format(" and one of {}", fmt::join(names_of(with_one_of), ", "));
  return text;
}

std::string UnknownFinding::in_words() const { return "something that depends on " + dependence(); }

std::string UnknownFinding::action() const {
  std::string text(name_of(direction));
  if (rotation) return text + ", as " + rotation->name();
  return period > 0.0 ? text + fmt::format(", every {:.4g} mm", period * kPerMilli) : text;
}

std::size_t AskedLaws::sufficient() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      laws, [this](const FormulaFinding& law) { return law.log_evidence >= surface_evidence; }));
}

std::vector<EffectFinding> drawn_effects(const Diagnosis& diagnosis) {
  std::vector<EffectFinding> drawn;
  for (const SurfaceFinding& surface : diagnosis.surfaces) {
    EffectFinding& effect = drawn.emplace_back();
    effect.name = surface.name;
    effect.label = surface.accepted_label();
    effect.spec = surface.accepted_spec();
  }
  return drawn;
}

std::optional<double> removed_rms(const Diagnosis& diagnosis, const SurfaceFinding& surface) {
  const auto step = std::ranges::find(diagnosis.ladder, surface.label, &LadderStep::added);
  if (step == diagnosis.ladder.end() || step == diagnosis.ladder.begin()) return {};
  const double before = std::prev(step)->rms_fit, after = step->rms_fit;
  if (!(before > after)) return {};
  return std::sqrt(before * before - after * after);
}

std::span<const UnknownFinding> remaining_unknown(const Diagnosis& diagnosis) {
  const std::size_t drawn = std::min(diagnosis.surfaces.size(), diagnosis.unknown.size());
  return std::span(diagnosis.unknown).subspan(drawn);
}

void add_conditions(const MemberFinding& member, Finding& finding) {
  if (member.conditions.empty()) return;
  std::vector<std::string> names;
  std::vector<FindingNumber> values;
  for (const auto& [variable, value] : member.conditions) {
    names.push_back(variable.written());
    values.push_back({value, std::string(variable.unit().suffix)});
  }
  finding.data["conditions"] = std::move(names);
  finding.data["condition_values"] = std::move(values);
}

std::vector<const std::vector<EffectFinding>*> sets_of_alternatives(const Diagnosis& diagnosis) {
  std::vector<const std::vector<EffectFinding>*> sets;
  if (!diagnosis.one_of.empty()) sets.push_back(&diagnosis.one_of);
  for (const auto& set : diagnosis.further_one_of) sets.push_back(&set);
  return sets;
}

std::string alternative_model_file(std::size_t set, std::size_t member) {
  return fmt::format("alternative-{}-{}.toml", set + 1, member + 1);
}

std::vector<Finding> findings_of(const std::vector<MeasurementProposal>& proposals) {
  std::vector<Finding> findings;
  for (const MeasurementProposal& each : proposals) findings.push_back(each.finding);
  return findings;
}

std::optional<Finding> finding_of(const Screening& screening) {
  if (!screening.contradicts) return std::nullopt;
  Finding finding{FindingCode::ModelContradicted,
                  {{"leading", screening.leading},
                   {"rms", FindingNumber{screening.rms, "um", kMicro}},
                   {"log10_p", FindingNumber{screening.log10_p}},
                   {"tests", static_cast<std::int64_t>(screening.tests)}}};
  if (screening.of_a_sample)
    finding.data.emplace("sampled", static_cast<std::int64_t>(screening.observations));
  return finding;
}

}  // namespace volcal
