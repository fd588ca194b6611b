#include "volcal/identify/solve/campaign_noise.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "volcal/identify/statistics/even_sample.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

/// Positions within a sequence in time order, `count` of them.
std::vector<std::size_t> first_in_time(const NoiseSequence& sequence, std::size_t count) {
  std::vector<std::size_t> order(sequence.observation.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!sequence.time.empty())
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return sequence.time[k]; });
  order.resize(std::min(count, order.size()));
  return order;
}

/// Sequences in the order in which a sample takes them: one of each group, then by a scrambled index.
std::vector<std::size_t> sampling_order(const std::vector<NoiseSequence>& sequences) {
  std::vector<std::size_t> order(sequences.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, scrambled);
  std::set<std::size_t> seen;
  std::stable_partition(order.begin(), order.end(),
                        [&](std::size_t i) { return seen.insert(sequences[i].group).second; });
  return order;
}

}  // namespace

std::vector<ObservationPlace> observation_places(const MeasurementModel& model) {
  std::vector<ObservationPlace> places;
  const auto& setups = model.campaign().setups;
  for (std::size_t setup = 0; setup < setups.size(); ++setup) {
    for (std::size_t row = 0; row < setups[setup].readings.size(); ++row) {
      for (int channel = 0; channel < model.bound(setup).channels(); ++channel)
        places.push_back({setup, row, channel});
    }
  }
  return places;
}

CampaignNoise campaign_noise(const MeasurementModel& model, std::vector<double> stated_sigma,
                             const std::vector<bool>& removed, const Eigen::VectorXd* estimated) {
  CampaignNoise noise{observation_places(model), {}, {}};
  noise.data.sigma = std::move(stated_sigma);
  std::map<std::tuple<std::size_t, std::int32_t, int>, std::size_t> sequence_of;
  for (std::size_t i = 0; i < noise.places.size(); ++i) {
    const auto [setup_index, row, channel] = noise.places[i];
    const Setup& setup = model.campaign().setups[setup_index];
    const Readings& readings = setup.readings;
    if (!removed.empty() && removed[i]) noise.data.sigma[i] = std::numeric_limits<double>::infinity();
    noise.data.length.push_back(estimated ? model.noise_length(setup_index, row, channel, *estimated)
                                          : model.bound(setup_index).noise_length(row, channel));
    const std::int32_t run = readings.run.empty() ? 0 : readings.run[row];
    const auto [found, is_new] =
        sequence_of.try_emplace({setup_index, run, channel}, noise.data.sequences.size());
    if (is_new) {
      noise.data.sequences.emplace_back();
      const std::string group = noise_group(setup, static_cast<std::size_t>(channel));
      const auto known = std::ranges::find(noise.groups, group);
      noise.data.sequences.back().group = static_cast<std::size_t>(known - noise.groups.begin());
      if (known == noise.groups.end()) noise.groups.push_back(group);
    }
    NoiseSequence& sequence = noise.data.sequences[found->second];
    sequence.observation.push_back(i);
    if (!readings.time.empty()) sequence.time.push_back(readings.time[row]);
    if (!readings.line.empty()) sequence.line.push_back(readings.line[row]);
  }
  return noise;
}

CampaignNoise sampled(const CampaignNoise& all, std::size_t limit, std::size_t most_setups) {
  std::set<std::size_t> setups;
  for (const ObservationPlace& place : all.places) setups.insert(place.setup);
  if (all.places.size() <= limit && setups.size() <= most_setups) return all;
  setups.clear();
  CampaignNoise sample{{}, {}, all.groups};
  for (const std::size_t which : sampling_order(all.data.sequences)) {
    const bool each_instrument = sample.data.sequences.size() >= all.groups.size();
    if (each_instrument && sample.places.size() >= limit) break;
    const NoiseSequence& sequence = all.data.sequences[which];
    const std::size_t setup = all.places[sequence.observation.front()].setup;
    if (each_instrument && setups.size() >= most_setups && !setups.contains(setup)) continue;
    setups.insert(setup);
    NoiseSequence kept;
    kept.group = sequence.group;
    for (const std::size_t k : first_in_time(sequence, limit)) {
      const std::size_t i = sequence.observation[k];
      kept.observation.push_back(sample.places.size());
      if (!sequence.time.empty()) kept.time.push_back(sequence.time[k]);
      if (!sequence.line.empty()) kept.line.push_back(sequence.line[k]);
      sample.places.push_back(all.places[i]);
      sample.data.sigma.push_back(all.data.sigma[i]);
      sample.data.length.push_back(all.data.length[i]);
    }
    sample.data.sequences.push_back(std::move(kept));
  }
  return sample;
}

std::vector<std::size_t> evenly_chosen(const std::vector<ObservationPlace>& places, std::size_t limit) {
  std::vector<std::size_t> first;  // observation of every reading
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 0 || places[i].setup != places[i - 1].setup || places[i].row != places[i - 1].row)
      first.push_back(i);
  }
  const std::size_t readings = first.size();
  first.push_back(places.size());
  const std::size_t most = places.size() <= limit ? readings : limit * readings / places.size();
  std::vector<std::size_t> chosen;
  for (const std::size_t reading : even_sample(readings, most)) {
    for (std::size_t i = first[reading]; i < first[reading + 1]; ++i) chosen.push_back(i);
  }
  return chosen;
}

CampaignNoise restricted(const CampaignNoise& all, const std::vector<std::size_t>& chosen) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  CampaignNoise part{{}, {}, all.groups};
  std::vector<std::size_t> number(all.places.size(), kNone);
  for (const std::size_t i : chosen) {
    number[i] = part.places.size();
    part.places.push_back(all.places[i]);
    part.data.sigma.push_back(all.data.sigma[i]);
    part.data.length.push_back(all.data.length[i]);
  }
  for (const NoiseSequence& sequence : all.data.sequences) {
    NoiseSequence kept;
    kept.group = sequence.group;
    for (std::size_t k = 0; k < sequence.observation.size(); ++k) {
      if (number[sequence.observation[k]] == kNone) continue;
      kept.observation.push_back(number[sequence.observation[k]]);
      if (!sequence.time.empty()) kept.time.push_back(sequence.time[k]);
      if (!sequence.line.empty()) kept.line.push_back(sequence.line[k]);
    }
    if (!kept.observation.empty()) part.data.sequences.push_back(std::move(kept));
  }
  return part;
}

namespace {

/// Calls `visit(i, row)` with the derivatives of the reading of every place i.
template <class Visit>
void for_each_row(const MeasurementModel& model, const Eigen::VectorXd& parameters,
                  const std::vector<ObservationPlace>& places, const Visit& visit) {
  RowJacobian row;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const bool same_reading =
        i > 0 && places[i].setup == places[i - 1].setup && places[i].row == places[i - 1].row;
    if (!same_reading) model.linearize(places[i].setup, places[i].row, parameters, row);
    visit(static_cast<Eigen::Index>(i), row);
  }
}

LocalRows empty_local_rows(const ParameterLayout& layout, const DatumSpace& datum, std::size_t count) {
  LocalRows local;
  for (const FunctionGroup& group : layout.groups) {
    local.groups.push_back(
        {std::vector<Eigen::Index>(count),
         Eigen::MatrixXd(group.basis->support() * group.count(), static_cast<Eigen::Index>(count))});
  }
  for (const DatumSpace::FunctionCoordinates& function : datum.functions())
    local.combinations.push_back({function.raw, function.basis, function.offset});
  local.coefficients = layout.function_size;
  return local;
}

}  // namespace

std::vector<NoiseParameters> fitted_noise(const FitResult& result, const std::vector<std::string>& groups) {
  std::vector<NoiseParameters> noise(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto component =
        std::ranges::find(result.variance_components, groups[g], &VarianceComponent::instrument);
    if (component != result.variance_components.end()) noise[g].white = component->scale;
  }
  if (!result.noise.more_than_white) return noise;
  for (const NoiseRow& row : result.noise.rows) {
    const auto group = std::ranges::find(groups, result.noise.groups.at(row.instrument));
    if (group == groups.end()) continue;
    NoiseParameters& own = noise.at(static_cast<std::size_t>(group - groups.begin()));
    if (row.term == "wander") own.drift = row.value;
    if (row.term == "tau" && row.value > 0.0) own.tau = row.value;
    if (row.term == "line") own.line = row.value;
    if (row.term == "per_metre") own.per_metre = row.value;
  }
  return noise;
}

void linearise(const MeasurementModel& model, const DatumSpace& datum, const Eigen::VectorXd& parameters,
               const std::vector<ObservationPlace>& places, NoiseProblem& problem) {
  const auto count = static_cast<Eigen::Index>(places.size());
  Eigen::MatrixXd jacobian(count, datum.size());
  problem.residual.resize(count);
  for_each_row(model, parameters, places, [&](Eigen::Index i, const RowJacobian& row) {
    const auto [setup, reading, channel] = places[static_cast<std::size_t>(i)];
    jacobian.row(i) = datum.reduce_rows(dense_row(model.layout(), row, channel).transpose());
    const Readings& readings = model.campaign().setups[setup].readings;
    problem.residual[i] = readings.value[static_cast<std::size_t>(channel)][reading] - row.predicted[channel];
  });
  problem.jacobian = std::move(jacobian);
}

NoiseProblem without_unseen_nuisance(NoiseProblem problem, const ParameterLayout& layout,
                                     const DatumSpace& datum) {
  std::vector<bool> is_unseen(static_cast<std::size_t>(problem.jacobian.cols()), false);
  for (const DatumSpace::BlockCoordinates& block : datum.blocks()) {
    if (layout.blocks[block.block].kind != ParameterKind::Nuisance) continue;
    if (!problem.jacobian.middleCols(block.offset, block.size).isZero(0.0)) continue;
    std::fill_n(is_unseen.begin() + block.offset, block.size, true);
  }
  std::vector<Eigen::Index> seen;
  for (std::size_t k = 0; k < is_unseen.size(); ++k) {
    if (!is_unseen[k]) seen.push_back(static_cast<Eigen::Index>(k));
  }
  problem.jacobian = problem.jacobian(Eigen::all, seen).eval();
  problem.prior_precision = problem.prior_precision(seen, seen).eval();
  problem.prior_mean = problem.prior_mean(seen).eval();
  return problem;
}

LocalRows local_rows(const MeasurementModel& model, const DatumSpace& datum,
                     const Eigen::VectorXd& parameters, const std::vector<ObservationPlace>& places) {
  const ParameterLayout& layout = model.layout();
  LocalRows local = empty_local_rows(layout, datum, places.size());
  for_each_row(model, parameters, places, [&](Eigen::Index i, const RowJacobian& row) {
    const Eigen::VectorXd derivatives = dense_row(layout, row, places[static_cast<std::size_t>(i)].channel);
    for (std::size_t g = 0; g < layout.groups.size(); ++g) {
      LocalRows::Group& group = local.groups[g];
      const Eigen::Index first = layout.groups[g].index(row.start[g], 0);
      group.first[static_cast<std::size_t>(i)] = first;
      group.derivatives.col(i) = derivatives.segment(first, group.derivatives.rows());
    }
  });
  return local;
}

}  // namespace volcal
