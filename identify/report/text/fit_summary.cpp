#include "volcal/identify/report/text/fit_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/values/residual_sample.h"
#include "volcal/identify/words/noise_words.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr std::size_t kListedOutliers = 10;

std::string headline(const FitResult& result, const Campaign& campaign) {
  return fmt::format(
      "{} ({})\n{} readings in {} setups; status {}; sigma0 {:.3f} (chi2/dof with the stated noise {:.3f})\n",
      campaign.machine.name, campaign.machine.structure.code,
      count_number(static_cast<long long>(result.residuals.size())), result.setups.size(),
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

/// Range of a function and its largest uncertainty where it was measured.
void add_function_row(const FitResult& result, const std::vector<ErrorTableRow>& table,
                      const Observability& error, TextTable& text) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  double low = kNone, high = kNone, largest_u = kNone;
  for (const ErrorTableRow& row : table) {
    if (row.symbol != error.symbol || row.extrapolated) continue;
    low = std::fmin(low, row.value);
    high = std::fmax(high, row.value);
    largest_u = std::fmax(largest_u, row.u);
  }
  const auto symbol = ErrorSymbol::parse(error.symbol);
  const bool rotation = symbol && is_rotation(symbol->component);
  const auto value = [](double si) { return fixed_number(si * 1e6, 2); };
  text.add_row({error.symbol, rotation ? "urad" : "um", error.visible ? value(low) : "-",
                error.visible ? value(high) : "-", value(result.coverage_factor * error.u_rms),
                value(result.coverage_factor * largest_u), fixed_number(error.visible_fraction, 2),
                fixed_number(error.effective_parameters, 1), error.visible ? "" : "NOT VISIBLE"});
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
    text.add_row({error.symbol, block->units[0], value, value, expanded, expanded,
                  fixed_number(error.visible_fraction, 2), error.visible ? "1.0" : "0.0",
                  error.visible ? "" : "NOT VISIBLE"});
  }
  return text.text();
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
           "length "
           "is "
           "supported.\n";
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

std::string notes(const FitResult& result) {
  std::string text = rank_text(result) + "\n";
  for (const std::string& message : sentences(result.findings)) text += "! " + message + "\n";
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
        "; with automatic knots, which are finer than the data, the other {} are detail between the readings "
        "that "
        "the smoothing prior holds: resolution, not invisibility",
        rest);
    return text + (result.rank.invisible.empty() ? "." : ", except for the errors named here.");
  }
  if (result.rank.invisible.empty())
    return text + fmt::format("; {} rest on priors, and no error is invisible.", rest);
  return text + fmt::format("; {} combinations are not determined, in the errors named here.", rest);
}

std::string fit_summary_text(const FitResult& result, const Campaign& campaign) {
  std::string text = headline(result, campaign) + reference_line(result);
  for (const std::string& part :
       {errors_table(result), setups_table(result), variance_table(result), noise_table_text(result.noise),
        outliers_table(result, campaign), notes(result)}) {
    if (!part.empty()) text += "\n" + part;
  }
  return text;
}

}  // namespace volcal
