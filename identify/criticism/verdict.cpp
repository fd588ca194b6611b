#include "volcal/identify/criticism/verdict.h"

#include <algorithm>
#include <string>
#include <utility>

#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

std::vector<std::string> labels(const std::vector<EffectFinding>& effects) {
  std::vector<std::string> all;
  for (const EffectFinding& each : effects) all.push_back(each.label);
  return all;
}

Finding named(const EffectFinding& effect) {
  std::vector<std::string> names;
  std::vector<FindingNumber> values, expanded;
  for (const AmplitudeFigure& amplitude : effect.amplitudes) {
    names.push_back(amplitude.label);
    values.push_back({amplitude.value, amplitude.unit, amplitude.si_per_unit});
    expanded.push_back({kCoverageFactor * amplitude.u, amplitude.unit, amplitude.si_per_unit});
  }
  Finding finding{FindingCode::DiagnosisNamed,
                  {{"effect", effect.label},
                   {"kind", effect.name.kind},
                   {"target", effect.name.target.name()},
                   {"driver", effect.name.driver.name()},
                   {"shape", effect.shape_text}}};
  if (names.empty()) return finding;
  finding.data["amplitudes"] = names;
  finding.data["values"] = values;
  finding.data["U"] = expanded;
  return finding;
}

Finding unnamed(FindingCode code, const UnknownFinding& unknown) {
  Finding finding{code,
                  {{"direction", std::string(name_of(unknown.direction))},
                   {"rms", FindingNumber{unknown.rms, "um", kMicro}}}};
  if (!unknown.variables.empty()) finding.data["depends_on"] = names_of(unknown.variables);
  if (!unknown.with_one_of.empty()) finding.data["and_one_of"] = names_of(unknown.with_one_of);
  if (unknown.rotation) finding.data["rotation"] = unknown.rotation->name();
  if (unknown.period > 0.0) finding.data["period"] = FindingNumber{unknown.period, "mm", kMetrePerMillimetre};
  return finding;
}

/// The leading one; the size of a surface that was drawn for it is stated with the surface.
Finding leading_unnamed(FindingCode code, const Diagnosis& diagnosis) {
  Finding finding = unnamed(code, diagnosis.unknown.front());
  if (!diagnosis.surfaces.empty()) finding.data["drawn"] = true;
  return finding;
}

Finding alternatives(FindingCode code, const std::vector<EffectFinding>& set) {
  return {code, {{"effects", labels(set)}}};
}

/// Whether it matters which of a set it is, and with which the extended model goes on.
void add_choices(Diagnosis& diagnosis) {
  const auto sets = sets_of_alternatives(diagnosis);
  for (std::size_t i = 0; i < std::min(sets.size(), diagnosis.sets.size()); ++i) {
    const SetFinding& set = diagnosis.sets[i];
    if (!set.chosen) continue;
    Finding finding{FindingCode::DiagnosisChoice, {{"chosen", (*sets[i])[*set.chosen].label}}};
    if (set.farthest) {
      const MemberFinding& other = set.members[*set.farthest];
      finding.data["other"] = (*sets[i])[*set.farthest].label;
      finding.data["difference"] = FindingNumber{other.difference, "um", kMicro};
      finding.data["U"] = FindingNumber{kCoverageFactor * other.difference_u, "um", kMicro};
      finding.data["matters"] = set.matters;
      add_conditions(other, finding);
    }
    diagnosis.findings.push_back(std::move(finding));
  }
}

void add_laws(const std::vector<FormulaFinding>& formulas, Finding& finding) {
  std::vector<std::string> laws, shapes;
  std::vector<FindingNumber> amplitudes, expanded;
  for (const FormulaFinding& formula : formulas) {
    laws.push_back(formula.label);
    shapes.push_back(formula.shape_text);
    amplitudes.push_back({formula.amplitude, formula.unit, formula.si_per_unit});
    expanded.push_back({kCoverageFactor * formula.u, formula.unit, formula.si_per_unit});
  }
  finding.data["laws"] = laws;
  finding.data["law_shapes"] = shapes;
  finding.data["law_amplitudes"] = amplitudes;
  finding.data["law_U"] = expanded;
}

Finding drawn(const Diagnosis& diagnosis, const SurfaceFinding& surface) {
  const auto value = [&surface](double si) { return FindingNumber{si, surface.unit, surface.si_per_unit}; };
  Finding finding{FindingCode::DiagnosisDrawn,
                  {{"effect", surface.label},
                   {"largest", value(surface.largest)},
                   {"U", value(kCoverageFactor * surface.largest_u)},
                   {"drivers", written_names(surface.drivers)},
                   {"at", std::vector<FindingNumber>(surface.at.size())}}};
  auto& at = std::get<std::vector<FindingNumber>>(finding.data["at"]);
  for (std::size_t i = 0; i < at.size(); ++i) at[i].si = surface.at[i];
  if (const std::optional<double> removed = removed_rms(diagnosis, surface))
    finding.data["removes"] = FindingNumber{*removed, "um", kMicro};
  if (!surface.free.empty()) finding.data["left_open"] = surface.free;
  if (!surface.formulas.empty()) add_laws(surface.formulas, finding);
  return finding;
}

void conclude_named(const Remarks& remarks, Diagnosis& diagnosis) {
  const auto sets = sets_of_alternatives(diagnosis);
  const bool more = !diagnosis.unknown.empty();
  const bool not_reduced = heldout_error_not_reduced(diagnosis.ladder);
  const bool open = more || !sets.empty() || remarks.more_is_known || not_reduced;
  auto& findings = diagnosis.findings;
  diagnosis.verdict = open ? Verdict::NamedMoreRemains : Verdict::Named;
  for (const EffectFinding& effect : diagnosis.effects) findings.push_back(named(effect));
  for (const auto* set : sets) findings.push_back(alternatives(FindingCode::DiagnosisMoreOneOf, *set));
  if (remarks.more_is_known) findings.push_back({FindingCode::DiagnosisMoreInCatalogue});
  if (more) findings.push_back(leading_unnamed(FindingCode::DiagnosisMoreUnknown, diagnosis));
  if (not_reduced) findings.push_back({FindingCode::DiagnosisHeldoutNotReduced});
}

void conclude_unknown(Diagnosis& diagnosis) {
  diagnosis.verdict = Verdict::Unknown;
  diagnosis.findings.push_back(leading_unnamed(FindingCode::DiagnosisUnknown, diagnosis));
  for (const auto* set : sets_of_alternatives(diagnosis))
    diagnosis.findings.push_back(alternatives(FindingCode::DiagnosisNearest, *set));
}

void conclude_one_of(const Remarks& remarks, Diagnosis& diagnosis) {
  diagnosis.verdict = Verdict::OneOf;
  for (const auto* set : sets_of_alternatives(diagnosis))
    diagnosis.findings.push_back(alternatives(FindingCode::DiagnosisOneOf, *set));
  if (remarks.more_is_known) diagnosis.findings.push_back({FindingCode::DiagnosisMoreInCatalogue});
}

std::int64_t count(std::size_t number) { return static_cast<std::int64_t>(number); }

void conclude_nothing(Diagnosis& diagnosis) {
  if (2 * diagnosis.not_visible.size() > diagnosis.detectable.size()) {
    diagnosis.verdict = Verdict::NotVisible;
    diagnosis.findings.push_back(
        {FindingCode::DiagnosisNotVisible,
         {{"not_visible", count(diagnosis.not_visible.size())}, {"families", count(diagnosis.families)}}});
  } else {
    diagnosis.verdict = Verdict::NothingAbove;
    diagnosis.findings.push_back({FindingCode::DiagnosisNothingAbove});
  }
}

void add_remarks(const Remarks& remarks, Diagnosis& diagnosis) {
  auto& findings = diagnosis.findings;
  findings.insert(findings.end(), remarks.rejected.begin(), remarks.rejected.end());
  add_choices(diagnosis);
  for (const SurfaceFinding& surface : diagnosis.surfaces) findings.push_back(drawn(diagnosis, surface));
  if (const std::size_t back = remarks.removed_by_fit - diagnosis.removed_readings.size(); back > 0) {
    findings.push_back({FindingCode::DiagnosisReadingsReinstated,
                        {{"readings", count(back)}, {"of", count(remarks.removed_by_fit)}}});
  }
  for (const EffectFinding& change : diagnosis.model_changes)
    findings.push_back({FindingCode::DiagnosisResolution, {{"function", change.name.target.name()}}});
}

}  // namespace

namespace {

/// Nearest to an effect in the readings, by the matrix; nothing where nothing is near.
struct NearestEffect {
  std::string label;
  double cosine = 0.0;
};
NearestEffect nearest_to(const EffectName& name, const Confounding& confounding) {
  NearestEffect nearest;
  const auto row = std::ranges::find(confounding.names, name) - confounding.names.begin();
  if (row == std::ssize(confounding.names)) return nearest;
  for (Eigen::Index k = 0; k < confounding.cosine.cols(); ++k) {
    const double cosine = k == row ? 0.0 : confounding.cosine(row, k);
    if (cosine > nearest.cosine) nearest = {confounding.labels[static_cast<std::size_t>(k)], cosine};
  }
  return nearest;
}

bool is_added(const EffectName& name, const Diagnosis& diagnosis) {
  return std::ranges::find(diagnosis.effects, name, &EffectFinding::name) != diagnosis.effects.end();
}

bool is_alternative(const EffectName& name, const Diagnosis& diagnosis) {
  return std::ranges::any_of(sets_of_alternatives(diagnosis), [&](const auto* set) {
    return std::ranges::find(*set, name, &EffectFinding::name) != set->end();
  });
}

}  // namespace

void conclude_tried(Diagnosis& diagnosis) {
  for (std::size_t i = 0; i < diagnosis.tried.size(); ++i) {
    const EffectFinding& tried = diagnosis.tried[i];
    Finding finding{FindingCode::DiagnosisTried,
                    {{"effect", tried.label},
                     {"added", is_added(tried.name, diagnosis)},
                     {"alternative", is_alternative(tried.name, diagnosis)},
                     {"visible", tried.dof > 0},
                     {"gain", FindingNumber{tried.gain}},
                     {"log10_p", FindingNumber{tried.log10_p}},
                     {"tests", count(diagnosis.families)}}};
    if (i < diagnosis.tried_errors.size() && !std::isnan(diagnosis.tried_errors[i].systematic)) {
      finding.data["systematic"] = FindingNumber{diagnosis.tried_errors[i].systematic};
      finding.data["systematic_given"] = FindingNumber{diagnosis.ladder.front().systematic};
      finding.data["systematic_reached"] = FindingNumber{diagnosis.ladder.back().systematic};
    }
    if (const NearestEffect nearest = nearest_to(tried.name, diagnosis.confounding); nearest.cosine > 0.0) {
      finding.data["nearest"] = nearest.label;
      finding.data["cosine"] = FindingNumber{nearest.cosine};
    }
    diagnosis.findings.push_back(std::move(finding));
  }
}

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

Finding unnamed(const UnknownFinding& unknown) { return unnamed(FindingCode::DiagnosisUnknown, unknown); }

}  // namespace volcal
