#include "volcal/identify/criticism/proposals/hypothetical_campaign.h"

#include <algorithm>
#include <map>
#include <utility>

#include "volcal/identify/solve/adjustment.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr double kWideNuisance = 1.0;  // m or rad, what a new station or dead path may be off

using BlockPlaces = std::map<std::string, std::pair<int, int>>;  // name -> offset and size

BlockPlaces reduced_places(const ParameterLayout& layout, const DatumSpace& datum) {
  BlockPlaces places;
  for (const auto& block : datum.blocks())
    places[layout.blocks[block.block].name] = {block.offset, block.size};
  return places;
}

void continue_sequence(NoiseSequence& sequence, std::size_t observation, const Readings& readings,
                       std::size_t row) {
  sequence.observation.push_back(observation);
  if (!readings.time.empty()) sequence.time.push_back(readings.time[row]);
  if (!readings.line.empty()) sequence.line.push_back(readings.line[row]);
}

}  // namespace

HypotheticalCampaign::HypotheticalCampaign(const Campaign& campaign, const FitResult& result,
                                           std::vector<std::string> noise_groups,
                                           std::vector<ExtraMeasurement> measurements)
    : measurements_(std::move(measurements)),
      noise_groups_(std::move(noise_groups)),
      campaign_(extended(campaign)),
      model_(campaign_, result.adjustment->model) {
  map_parameters(campaign, result);
  model_.expand_effects(parameters_);
  views_ = setup_views(campaign_, model_.binding(), model_.chain());
  for (std::size_t i = 0; i < measurements_.size(); ++i) {
    for (std::size_t setup = 0; setup < stretches_[i].count; ++setup)
      views_[stretches_[i].first + setup].is_path = measurements_[i].is_path;
  }
}

Campaign HypotheticalCampaign::extended(const Campaign& campaign) {
  Campaign all = campaign;
  for (ExtraMeasurement& measurement : measurements_) {
    stretches_.push_back({all.setups.size(), measurement.setups.size()});
    const std::size_t known_tools = campaign.machine.tools.size();
    const std::size_t first_tool = all.machine.tools.size();
    for (const Tool& tool : measurement.tools) all.machine.tools.push_back(tool);
    for (Setup setup : measurement.setups) {
      if (setup.tool >= known_tools) setup.tool += first_tool - known_tools;
      for (std::size_t channel = 0; channel < setup.readings.channels(); ++channel) {
        const std::string group = noise_group(setup, channel);
        if (std::ranges::find(noise_groups_, group) == noise_groups_.end()) noise_groups_.push_back(group);
      }
      all.setups.push_back(std::move(setup));
    }
  }
  return all;
}

/// Functions have the same coefficients in both; blocks are found by name.
void HypotheticalCampaign::map_parameters(const Campaign& campaign, const FitResult& result) {
  const ParameterLayout& layout = model_.layout();
  parameters_ = model_.initial_parameters();
  parameters_.head(layout.function_size) = result.parameters.head(layout.function_size);
  for (const ParameterBlock& block : layout.blocks) {
    const ParameterBlock* known = result.layout.find_block(block.name);
    if (known == nullptr || known->size() != block.size()) continue;
    parameters_.segment(block.offset, block.size()) = result.parameters.segment(known->offset, known->size());
  }
  const DatumSpace known_datum(result.layout, campaign.machine, result.parameters);
  datum_.emplace_back(layout, campaign_.machine, parameters_);
  const DatumSpace& datum = datum_.front();
  known_parameters_ = known_datum.size();
  place_.assign(static_cast<std::size_t>(datum.size()), -1);
  new_precision_ = Eigen::VectorXd::Zero(datum.size());
  for (const auto& function : datum.functions()) {
    for (int k = function.offset; k < function.offset + function.size(); ++k) {
      place_[static_cast<std::size_t>(k)] = k;
    }
  }
  const BlockPlaces known = reduced_places(result.layout, known_datum);
  for (const auto& block : datum.blocks()) {
    const ParameterBlock& source = layout.blocks[block.block];
    const auto found = known.find(source.name);
    for (int k = 0; k < block.size; ++k) {
      const int at = block.offset + k;
      if (found != known.end() && found->second.second == block.size) {
        place_[static_cast<std::size_t>(at)] = found->second.first + k;
      } else {
        const double sigma = source.prior_sigma[k] > 0.0 ? source.prior_sigma[k] : kWideNuisance;
        new_precision_[at] = 1.0 / (sigma * sigma);
      }
    }
  }
}

std::size_t HypotheticalCampaign::group_of(std::size_t setup, int channel) const {
  const std::string group = noise_group(campaign_.setups[setup], static_cast<std::size_t>(channel));
  return static_cast<std::size_t>(std::ranges::find(noise_groups_, group) - noise_groups_.begin());
}

/// Observations with the same run and channel follow each other in one sequence.
void HypotheticalCampaign::observe(std::size_t setup, Derivatives& derivatives, NoiseData& data) const {
  const Readings& readings = campaign_.setups[setup].readings;
  std::map<std::pair<std::int32_t, int>, std::size_t> sequence_of;
  RowJacobian row;
  MeasurementModel::DisturbanceRows disturbance;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    model_.linearize(setup, i, parameters_, row);
    model_.disturbance_rows(setup, i, parameters_, disturbance);
    const std::int32_t run = readings.run.empty() ? 0 : readings.run[i];
    for (int channel = 0; channel < row.channels; ++channel) {
      const auto [found, is_new] = sequence_of.try_emplace({run, channel}, data.sequences.size());
      if (is_new) data.sequences.push_back({{}, {}, {}, group_of(setup, channel)});
      continue_sequence(data.sequences[found->second], derivatives.model.size(), readings, i);
      data.sigma.push_back(model_.sigma(setup, i, channel, parameters_));
      data.length.push_back(views_[setup].length[static_cast<Eigen::Index>(i)]);
      derivatives.model.emplace_back(
          datum_.front().reduce_rows(dense_row(model_.layout(), row, channel).transpose()).transpose());
      derivatives.sensitivity.emplace_back(disturbance.row(channel).transpose());
    }
  }
}

std::vector<Eigen::Index> HypotheticalCampaign::new_parameters(const Derivatives& derivatives) const {
  std::vector<Eigen::Index> found;
  for (std::size_t k = 0; k < place_.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const auto moves = [at](const Eigen::VectorXd& each) { return each[at] != 0.0; };
    if (place_[k] < 0 && std::ranges::any_of(derivatives.model, moves)) found.push_back(at);
  }
  return found;
}

HypotheticalRows HypotheticalCampaign::rows(std::size_t measurement) const {
  const auto [first, count] = stretches_[measurement];
  HypotheticalRows out;
  Derivatives derivatives;
  for (std::size_t setup = first; setup < first + count; ++setup) observe(setup, derivatives, out.data);
  const auto size = static_cast<Eigen::Index>(derivatives.model.size());
  const std::vector<Eigen::Index> fresh = new_parameters(derivatives);
  out.model = Eigen::MatrixXd::Zero(size, known_parameters_);
  out.nuisance.resize(size, static_cast<Eigen::Index>(fresh.size()));
  out.sensitivity.resize(size, kDisturbances);
  for (Eigen::Index i = 0; i < size; ++i) {
    const Eigen::VectorXd& derivative = derivatives.model[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < place_.size(); ++k) {
      if (place_[k] >= 0) out.model(i, place_[k]) = derivative[static_cast<Eigen::Index>(k)];
    }
    out.nuisance.row(i) = derivative(fresh).transpose();
    out.sensitivity.row(i) = derivatives.sensitivity[static_cast<std::size_t>(i)].transpose();
  }
  out.nuisance_precision = new_precision_(fresh);
  return out;
}

Eigen::MatrixXd HypotheticalCampaign::columns(std::size_t measurement, const HypotheticalRows& rows,
                                              const Effect& effect, const Eigen::VectorXd& shape) const {
  const auto [first, count] = stretches_[measurement];
  const std::vector<EffectTerm> terms = effect.terms();
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(rows.sensitivity.rows(), static_cast<Eigen::Index>(effect.amplitudes().size()));
  Eigen::Index at = 0;
  for (std::size_t setup = first; setup < first + count; ++setup) {
    const Eigen::MatrixXd drivers = effect.drivers(views_[setup], shape);
    const Eigen::Index channels = model_.bound(setup).channels();
    for (Eigen::Index i = 0; i < drivers.rows() * channels; ++i, ++at) {
      for (std::size_t k = 0; k < terms.size(); ++k) {
        const int target = disturbance_of(terms[k].target, campaign_.machine);
        out(at, static_cast<Eigen::Index>(terms[k].amplitude)) +=
            drivers(i / channels, static_cast<Eigen::Index>(k)) * rows.sensitivity(at, target);
      }
    }
  }
  return out;
}

}  // namespace volcal
