#include "volcal/identify/criticism/scans/reading_factors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/model/description/units.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

/// A sign; millimetres in place of micrometres. None between 0 and 1: readings that the model does not
/// explain ask for such a factor.
constexpr std::array<double, 2> kSlips = {-1.0, 1e3};

/// Setups whose readings a slip would change together, and channels of these.
struct Suspect {
  std::vector<std::size_t> setups;
  std::vector<int> channels;

  bool has(const LinearModel::Observation& place) const {
    return std::ranges::find(setups, place.setup) != setups.end() &&
           std::ranges::find(channels, place.channel) != channels.end();
  }
};

const std::vector<ColumnSchema>& columns_of(const Setup& setup) {
  return find_instrument(setup.instrument)->schema().column_sets[setup.readings.column_set];
}

/// In um or urad: zero on a machine without errors.
std::vector<int> channels_of_deviations(const Setup& setup) {
  std::vector<int> channels;
  const std::vector<ColumnSchema>& columns = columns_of(setup);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const std::string_view unit = unit_of_key(columns[k].column).suffix;
    if (unit == "um" || unit == "urad") channels.push_back(static_cast<int>(k));
  }
  return channels;
}

void add_with_single_channels(const std::vector<std::size_t>& setups, const std::vector<int>& channels,
                              std::vector<Suspect>& suspects) {
  suspects.push_back({setups, channels});
  if (channels.size() == 1) return;
  for (const int channel : channels) suspects.push_back({setups, {channel}});
}

/// Every setup that has observations on its own, and all of an instrument.
std::vector<Suspect> suspects_of(const LinearModel& model) {
  const Campaign& campaign = model.campaign();
  std::set<std::size_t> present;
  for (const LinearModel::Observation& place : model.observations()) present.insert(place.setup);
  std::vector<Suspect> suspects;
  std::map<std::pair<std::string, std::size_t>, std::vector<std::size_t>> of_instrument;
  for (const std::size_t s : present) {
    const Setup& setup = campaign.setups[s];
    if (find_instrument(setup.instrument) == nullptr) continue;
    const std::vector<int> channels = channels_of_deviations(setup);
    if (channels.empty()) continue;
    of_instrument[{setup.instrument, setup.readings.column_set}].push_back(s);
    add_with_single_channels({s}, channels, suspects);
  }
  for (const auto& [instrument, setups] : of_instrument) {
    if (setups.size() > 1)
      add_with_single_channels(setups, channels_of_deviations(campaign.setups[setups.front()]), suspects);
  }
  return suspects;
}

/// Readings of every suspect, zero elsewhere.
Eigen::MatrixXd readings_of(const std::vector<Suspect>& suspects, const LinearModel& model) {
  const auto& places = model.observations();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(places.size()),
                                                  static_cast<Eigen::Index>(suspects.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Readings& readings = model.campaign().setups[places[i].setup].readings;
    const double value = readings.value[static_cast<std::size_t>(places[i].channel)][places[i].row];
    for (std::size_t k = 0; k < suspects.size(); ++k) {
      if (suspects[k].has(places[i]))
        columns(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = value;
    }
  }
  return columns;
}

/// The slip that the others expect, and by how much chi-squared falls with it; a factor of 1 where it is
/// none.
std::pair<double, double> slip_of(double score, double square) {
  if (!(square > 0.0)) return {1.0, 0.0};
  const double expected = 1.0 - score / square, u = 1.0 / std::sqrt(square);
  for (const double slip : kSlips) {
    const double change = 1.0 - slip;
    const double gain = change * (2.0 * score - change * square);
    const double most = score * score / square;
    const bool is_near = std::abs(expected - slip) <
                         kThresholds.reading_factor_u * u + kThresholds.reading_factor_share * std::abs(slip);
    if (is_near && gain > kThresholds.reading_factor_gain && gain > kThresholds.reading_factor_of_best * most)
      return {slip, gain};
  }
  return {1.0, 0.0};
}

}  // namespace

std::optional<ReadingFactor> misread_setup(const LinearModel& model, const Projector& projector) {
  const std::vector<Suspect> suspects = suspects_of(model);
  if (suspects.empty()) return std::nullopt;
  const ProjectedColumns projected = projector.project(readings_of(suspects, model));
  std::vector<std::pair<double, double>> slips;  // factor and gain of every suspect
  for (Eigen::Index k = 0; k < projected.count(); ++k)
    slips.push_back(slip_of(projected.score[k], projected.grams.front()(k, k)));
  const auto leading = std::ranges::max_element(slips, {}, &std::pair<double, double>::second);
  const auto [factor, gain] = *leading;
  if (factor == 1.0) return std::nullopt;
  const Suspect& suspect = suspects[static_cast<std::size_t>(leading - slips.begin())];
  const Setup& first = model.campaign().setups[suspect.setups.front()];
  std::set<std::size_t> setups;
  for (std::size_t k = 0; k < suspects.size(); ++k) {
    const Setup& other = model.campaign().setups[suspects[k].setups.front()];
    const bool alike = slips[k].first == factor && suspects[k].channels == suspect.channels &&
                       other.instrument == first.instrument;
    if (alike) setups.insert(suspects[k].setups.begin(), suspects[k].setups.end());
  }
  ReadingFactor found{{setups.begin(), setups.end()}, {}, factor, gain};
  for (const int channel : suspect.channels)
    found.columns.push_back(columns_of(first)[static_cast<std::size_t>(channel)].column);
  return found;
}

}  // namespace volcal
