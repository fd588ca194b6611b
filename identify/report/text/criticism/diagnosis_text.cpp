#include "volcal/identify/report/text/criticism/diagnosis_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/values/detectable_groups.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/text/uncertain_number.h"
#include "volcal/identify/words/noise_words.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"

namespace volcal {
namespace {

constexpr std::size_t kRanked = 12;
constexpr std::size_t kLeadingNotes = 2;
constexpr std::size_t kLeadingUnknown = 3;
constexpr std::size_t kLeadingLaws = 3;
constexpr double kNear = 0.9;               // cosine
constexpr std::size_t kMostAmplitudes = 3;  // of an effect; functions that the model leaves out have more

std::string edge(double si, double si_per_unit, int digits = 3) {
  return short_number(si / si_per_unit, digits);
}

std::string interval_in_um(double low, double high) {
  if (std::isnan(low) || std::isnan(high)) return "-";
  return edge(low, kMicro) + " .. " + edge(high, kMicro);
}

std::string ladder_table(const Diagnosis& diagnosis) {
  TextTable table({{"model", Align::Left},
                   {"added", Align::Left},
                   {"rms fitted [um]"},
                   {"rms held out [um]"},
                   {"noise floor [um]"},
                   {"systematic [um]"},
                   {"95 % interval [um]"},
                   {"log-likelihood"}},
                  "Models compared on held-out lines");
  for (const LadderStep& step : diagnosis.ladder) {
    table.add_row({step.model, step.added.empty() ? "as given" : step.added, edge(step.rms_fit, kMicro),
                   edge(step.rms_heldout, kMicro), edge(step.noise_floor, kMicro),
                   edge(step.systematic, kMicro), interval_in_um(step.systematic_low, step.systematic_high),
                   fixed_number(step.heldout_loglik_gain, 1)});
  }
  return table.text();
}

std::string mib_text(const AmplitudeFigure& figure) {
  if (std::isnan(figure.mib)) return "-";
  return std::isinf(figure.mib) ? "never" : edge(figure.mib, figure.si_per_unit, 2);
}

/// Rivals in the confounding matrix, those of the leading effects first.
std::string confounding_table(const Confounding& confounding) {
  struct Pair {
    double cosine;
    Eigen::Index first;
    Eigen::Index second;
  };
  std::vector<Pair> pairs;
  for (Eigen::Index i = 0; i < confounding.cosine.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (confounding.cosine(i, j) > kNear) pairs.push_back({confounding.cosine(i, j), j, i});
    }
  }
  if (pairs.empty()) return {};
  std::ranges::stable_sort(pairs, {}, [](const Pair& pair) { return std::pair(pair.first, -pair.cosine); });
  TextTable table({{"cosine"}, {"effect", Align::Left}, {"and", Align::Left}},
                  "Nearly collinear (after projection off the model)");
  for (std::size_t i = 0; i < std::min(kRanked, pairs.size()); ++i) {
    table.add_row({fixed_number(pairs[i].cosine, 3),
                   confounding.labels[static_cast<std::size_t>(pairs[i].first)],
                   confounding.labels[static_cast<std::size_t>(pairs[i].second)]});
  }
  return "\n" + table.text();
}

std::string rank_of(const EffectFinding& finding, const std::vector<EffectFinding>& ranked) {
  const auto found = std::ranges::find(ranked, finding.name, &EffectFinding::name);
  return found == ranked.end() ? "-" : std::to_string(found - ranked.begin() + 1);
}

std::string evidence_table(const std::vector<EffectFinding>& findings,
                           const std::vector<EffectFinding>& ranked, const std::string& title,
                           std::size_t most) {
  TextTable table({{"rank"},
                   {"effect", Align::Left},
                   {"kind", Align::Left},
                   {"amplitude"},
                   {"+- U95"},
                   {"unit", Align::Left},
                   {"MDB"},
                   {"MIB"},
                   {"rival", Align::Left},
                   {"visible fraction"},
                   {"log10 p"}},
                  title);
  for (std::size_t i = 0; i < std::min(most, findings.size()); ++i) {
    const EffectFinding& finding = findings[i];
    const std::string rank = rank_of(finding, ranked);
    const std::string visible = fixed_number(finding.visible_fraction, 3);
    const std::string p = fixed_number(finding.log10_p, 1);
    if (finding.amplitudes.empty() || finding.amplitudes.size() > kMostAmplitudes) {
      table.add_row({rank, finding.label, finding.name.kind, "-", "-", "", "-", "-", "", visible, p});
      continue;
    }
    for (std::size_t k = 0; k < finding.amplitudes.size(); ++k) {
      const AmplitudeFigure& each = finding.amplitudes[k];
      table.add_row({k == 0 ? rank : "", each.label, k == 0 ? finding.name.kind : "",
                     edge(each.value, each.si_per_unit), edge(kCoverageFactor * each.u, each.si_per_unit, 2),
                     each.unit, edge(each.mdb, each.si_per_unit, 2), mib_text(each), each.mib_rival,
                     k == 0 ? visible : "", k == 0 ? p : ""});
    }
  }
  return table.text();
}

/// Surfaces and curves with what they are largest by, and their leading laws in their place.
std::string drawn_table(const Diagnosis& diagnosis, const std::vector<EffectFinding>& ranked) {
  TextTable table({{"rank"},
                   {"effect", Align::Left},
                   {"kind", Align::Left},
                   {"up to"},
                   {"unit", Align::Left},
                   {"at", Align::Left},
                   {"log evidence"}},
                  "Drawn for what has no name");
  const std::vector<EffectFinding> drawn = drawn_effects(diagnosis);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const SurfaceFinding& surface = diagnosis.surfaces[i];
    table.add_row({rank_of(drawn[i], ranked), drawn[i].label, drawn[i].spec.kind,
                   value_with_u(surface.largest / surface.si_per_unit,
                                kCoverageFactor * surface.largest_u / surface.si_per_unit),
                   surface.unit, place_in_words(surface.drivers, surface.at),
                   fixed_number(surface.log_evidence, 1)});
  }
  return table.empty() ? "" : "\n" + table.text();
}

std::string noise_text(const Diagnosis& diagnosis) {
  TextTable table({{"instrument", Align::Left},
                   {"term", Align::Left},
                   {"value"},
                   {"95 % interval"},
                   {"unit", Align::Left},
                   {"", Align::Left}},
                  "Noise (restricted maximum likelihood)");
  for (const NoiseRow& row : diagnosis.noise) {
    const std::string& instrument = diagnosis.noise_instruments[row.instrument];
    const EdgeNoise noise = edge_noise(row, instrument);
    table.add_row({instrument, noise.meaning, short_number(noise.value, 3),
                   fmt::format("{} .. {}", short_number(noise.low, 3), short_number(noise.high, 3)),
                   noise.unit, row.remark});
  }
  return table.text();
}

std::string unknown_table(const Diagnosis& diagnosis, std::size_t most) {
  TextTable table({{"depends on", Align::Left}, {"along", Align::Left}, {"rms [um]"}, {"log10 p"}},
                  "What the generic scans still see");
  for (const UnknownFinding& unknown : remaining_unknown(diagnosis)) {
    if (most-- == 0) break;
    table.add_row({unknown.dependence(), unknown.action(), edge(unknown.rms, kMicro),
                   fixed_number(unknown.log10_p, 1)});
  }
  return table.text();
}

/// By kind; diagnosis.json and report.html have every effect.
std::string detected_effects_table(const Diagnosis& diagnosis) {
  TextTable table({{"kind", Align::Left},
                   {"effects"},
                   {"not visible"},
                   {"smallest MDB"},
                   {"largest MDB"},
                   {"unit", Align::Left},
                   {"in the volume [um]"},
                   {"found first", Align::Left}},
                  "Below the detection limit: smallest detectable amplitudes (MDB), found with 80 % power");
  for (const report::DetectableGroup& group : report::detectable_groups(diagnosis.detectable)) {
    const bool any = group.easiest != nullptr;
    table.add_row({group.kind, std::to_string(group.effects), std::to_string(group.not_visible),
                   any ? edge(group.easiest->mdb, group.si_per_unit, 2) : "-",
                   any ? edge(group.hardest->mdb, group.si_per_unit, 2) : "-", group.unit,
                   any ? edge(group.easiest->volumetric, kMicro, 2) : "-", any ? group.easiest->label : "-"});
  }
  return table.text();
}

/// "  removed: S1 lines 12 and 40 (length_mm)", a line for each setup and column.
std::string removed_text(const Diagnosis& diagnosis) {
  std::map<std::pair<std::string, std::string>, std::vector<std::int64_t>> lines;
  for (const RemovedReading& removed : diagnosis.removed_readings)
    lines[{removed.setup, removed.reading}].push_back(removed.line);
  std::string text;
  for (const auto& [of, numbers] : lines) {
    text += fmt::format("  removed: {}, {}, line{} {}\n", of.first, of.second, numbers.size() == 1 ? "" : "s",
                        fmt::join(numbers, ", "));
  }
  return text;
}

/// "  reversal EXX: 1.40 +- 0.05 um, log10 p -45.2": its amplitudes, the largest number of which is
/// kMostAmplitudes.
std::string effect_line(const EffectFinding& effect) {
  std::vector<std::string> amplitudes;
  for (const AmplitudeFigure& each : effect.amplitudes) {
    const double value = each.value / each.si_per_unit,
                 expanded = kCoverageFactor * each.u / each.si_per_unit;
    amplitudes.push_back(fmt::format("{} {} {}", each.label, value_with_u(value, expanded), each.unit));
  }
  if (amplitudes.empty() || amplitudes.size() > kMostAmplitudes) amplitudes = {effect.label};
  return fmt::format("  {}; log10 p {}\n", fmt::join(amplitudes, ", "), fixed_number(effect.log10_p, 1));
}

/// "T_column = 20 degC, T_air = 23.1 degC"; a dash where the difference depends on none.
std::string conditions_words(const MemberFinding& member) {
  if (member.conditions.empty()) return "-";
  std::vector<Variable> variables;
  std::vector<double> values;
  for (const auto& [variable, value] : member.conditions) {
    variables.push_back(variable);
    values.push_back(value);
  }
  return place_in_words(variables, values);
}

std::string choice_table(const std::vector<EffectFinding>& effects, const SetFinding& set,
                         std::size_t place) {
  std::vector<TextColumn> columns = {{"with", Align::Left},  {"rms held out [um]"},     {"systematic [um]"},
                                     {"95 % interval [um]"}, {"differs by up to [um]"}, {"U [um]"}};
  const bool has_conditions = std::ranges::any_of(
      set.members, [](const MemberFinding& member) { return !member.conditions.empty(); });
  if (has_conditions) columns.push_back({"at", Align::Left});
  columns.push_back({"model", Align::Left});
  TextTable table(std::move(columns), "The error with each of them, and what it changes in the volume");
  for (std::size_t i = 0; i < std::min(effects.size(), set.members.size()); ++i) {
    const MemberFinding& member = set.members[i];
    const bool chosen = i == set.chosen, compared = !std::isnan(member.difference);
    std::vector<std::string> cells = {
        effects[i].label,
        edge(member.rms_heldout, kMicro),
        edge(member.systematic, kMicro),
        interval_in_um(member.systematic_low, member.systematic_high),
        chosen || !compared ? "-" : edge(member.difference, kMicro, 2),
        chosen || !compared ? "-" : edge(kCoverageFactor * member.difference_u, kMicro, 2)};
    if (has_conditions) cells.push_back(conditions_words(member));
    cells.push_back(chosen ? "extended.toml" : !compared ? "-" : alternative_model_file(place, i));
    table.add_row(std::move(cells));
  }
  return table.text();
}

std::string asked_laws_text(const AskedLaws& asked, std::size_t most) {
  TextTable table(
      {{"law", Align::Left},
       {"amplitude"},
       {"+- U95"},
       {"unit", Align::Left},
       {"shape", Align::Left},
       {"gain"},
       {"log10 p"},
       {"log evidence"}},
      fmt::format("Laws of the {}: {} were tried, {} explain as much as it does (log evidence {})",
                  asked.label, asked.tried, asked.sufficient(), fixed_number(asked.surface_evidence, 1)));
  for (std::size_t i = 0; i < std::min(most, asked.laws.size()); ++i) {
    const FormulaFinding& law = asked.laws[i];
    table.add_row({law.label, edge(law.amplitude, law.si_per_unit),
                   edge(kCoverageFactor * law.u, law.si_per_unit, 2), law.unit, law.shape_text,
                   fixed_number(law.gain, 1), fixed_number(law.log10_p, 1),
                   fixed_number(law.log_evidence, 1)});
  }
  return table.text();
}

std::string alternatives_text(const Diagnosis& diagnosis, const std::vector<EffectFinding>& ranked) {
  std::string text;
  const auto sets = sets_of_alternatives(diagnosis);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    text += "\n" + evidence_table(*sets[i], ranked, "The readings cannot separate", sets[i]->size());
    if (i < diagnosis.sets.size()) text += "\n" + choice_table(*sets[i], diagnosis.sets[i], i);
  }
  return text;
}

}  // namespace

std::vector<EffectFinding> ranked_effects(const Diagnosis& diagnosis) {
  std::vector<EffectFinding> all;
  const std::vector<EffectFinding> drawn = drawn_effects(diagnosis);
  std::vector<const std::vector<EffectFinding>*> lists = sets_of_alternatives(diagnosis);
  lists.insert(lists.begin(), &diagnosis.effects);
  lists.push_back(&drawn);
  lists.push_back(&diagnosis.ranking);
  for (const auto* list : lists) {
    for (const EffectFinding& effect : *list) {
      const bool known = std::ranges::find(all, effect.name, &EffectFinding::name) != all.end();
      if (!known && !effect.resolution) all.push_back(effect);
    }
  }
  return all;
}

std::string diagnosis_summary_text(const Diagnosis& diagnosis) {
  std::string text = to_string(diagnosis.verdict) + "\n";
  for (const std::string& words : sentences(diagnosis.findings)) text += words + "\n";
  if (diagnosis.ladder.size() > 1) text += ladder_table(diagnosis);
  for (const EffectFinding& effect : diagnosis.effects) text += effect_line(effect);
  for (const AskedLaws& asked : diagnosis.asked_laws) text += asked_laws_text(asked, kLeadingLaws);
  if (!remaining_unknown(diagnosis).empty()) text += unknown_table(diagnosis, kLeadingUnknown);
  if (!diagnosis.proposals.empty()) text += "next: " + sentence(diagnosis.proposals.front().finding) + "\n";
  const std::size_t shown = std::min(kLeadingNotes, diagnosis.notes.size());
  for (std::size_t i = 0; i < shown; ++i) text += "! " + sentence(diagnosis.notes[i]) + "\n";
  const std::size_t more = diagnosis.notes.size() - shown +
                           (diagnosis.not_looked_for.empty() ? 0 : diagnosis.not_looked_for.size());
  if (more > 0) text += fmt::format("! and {} more note{} (--verbose)\n", more, more == 1 ? "" : "s");
  return text;
}

std::string diagnosis_text(const Diagnosis& diagnosis) {
  const std::vector<EffectFinding> ranked = ranked_effects(diagnosis);
  std::string text = to_string(diagnosis.verdict) + "\n";
  for (const std::string& words : sentences(diagnosis.findings)) text += words + "\n";
  text += "\n" + ladder_table(diagnosis);
  if (!diagnosis.effects.empty())
    text += "\n" + evidence_table(diagnosis.effects, ranked, "Added", diagnosis.effects.size());
  text += alternatives_text(diagnosis, ranked);
  text += drawn_table(diagnosis, ranked);
  if (!diagnosis.tried.empty())
    text += "\n" + evidence_table(diagnosis.tried, ranked, "Your own", diagnosis.tried.size());
  for (const AskedLaws& asked : diagnosis.asked_laws)
    text += "\n" + asked_laws_text(asked, asked.laws.size());
  if (!remaining_unknown(diagnosis).empty())
    text += "\n" + unknown_table(diagnosis, diagnosis.unknown.size());
  text += "\n" + evidence_table(diagnosis.ranking, ranked, "Ranked evidence at the model reached", kRanked);
  text +=
      "  MDB: smallest amplitude that is found with 80 % power; MIB: smallest that is also separated from "
      "every other effect, the worst of which is the rival\n";
  text += confounding_table(diagnosis.confounding);
  if (!diagnosis.proposals.empty()) {
    text += "\nWhich measurement next\n";
    for (const std::string& words : sentences(findings_of(diagnosis.proposals))) text += "  " + words + "\n";
  }
  if (!diagnosis.detectable.empty()) {
    text += "\n" + detected_effects_table(diagnosis) +
            "  in the volume: root mean square displacement of the functional point by the one found first\n";
  }
  text += "\n" + noise_text(diagnosis);
  text += fmt::format(
      "\n{} families and {} generic tests; {} families of which less than 2 % is visible; {} readings "
      "removed\n",
      diagnosis.families, diagnosis.generic_tests, diagnosis.not_visible.size(),
      diagnosis.removed_readings.size());
  text += removed_text(diagnosis);
  for (const std::string& words : sentences(diagnosis.not_looked_for)) text += words + "\n";
  return text + findings_text(diagnosis.notes);
}

std::string removed_in_fit_text(const Diagnosis& diagnosis, const std::string& campaign,
                                const std::string& model) {
  const std::size_t removed = diagnosis.removed_readings.size();
  if (removed == 0) return "";
  return fmt::format(
      "! the diagnosis left out {0} reading{1} as outlier{1}; `volcal fit` takes them back and finds other "
      "values unless it removes them, too\nnext: volcal fit {2} --model {3} --outliers remove -o RESULT\n",
      removed, removed == 1 ? "" : "s", campaign, model);
}

}  // namespace volcal
