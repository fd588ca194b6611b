#include "volcal/identify/solve/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/solve/noise_words.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr double kSignificanceOfLackOfFit = 1e-3;
constexpr double kUnitSlip = 100.0;
constexpr double kContradicted = 5.0;       // standard deviations of a prior
constexpr double kFarGuess = 0.1;           // m, of a station: cm accuracy is enough
constexpr double kSmallestLackOfFit = 1.1;  // sigma0 below this is not worth a warning
constexpr double kSeveralTimes = 3.0;       // the stated sigma: hardly the instrument's noise

constexpr const char* kHardlyNoise =
    "; that is hardly the instrument: an effect that the model lacks looks like noise, or the noise table is "
    "wrong";

void report_stated_sigma(FitResult& result) {
  for (const VarianceComponent& component : result.variance_components) {
    if (std::abs(component.scale - 1.0) < std::max(0.1, 3.0 * component.scale_u)) continue;
    std::ostringstream text;
    text.precision(3);
    text << component.instrument << ": "
         << (result.noise.more_than_white ? "the independent part of its residuals scatters "
                                          : "its residuals scatter ")
         << component.scale << " times as much as its stated sigma; "
         << "weights and uncertainties use the estimated value";
    if (component.scale > kUnitSlip) {
      text
          << "; is its noise stated in a unit 1000 times too small (nm for um)? check the noise table of its "
             "setups and the unit of the readings";
    }
    if (component.scale > kSeveralTimes && component.scale <= kUnitSlip) text << kHardlyNoise;
    result.messages.push_back(text.str());
  }
}

/// Noise of all kinds together over the stated one, in root mean square; per noise group.
std::map<std::string, double> noise_over_stated(const Campaign& campaign, const FitResult& result) {
  std::map<std::string, double> estimated, stated;
  const std::vector<double>& sigma = result.adjustment->stated_sigma;
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    const ResidualRecord& record = result.residuals[i];
    if (record.removed) continue;
    const std::string group =
        noise_group(campaign.setups[record.setup], static_cast<std::size_t>(record.channel));
    estimated[group] += record.sigma * record.sigma;
    stated[group] += sigma[i] * sigma[i];
  }
  for (auto& [group, squares] : estimated) squares = std::sqrt(squares / stated[group]);
  return estimated;
}

/// "correlated drift of 0.41 um over 580 s", empty for what stands in no sentence of its own.
std::string noise_phrase(const NoiseSummary& noise, const NoiseRow& row) {
  const EdgeNoise edge = edge_noise(row, noise.groups[row.instrument]);
  if (row.term == "line") return fmt::format("offsets of lines of {:.2g} {}", edge.value, edge.unit);
  if (row.term == "per_metre") return fmt::format("{:.2g} {} in proportion to length", edge.value, edge.unit);
  if (row.term != "wander") return {};
  const auto tau = std::ranges::find_if(noise.rows, [&](const NoiseRow& other) {
    return other.term == "tau" && other.instrument == row.instrument;
  });
  return fmt::format("correlated drift of {:.2g} {}", edge.value, edge.unit) +
         (tau == noise.rows.end() ? "" : fmt::format(" over {:.0f} s", tau->value));
}

void report_noise(const Campaign& campaign, FitResult& result) {
  if (!result.noise.more_than_white) return;
  const std::map<std::string, double> over_stated = noise_over_stated(campaign, result);
  for (std::size_t g = 0; g < result.noise.groups.size(); ++g) {
    std::string phrases;
    for (const NoiseRow& row : result.noise.rows) {
      if (row.instrument != g || row.value == 0.0) continue;
      const std::string phrase = noise_phrase(result.noise, row);
      if (!phrase.empty()) phrases += (phrases.empty() ? "" : ", ") + phrase;
    }
    if (phrases.empty()) continue;
    result.messages.push_back(result.noise.groups[g] + ": its noise is not independent (" + phrases +
                              "); weights and uncertainties allow for it");
    const auto times = over_stated.find(result.noise.groups[g]);
    if (times == over_stated.end() || times->second < kSeveralTimes) continue;
    result.messages.push_back(fmt::format("{}: all its noise together is {:.3g} times what is stated{}",
                                          times->first, times->second, kHardlyNoise));
  }
}

/// One message per setup and reason: rows as lines of the file.
void report_left_out(const Campaign& campaign, FitResult& result) {
  for (const Setup& setup : campaign.setups) {
    std::map<std::string, std::set<std::int64_t>> rows_of_reason;
    for (const LeftOutReading& reading : setup.left_out) {
      rows_of_reason[reading.reason].insert(setup.readings.source_line[reading.row]);
    }
    for (const auto& [reason, rows] : rows_of_reason) {
      std::string list;
      for (const std::int64_t row : rows) list += (list.empty() ? "" : ", ") + std::to_string(row);
      result.messages.push_back("setup \"" + setup.name + "\" leaves out " +
                                (rows.size() == 1 ? "row " : "rows ") + list + ": " + reason);
    }
  }
}

void report_outliers(FitResult& result) {
  const auto flagged = std::ranges::count_if(result.residuals,
                                             [](const ResidualRecord& r) { return r.flagged && !r.removed; });
  const auto removed = std::ranges::count_if(
      result.residuals, [](const ResidualRecord& r) { return r.removed && !r.left_out; });
  if (flagged > 0) {
    result.messages.push_back(std::to_string(flagged) +
                              " readings are flagged by the w-test and still in the adjustment; they are "
                              "listed in residuals.csv (" +
                              (removed == 0 ? "--outliers remove takes them out"
                                            : "so many were removed before that the model or the stated "
                                              "noise must be in doubt: run `volcal compare`") +
                              ")");
  }
  if (removed > 0) {
    result.messages.push_back(std::to_string(removed) +
                              " readings were removed by the w-test; they are listed in residuals.csv");
  }
}

/// A stated guess that the readings contradict is a mistake in a file, or a model that lacks something.
void report_contradicted_priors(FitResult& result) {
  for (const ParameterBlock& block : result.layout.blocks) {
    for (int k = 0; k < block.size(); ++k) {
      if (block.prior_sigma[k] == 0.0) continue;
      const double miss = result.parameters[block.offset + k] - block.prior_mean[k];
      if (std::abs(miss) < kContradicted * block.prior_sigma[k]) continue;
      const auto at = static_cast<std::size_t>(k);
      std::ostringstream text;
      text.precision(3);
      text << block.name << (block.labels[at].empty() ? "" : " " + block.labels[at]) << ": estimated "
           << std::abs(miss) / block.si_per_unit[at] << ' ' << block.units[at]
           << " away from what the files say, " << std::abs(miss) / block.prior_sigma[k] << " times its "
           << (block.weak_default_prior ? "default" : "stated") << " standard deviation of "
           << block.prior_sigma[k] / block.si_per_unit[at] << ' ' << block.units[at]
           << "; correct the value, or state a larger one";
      result.messages.push_back(text.str());
    }
  }
}

/// A guess of metres is worth a correction though no prior holds it: a fit may start too far off.
void report_far_guesses(FitResult& result) {
  for (const ParameterBlock& block : result.layout.blocks) {
    const bool point = block.kind == ParameterKind::Nuisance && block.units[0] == "mm" &&
                       block.labels == std::vector<std::string>{"x", "y", "z"};
    if (!point || (block.prior_sigma.array() != 0.0).any()) continue;
    const Eigen::Vector3d guess = block.guess;
    const Eigen::Vector3d found = result.parameters.segment<3>(block.offset);
    if ((found - guess).norm() < kFarGuess) continue;
    const double ratio = guess.norm() > 0.0 ? found.norm() / guess.norm() : 0.0;
    result.messages.push_back(fmt::format(
        "{}: found {:.0f} mm from its guess; write [{:.0f}, {:.0f}, {:.0f}] mm in the campaign file{}",
        block.name, (found - guess).norm() * 1e3, found.x() * 1e3, found.y() * 1e3, found.z() * 1e3,
        std::abs(std::log(ratio / 1e3)) < std::log(2.0) ? " (is the guess in m?)" : ""));
  }
}

void report_unrecorded_drivers(const Campaign& campaign, const CampaignBinding& binding, FitResult& result) {
  for (const EffectBinding& effect : binding.effects) {
    std::size_t unrecorded = 0;
    for (const Setup& setup : campaign.setups)
      unrecorded += effect.effect->unrecorded({campaign, setup, {}, {}});
    if (unrecorded == 0) continue;
    result.messages.push_back(effect_label(*effect.effect) + ": " + std::to_string(unrecorded) +
                              " readings do not record " + effect.effect->name().driver +
                              " and carry nothing of the effect");
  }
}

void report_lack_of_fit(FitResult& result) {
  std::ostringstream text;
  text.precision(3);
  text << "lack of fit: residuals are " << result.sigma0 << " times the stated noise; ";
  if (result.noise.more_than_white)
    text << "an effect that the model lacks can look like the noise found here, which `volcal diagnose` "
            "tells; ";
  text << "run `volcal compare` to see where the model fails";
  result.messages.push_back(text.str());
}

}  // namespace

std::string_view to_string(FitStatus status) {
  switch (status) {
    case FitStatus::Ok:
      return "ok";
    case FitStatus::LackOfFit:
      return "lack_of_fit";
    case FitStatus::RankDeficient:
      return "rank_deficient";
    case FitStatus::NotConverged:
      return "not_converged";
  }
  return "";
}

void judge(const Campaign& campaign, const CampaignBinding& binding, const AdjustmentEnd& end,
           FitResult& result) {
  result.messages.insert(result.messages.end(), campaign.notes.begin(), campaign.notes.end());
  report_stated_sigma(result);
  report_noise(campaign, result);
  const double exceedance = result.dof > 0.0 ? chi_squared_exceedance(result.chi2, result.dof) : 1.0;
  const bool lack = exceedance < kSignificanceOfLackOfFit && result.sigma0 > kSmallestLackOfFit;
  for (const std::string& sentence : result.rank.invisible) result.messages.push_back(sentence);
  report_left_out(campaign, result);
  report_outliers(result);
  report_contradicted_priors(result);
  report_far_guesses(result);
  report_unrecorded_drivers(campaign, binding, result);
  if (lack) report_lack_of_fit(result);
  if (!end.converged)
    result.messages.emplace_back("not converged: the cost still fell after the last iteration");
  result.status = !end.converged       ? FitStatus::NotConverged
                  : end.rank_deficient ? FitStatus::RankDeficient
                  : lack               ? FitStatus::LackOfFit
                                       : FitStatus::Ok;
}

}  // namespace volcal
