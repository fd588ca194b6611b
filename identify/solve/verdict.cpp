#include "volcal/identify/solve/verdict.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/result/left_out_findings.h"
#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/rotary_places.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/kinematics/rotary_datum.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr double kSignificanceOfLackOfFit = 1e-3;
constexpr double kUnitSlip = 100.0;
constexpr double kContradicted = 5.0;       // standard deviations of a prior
constexpr double kFarGuess = 0.1;           // m, of a station: cm accuracy is enough
constexpr double kInPlane = 0.1;            // cosine of a line of sight to the normal
constexpr double kSmallestLackOfFit = 1.1;  // sigma0 below this is not worth a warning
constexpr double kSeveralTimes = 3.0;       // the stated sigma: hardly the instrument's noise

void report_stated_sigma(FitResult& result) {
  for (const VarianceComponent& component : result.variance_components) {
    if (std::abs(component.scale - 1.0) < std::max(0.1, 3.0 * component.scale_u)) continue;
    const bool unit_slip = component.scale > kUnitSlip;
    result.findings.push_back({FindingCode::NoiseSigmaContradicted,
                               {{"instrument", component.instrument},
                                {"times", FindingNumber{component.scale}},
                                {"independent_part", result.noise.more_than_white},
                                {"unit_slip", unit_slip},
                                {"too_quiet", component.scale < 1.0 / kUnitSlip},
                                {"hardly_noise", component.scale > kSeveralTimes && !unit_slip}}});
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

/// What the noise of a group is beside independent readings, by term.
std::map<std::string, FindingValue> correlated_terms(const NoiseSummary& noise, std::size_t group) {
  const std::string unit = noise_group_unit(noise.groups[group]);
  std::map<std::string, FindingValue> terms;
  for (const NoiseRow& row : noise.rows) {
    if (row.instrument != group || row.value == 0.0) continue;
    if (row.term == "wander") terms["drift"] = FindingNumber{row.value, unit, kMicro};
    if (row.term == "tau") terms["drift_time"] = FindingNumber{row.value, "s"};
    if (row.term == "line") terms["line_offsets"] = FindingNumber{row.value, unit, kMicro};
    if (row.term == "per_metre") terms["per_metre"] = FindingNumber{row.value, "um/m", kMicro};
  }
  if (!terms.contains("drift")) terms.erase("drift_time");
  return terms;
}

void report_noise(const Campaign& campaign, FitResult& result) {
  if (!result.noise.more_than_white) return;
  const std::map<std::string, double> over_stated = noise_over_stated(campaign, result);
  for (std::size_t g = 0; g < result.noise.groups.size(); ++g) {
    const std::string& group = result.noise.groups[g];
    std::map<std::string, FindingValue> terms = correlated_terms(result.noise, g);
    if (terms.empty()) continue;
    terms["instrument"] = group;
    result.findings.push_back({FindingCode::NoiseMoreThanWhite, std::move(terms)});
    const auto times = over_stated.find(group);
    if (times == over_stated.end() || times->second < kSeveralTimes) continue;
    result.findings.push_back({FindingCode::NoiseSeveralTimesStated,
                               {{"instrument", group}, {"times", FindingNumber{times->second}}}});
  }
}

void report_outliers(FitResult& result) {
  const std::int64_t flagged = std::ranges::count_if(
      result.residuals, [](const ResidualRecord& r) { return r.flagged && !r.removed; });
  const std::int64_t removed = std::ranges::count_if(
      result.residuals, [](const ResidualRecord& r) { return r.removed && !r.left_out; });
  if (flagged > 0) {
    result.findings.push_back(
        {FindingCode::ReadingsFlagged, {{"readings", flagged}, {"some_removed", removed > 0}}});
  }
  if (removed > 0) result.findings.push_back({FindingCode::ReadingsRemoved, {{"readings", removed}}});
}

/// A guess of metres is worth a correction though no prior holds it: a fit may start too far off.
void report_far_guesses(FitResult& result) {
  const auto millimetres = [](double metres) { return FindingNumber{metres, "mm", kMetrePerMillimetre}; };
  for (const ParameterBlock& block : result.layout.blocks) {
    const bool point = block.kind == ParameterKind::Nuisance && block.units[0] == "mm" &&
                       block.labels == std::vector<std::string>{"x", "y", "z"};
    if (!point || (block.prior_sigma.array() != 0.0).any()) continue;
    const Eigen::Vector3d guess = block.guess;
    const Eigen::Vector3d found = result.parameters.segment<3>(block.offset);
    if ((found - guess).norm() < kFarGuess) continue;
    const double ratio = guess.norm() > 0.0 ? found.norm() / guess.norm() : 0.0;
    result.findings.push_back({FindingCode::StationFarFromGuess,
                               {{"block", block.name},
                                {"distance", millimetres((found - guess).norm())},
                                {"x", millimetres(found.x())},
                                {"y", millimetres(found.y())},
                                {"z", millimetres(found.z())},
                                {"guess_in_metres", std::abs(std::log(ratio / 1e3)) < std::log(2.0)}}});
  }
}

/// Largest cosine, over all lines of sight, to a direction of the workpiece; negative without any.
double most_along(const MeasurementModel& model, int direction, const Eigen::VectorXd& parameters) {
  double most = -1.0;
  MeasurementModel::DisturbanceRows rows;
  for (std::size_t setup = 0; setup < model.campaign().setups.size(); ++setup) {
    const Readings& readings = model.campaign().setups[setup].readings;
    for (std::size_t row = 0; row < readings.size(); ++row) {
      model.disturbance_rows(setup, row, parameters, rows);
      for (std::size_t channel = 0; channel < readings.channels(); ++channel) {
        const Eigen::Vector3d sight =
            rows.block<1, 3>(static_cast<Eigen::Index>(channel), kStationDisturbance).transpose();
        if (!sight.isZero()) most = std::max(most, std::abs(sight[direction]) / sight.norm());
      }
    }
  }
  return most;
}

void report_stations_in_plane(const MeasurementModel& model, FitResult& result) {
  if (station_names(model.campaign()).empty()) return;
  for (const AxisName axis : kLinearAxes) {
    if (model.campaign().machine.has_axis(axis)) continue;
    const double most = most_along(model, direction_of(axis), result.parameters);
    if (most < 0.0 || most >= kInPlane) continue;
    result.findings.push_back({FindingCode::StationsInPlane,
                               {{"axis", std::string(1, letter_of(axis))}, {"share", FindingNumber{most}}}});
  }
}

void report_unrecorded_drivers(const Campaign& campaign, const CampaignBinding& binding, FitResult& result) {
  for (const EffectBinding& effect : binding.effects) {
    std::size_t unrecorded = 0;
    for (const Setup& setup : campaign.setups)
      unrecorded += effect.effect->unrecorded({campaign, setup, {}, {}});
    if (unrecorded == 0) continue;
    result.findings.push_back({FindingCode::EffectDriverUnrecorded,
                               {{"effect", effect_label(*effect.effect)},
                                {"readings", static_cast<std::int64_t>(unrecorded)},
                                {"driver", effect.effect->name().driver.name()}}});
  }
}

/// Of functions whose harmonics follow from the readings: a regular grid hides the higher ones, and no error
/// is reported that is not visible.
void report_hidden_harmonics(const Campaign& campaign, FitResult& result) {
  for (const AxisName axis : moving_rotary_axes(campaign)) {
    const bool is_periodic = std::ranges::any_of(result.identified.functions, [&](const auto& entry) {
      return entry.first.axis == axis && entry.second.basis == "fourier";
    });
    const std::vector<double> places = places_in_turn(campaign, axis);
    const int parts = regular_parts(places), told = most_periods(places);
    if (!is_periodic || parts == 0 || told >= kMostAutomaticHarmonics) continue;
    result.findings.push_back(
        {FindingCode::RotaryHarmonicsHidden,
         {{"axis", std::string(1, letter_of(axis))},
          {"positions", static_cast<std::int64_t>(places.size())},
          {"told", static_cast<std::int64_t>(told)},
          {"spacing", FindingNumber{2.0 * std::numbers::pi / parts, "deg", kRadianPerDegree}}}});
  }
}

/// Of rotary axes that move: what the model file leaves out of their errors.
void report_rotary_errors_left_out(const Campaign& campaign, FitResult& result) {
  const ModelSpec& model = result.identified;
  const std::vector<AxisName> without = rotary_axes_without_errors(campaign, model);
  const std::vector<LocationSymbol> known = independent_locations(campaign.machine);
  for (const AxisName axis : moving_rotary_axes(campaign)) {
    Finding finding{FindingCode::RotaryErrorsNotInModel,
                    {{"axis", std::string(1, letter_of(axis))}, {"by_model", true}}};
    if (std::ranges::find(without, axis) == without.end()) {
      std::vector<std::string> missing;
      for (const LocationSymbol& symbol : known) {
        const bool is_off = std::ranges::find(model.locations_off, symbol) != model.locations_off.end();
        if (symbol.axis == axis && !is_off && !model.locations.contains(symbol))
          missing.push_back(symbol.name());
      }
      if (missing.empty()) continue;
      finding.data["locations"] = missing;
    }
    result.findings.push_back(std::move(finding));
  }
}

void report_lack_of_fit(FitResult& result) {
  result.findings.push_back(
      {FindingCode::FitLackOfFit,
       {{"times", FindingNumber{result.sigma0}}, {"more_than_white", result.noise.more_than_white}}});
}

}  // namespace

std::vector<Finding> contradicted_priors(const std::vector<ParameterBlock>& blocks,
                                         const Eigen::VectorXd& parameters, const Eigen::VectorXd& more_u) {
  std::vector<Finding> findings;
  for (const ParameterBlock& block : blocks) {
    for (int k = 0; k < block.size(); ++k) {
      const double sigma = block.prior_sigma[k];
      if (sigma == 0.0) continue;
      const double miss = std::abs(parameters[block.offset + k] - block.prior_mean[k]);
      const double more = more_u.size() > 0 ? more_u[block.offset + k] : 0.0;
      if (miss < kContradicted * std::hypot(sigma, more)) continue;
      const auto at = static_cast<std::size_t>(k);
      findings.push_back({FindingCode::PriorContradicted,
                          {{"block", block.name},
                           {"parameter", block.labels[at]},
                           {"miss", FindingNumber{miss, block.units[at], block.si_per_unit[at]}},
                           {"sigma", FindingNumber{sigma, block.units[at], block.si_per_unit[at]}},
                           {"default", block.weak_default_prior}}});
    }
  }
  return findings;
}

void judge(const MeasurementModel& model, const AdjustmentEnd& end, FitResult& result) {
  const Campaign& campaign = model.campaign();
  result.findings.insert(result.findings.end(), campaign.notes.begin(), campaign.notes.end());
  report_stated_sigma(result);
  report_noise(campaign, result);
  const double exceedance = result.dof > 0.0 ? chi_squared_exceedance(result.chi2, result.dof) : 1.0;
  const bool lack = exceedance < kSignificanceOfLackOfFit && result.sigma0 > kSmallestLackOfFit;
  result.findings.insert(result.findings.end(), result.rank.invisible.begin(), result.rank.invisible.end());
  report_hidden_harmonics(campaign, result);
  report_rotary_errors_left_out(campaign, result);
  std::ranges::move(left_out_findings(campaign), std::back_inserter(result.findings));
  report_outliers(result);
  std::ranges::move(contradicted_priors(result.layout.blocks, result.parameters),
                    std::back_inserter(result.findings));
  report_far_guesses(result);
  report_stations_in_plane(model, result);
  report_unrecorded_drivers(campaign, model.binding(), result);
  if (lack) report_lack_of_fit(result);
  if (!end.converged) result.findings.push_back({FindingCode::FitNotConverged});
  result.status = !end.converged       ? FitStatus::NotConverged
                  : end.rank_deficient ? FitStatus::RankDeficient
                  : lack               ? FitStatus::LackOfFit
                                       : FitStatus::Ok;
}

}  // namespace volcal
