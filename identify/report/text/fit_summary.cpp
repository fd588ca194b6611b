#include "volcal/identify/report/text/fit_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/values/drawn_surfaces.h"
#include "volcal/identify/report/values/error_range.h"
#include "volcal/identify/report/values/residual_sample.h"
#include "volcal/identify/result/identified_expansions.h"
#include "volcal/identify/text/uncertain_number.h"
#include "volcal/identify/words/noise_words.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr std::size_t kListedOutliers = 10;
constexpr std::size_t kLeadingMessages = 3;
constexpr std::size_t kLeadingEffects = 4;

/// A result that was read from files has no residuals and knows their number.
std::size_t observations_of(const FitResult& result) {
  if (!result.residuals.empty()) return result.residuals.size();
  std::size_t count = 0;
  for (const SetupSummary& setup : result.setups) count += setup.observations;
  return count;
}

std::string headline(const FitResult& result) {
  return fmt::format(
      "{} ({})\n{} readings in {} setups; status {}; sigma0 {:.3f} (chi2/dof with the stated noise {:.3f})\n",
      result.machine.name, result.machine.structure.code,
      count_number(static_cast<long long>(observations_of(result))), result.setups.size(),
      to_string(result.status), result.sigma0, result.sigma0 * result.sigma0);
}

std::string reference_line(const FitResult& result) {
  const std::string temperature = result.temperature_is_campaign_mean
                                      ? (std::isfinite(result.reference_temperature_degC)
                                             ? fmt::format("at the campaign's mean temperature, {:.2f} degC",
                                                           result.reference_temperature_degC)
                                             : std::string("at the campaign's temperature (not recorded)"))
                                      : "at 20 degC";
  return "Errors are actual - nominal, zero at home, straightness about its least-squares line, " +
         temperature + ".\n";
}

void add_function_row(const FitResult& result, const std::vector<ErrorTableRow>& table,
                      const Observability& error, TextTable& text) {
  const report::ErrorRange range = report::error_range(result, table, error);
  const auto value = [](double si) { return fixed_number(si * kPerMicro, 2); };
  text.add_row({error.symbol.name(), error.symbol.is_angle() ? "urad" : "um",
                error.visible ? value(range.low) : "-", error.visible ? value(range.high) : "-",
                value(result.coverage_factor * error.u_rms), value(range.expanded),
                fixed_number(error.visible_fraction, 2), fixed_number(error.effective_parameters, 1),
                error.visible ? "" : "NOT VISIBLE"});
}

std::string errors_table(const FitResult& result) {
  TextTable text(
      {{"error", Align::Left},
       {"unit", Align::Left},
       {"min"},
       {"max"},
       {"U95 mean"},
       {"U95 max"},
       {"visible fraction"},
       {"param."},
       {"", Align::Left}},
      "Error motions and squareness (U95 = 1.96 u; visible fraction = share of its signal that nothing else "
      "imitates)");
  const auto table = error_table(result);
  for (const Observability& error : result.rank.errors) {
    if (result.layout.find_block(error.symbol) == nullptr) add_function_row(result, table, error, text);
  }
  for (const Observability& error : result.rank.errors) {
    const ParameterBlock* block = result.layout.find_block(error.symbol);
    if (block == nullptr) continue;
    const double si = block->si_per_unit[0];
    const std::string value = error.visible ? fixed_number(result.parameters[block->offset] / si, 2) : "-";
    const std::string expanded = fixed_number(result.coverage_factor * error.u_rms / si, 2);
    text.add_row({error.symbol.name(), block->units[0], value, value, expanded, expanded,
                  fixed_number(error.visible_fraction, 2), error.visible ? "1.0" : "0.0",
                  error.visible ? "" : "NOT VISIBLE"});
  }
  std::string surfaces;
  for (const SurfaceValues& surface : surface_values(result))
    surfaces += "  " + report::surface_line(surface, result.coverage_factor) + "\n";
  return text.text() + surfaces;
}

std::string expansions_table(const FitResult& result) {
  const std::vector<IdentifiedExpansion> expansions = identified_expansions(result);
  if (expansions.empty()) return {};
  TextTable text({{"axis", Align::Left},
                  {"temperature", Align::Left},
                  {"identified"},
                  {"U95"},
                  {"machine file"},
                  {"U95"}},
                 "Expansion of scales [um/m/K]");
  for (const IdentifiedExpansion& each : expansions) {
    const auto value = [](double si) { return fixed_number(si * kPerMicro, 3); };
    text.add_row({std::string(1, letter_of(each.axis)), temperature_of(each.channel).name(),
                  value(each.per_kelvin), value(result.coverage_factor * each.u), value(each.stated),
                  each.stated_u > 0.0 ? value(result.coverage_factor * each.stated_u) : "exact"});
  }
  return text.text();
}

/// "  expansion X by T_column: 10.05 +- 0.02 um/m/K (machine file 14.00 +- 5.88)"
std::string expansions_lines(const FitResult& result) {
  std::string text;
  for (const IdentifiedExpansion& each : identified_expansions(result)) {
    const auto words = [&](double value, double u) {
      return value_with_u(value * kPerMicro, result.coverage_factor * u * kPerMicro);
    };
    text += fmt::format("  expansion {} by {}: {} um/m/K (machine file {})\n", letter_of(each.axis),
                        temperature_of(each.channel).name(), words(each.per_kelvin, each.u),
                        each.stated_u > 0.0 ? words(each.stated, each.stated_u)
                                            : fixed_number(each.stated * kPerMicro, 3) + ", exact");
  }
  return text;
}

std::string setups_table(const FitResult& result) {
  TextTable text({{"setup", Align::Left},
                  {"instrument", Align::Left},
                  {"tool", Align::Left},
                  {"readings"},
                  {"chi2/dof"},
                  {"RMS"},
                  {"max"},
                  {"unit", Align::Left}},
                 "Setups (chi2 with the stated noise)");
  for (const SetupSummary& setup : result.setups) {
    text.add_row({setup.name, setup.instrument, setup.tool,
                  count_number(static_cast<long long>(setup.observations)),
                  fixed_number(setup.redundancy > 0.0 ? setup.chi2 / setup.redundancy : std::nan(""), 2),
                  fixed_number(setup.rms_residual * 1e6, 2), fixed_number(setup.max_residual * 1e6, 2),
                  setup.reading_unit});
  }
  return text.text();
}

std::string variance_table(const FitResult& result) {
  TextTable text({{"instrument", Align::Left}, {"sigma / stated"}, {"u"}, {"readings"}},
                 "Variance components");
  for (const VarianceComponent& component : result.variance_components) {
    text.add_row({component.instrument, fixed_number(component.scale, 3), fixed_number(component.scale_u, 3),
                  count_number(static_cast<long long>(component.observations))});
  }
  return text.text();
}

std::string noise_table_text(const NoiseSummary& noise) {
  if (!noise.estimated) return "Noise: readings taken as independent; nothing else was looked for.\n";
  if (!noise.more_than_white)
    return "Noise: independent readings suffice; no correlated drift, line offset or part in proportion to "
           "length is supported.\n";
  TextTable text(
      {{"instrument", Align::Left},
       {"term", Align::Left},
       {"value"},
       {"95 % interval"},
       {"unit", Align::Left},
       {"evidence"}},
      fmt::format("Noise by restricted maximum likelihood (evidence: 2 x the log likelihood that a "
                  "term gains); whitened chi2/dof {:.3f}",
                  noise.chi2 / noise.dof));
  for (const NoiseRow& row : noise.rows) {
    if (row.value == 0.0) continue;
    const std::string& instrument = noise.groups[row.instrument];
    const EdgeNoise edge = edge_noise(row, instrument);
    const bool of_term = std::isfinite(row.likelihood_ratio) && row.term != "tau";
    text.add_row({instrument, edge.meaning, short_number(edge.value, 3),
                  short_number(edge.low, 2) + " .. " + short_number(edge.high, 2), edge.unit,
                  of_term ? fixed_number(row.likelihood_ratio, 1) : ""});
  }
  return text.text();
}

std::string outliers_table(const FitResult& result, const Campaign& campaign) {
  std::vector<const ResidualRecord*> flagged;
  for (const ResidualRecord& record : result.residuals) {
    if (report::is_suspect(record)) flagged.push_back(&record);
  }
  if (flagged.empty()) return {};
  std::ranges::sort(flagged, std::greater<>(), [](const ResidualRecord* r) { return std::abs(r->w); });
  TextTable text({{"setup", Align::Left},
                  {"line of file"},
                  {"residual"},
                  {"unit", Align::Left},
                  {"w"},
                  {"redundancy"},
                  {"", Align::Left}},
                 fmt::format("Readings flagged by the w-test (|w| > {:.2f})", result.outlier_critical_value));
  for (std::size_t i = 0; i < std::min(kListedOutliers, flagged.size()); ++i) {
    const ResidualRecord& record = *flagged[i];
    text.add_row({result.setups[record.setup].name, std::to_string(record.source_line),
                  fixed_number(record.residual() * 1e6, 2),
                  residual_unit(campaign.setups[record.setup], static_cast<std::size_t>(record.channel)),
                  fixed_number(record.w, 1), fixed_number(record.redundancy, 2),
                  record.left_out  ? "left out"
                  : record.removed ? "removed"
                                   : "kept"});
  }
  std::string more;
  if (flagged.size() > kListedOutliers)
    more = fmt::format("  and {} more, all in residuals.csv\n", flagged.size() - kListedOutliers);
  return text.text() + more;
}

/// What the summary says of errors of one unit.
struct ErrorExtremes {
  std::string largest;         ///< symbol
  double value = 0.0;          ///< its largest magnitude, edge unit
  std::string most_uncertain;  ///< symbol
  double expanded = 0.0;       ///< its largest U95 where it was measured, edge unit
};

bool is_angle(const FitResult& result, const MachineError& error) {
  const ParameterBlock* block = result.layout.find_block(error);
  return block != nullptr ? block->units[0] == "urad" : error.is_angle();
}

void extend_extremes(const Observability& error, const report::ErrorRange& range, ErrorExtremes& extremes) {
  if (range.magnitude() * kPerMicro >= extremes.value) {
    extremes.value = range.magnitude() * kPerMicro;
    extremes.largest = error.symbol.name();
  }
  if (range.expanded * kPerMicro >= extremes.expanded) {
    extremes.expanded = range.expanded * kPerMicro;
    extremes.most_uncertain = error.symbol.name();
  }
}

/// "21 of 21 errors identified", and the largest and most uncertain of positions and of angles.
std::string errors_lines(const FitResult& result) {
  const auto table = error_table(result);
  std::map<bool, ErrorExtremes> extremes;  // of angles
  std::vector<std::string> invisible;
  std::size_t errors = 0;
  for (const Observability& error : result.rank.errors) {
    if (report::is_amplitude(result, error)) continue;
    ++errors;
    if (error.visible) {
      extend_extremes(error, report::error_range(result, table, error),
                      extremes[is_angle(result, error.symbol)]);
    } else {
      invisible.push_back(error.symbol.name());
    }
  }
  std::string text = fmt::format("{} of {} errors identified{}\n", errors - invisible.size(), errors,
                                 invisible.empty() ? "" : "; not visible: " + listed_names(invisible));
  for (const auto& [angle, of_unit] : extremes) {
    const char* unit = angle ? "urad" : "um";
    text += fmt::format("  {}: largest {} {:.2f} {}; U95 at most {:.2f} {} ({})\n",
                        angle ? "rotations and squareness" : "positions and straightness", of_unit.largest,
                        of_unit.value, unit, of_unit.expanded, unit, of_unit.most_uncertain);
  }
  return text;
}

/// The first effects of the model with their amplitudes.
std::string effects_lines(const FitResult& result) {
  std::string text;
  std::size_t shown = 0, more = 0;
  for (const Observability& error : result.rank.errors) {
    if (!report::is_amplitude(result, error)) continue;
    if (shown++ >= kLeadingEffects) {
      ++more;
      continue;
    }
    const ParameterBlock& block = *result.layout.find_block(error.symbol);
    text += fmt::format("  {}: {} {}{}\n", error.symbol.name(),
                        value_with_u(result.parameters[block.offset] / block.si_per_unit[0],
                                     result.coverage_factor * error.u_rms / block.si_per_unit[0]),
                        block.units[0], error.visible ? "" : ", not visible");
  }
  if (more > 0)
    text += fmt::format("  and {} more amplitude{} of effects (--verbose)\n", more, more == 1 ? "" : "s");
  for (const SurfaceValues& surface : surface_values(result))
    text += "  " + report::surface_line(surface, result.coverage_factor) + "\n";
  return text;
}

std::string setups_line(const FitResult& result) {
  const auto ratio = [](const SetupSummary& setup) {
    return setup.redundancy > 0.0 ? setup.chi2 / setup.redundancy : 0.0;
  };
  const auto worst = std::ranges::max_element(result.setups, {}, ratio);
  if (worst == result.setups.end()) return {};
  return fmt::format("Setups: {} scatters most, chi2/dof {:.2f}, RMS {:.2f} {}\n", worst->name, ratio(*worst),
                     worst->rms_residual * 1e6, worst->reading_unit);
}

std::string noise_line(const NoiseSummary& noise) {
  if (!noise.estimated || !noise.more_than_white) return noise_table_text(noise);
  std::vector<std::string> terms;
  for (const NoiseRow& row : noise.rows) {
    if (row.value == 0.0 || row.term == "tau" || row.term == "white") continue;
    const std::string& instrument = noise.groups[row.instrument];
    const EdgeNoise edge = edge_noise(row, instrument);
    terms.push_back(
        fmt::format("{} {} {} {}", instrument, edge.meaning, short_number(edge.value, 2), edge.unit));
  }
  return fmt::format("Noise beyond independent readings: {}\n", fmt::join(terms, "; "));
}

std::string outliers_line(const FitResult& result) {
  const auto flagged = std::ranges::count_if(result.residuals, report::is_suspect);
  if (flagged == 0) return {};
  return fmt::format("{} reading{} flagged by the w-test (|w| > {:.2f})\n", flagged, flagged == 1 ? "" : "s",
                     result.outlier_critical_value);
}

/// The first messages, and how many more there are.
std::string leading_messages(const FitResult& result) {
  const std::size_t shown = std::min(kLeadingMessages, result.findings.size());
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) text += "! " + sentence(result.findings[i]) + "\n";
  if (shown < result.findings.size()) {
    const std::size_t more = result.findings.size() - shown;
    text += fmt::format("! and {} more message{} (--verbose)\n", more, more == 1 ? "" : "s");
  }
  return text;
}

std::string notes(const FitResult& result) {
  std::string text = rank_text(result) + "\n";
  text += findings_text(result.findings);
  for (const std::string& held : sentences(result.rank.held_by_prior)) text += "  " + held + "\n";
  return text;
}

}  // namespace

std::string rank_text(const FitResult& result) {
  const int rest = result.rank.parameters - result.rank.rank;
  std::string text = fmt::format("Rank: the readings alone determine {} of {} parameters", result.rank.rank,
                                 result.rank.parameters);
  if (rest == 0) return text + ".";
  if (std::ranges::any_of(result.functions, &FunctionSummary::smoothed)) {
    text += fmt::format(
        "; with automatic knots, which are finer than the data, the other {} are detail between the "
        "readings that the smoothing prior holds: resolution, not invisibility",
        rest);
    return text + (result.rank.invisible.empty() ? "." : ", except for the errors named here.");
  }
  if (result.rank.invisible.empty())
    return text + fmt::format("; {} rest on priors, and no error is invisible.", rest);
  return text + fmt::format("; {} combinations are not determined, in the errors named here.", rest);
}

std::string fit_text(const FitResult& result, const Campaign& campaign) {
  std::string text = headline(result) + reference_line(result);
  for (const std::string& part :
       {errors_table(result), expansions_table(result), setups_table(result), variance_table(result),
        noise_table_text(result.noise), outliers_table(result, campaign), notes(result)}) {
    if (!part.empty()) text += "\n" + part;
  }
  return text;
}

std::string fit_summary_text(const FitResult& result) {
  return headline(result) + reference_line(result) + errors_lines(result) + expansions_lines(result) +
         effects_lines(result) + setups_line(result) + noise_line(result.noise) + outliers_line(result) +
         rank_text(result) + "\n" + leading_messages(result);
}

}  // namespace volcal
