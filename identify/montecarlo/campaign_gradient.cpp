#include "volcal/identify/montecarlo/campaign_gradient.h"

#include <algorithm>
#include <map>

namespace volcal {

CampaignGradient::CampaignGradient(const MeasurementModel& model, const Whitener& whitener)
    : model_(model), whitener_(whitener) {
  for (const FunctionGroup& group : model.layout().groups)
    functions_ += static_cast<std::size_t>(group.count());
  number_positions();
  RowJacobian row;
  const Eigen::VectorXd parameters = model.initial_parameters();
  std::uint32_t reading = 0;
  const auto& setups = model.campaign().setups;
  for (std::size_t setup = 0; setup < setups.size(); ++setup) {
    for (std::size_t r = 0; r < setups[setup].readings.size(); ++r, ++reading) {
      model.linearize(setup, r, parameters, row);
      for (int channel = 0; channel < row.channels; ++channel) {
        reading_of_.push_back(reading);
        tail_begin_.push_back(static_cast<std::uint32_t>(tail_index_.size()));
        tail_index_.insert(tail_index_.end(), row.tail_index.begin(), row.tail_index.end());
      }
    }
  }
  tail_begin_.push_back(static_cast<std::uint32_t>(tail_index_.size()));
}

/// The different positions of every group's axis, their basis values, and which one a reading stands at.
void CampaignGradient::number_positions() {
  const auto& setups = model_.campaign().setups;
  const auto& groups = model_.layout().groups;
  std::size_t readings = 0;
  for (const Setup& setup : setups) readings += setup.readings.size();
  position_.resize(readings * groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const FunctionGroup& group = groups[g];
    Group& own = groups_.emplace_back();
    own.gathered = gathered_size_;
    std::map<double, std::size_t> number_of;
    std::vector<double> values(static_cast<std::size_t>(group.basis->support()));
    std::size_t reading = 0;
    for (const Setup& setup : setups) {
      for (const double q : setup.readings.position[index_of(group.axis)]) {
        const auto [found, is_new] = number_of.try_emplace(q, own.start.size());
        if (is_new) {
          own.start.push_back(group.basis->evaluate(q, values.data()));
          own.basis.insert(own.basis.end(), values.begin(), values.end());
        }
        position_[reading++ * groups.size() + g] = static_cast<std::uint32_t>(
            own.gathered + found->second * static_cast<std::size_t>(group.count()));
      }
    }
    gathered_size_ += own.start.size() * static_cast<std::size_t>(group.count());
  }
}

void CampaignGradient::linearise(const Eigen::VectorXd& parameters, const Eigen::VectorXd& readings,
                                 Workspace& work) const {
  const TabulatedFunctions tabulated = model_.tabulate(parameters);
  const auto& setups = model_.campaign().setups;
  work.errors.resize(readings.size());
  work.motion_weight.resize(reading_of_.size() * functions_);
  work.tail_value.resize(tail_index_.size());
  double* weight = work.motion_weight.data();
  double* tail = work.tail_value.data();
  Eigen::Index observation = 0;
  for (std::size_t setup = 0; setup < setups.size(); ++setup) {
    for (std::size_t r = 0; r < setups[setup].readings.size(); ++r) {
      model_.linearize(setup, r, parameters, work.row, &tabulated);
      for (int channel = 0; channel < work.row.channels; ++channel, ++observation) {
        work.errors[observation] = work.row.predicted[channel] - readings[observation];
        weight = std::copy_n(work.row.weight[channel].data(), functions_, weight);
        tail = std::copy(work.row.tail_value[channel].begin(), work.row.tail_value[channel].end(), tail);
      }
    }
  }
}

/// Adds every observation's weighted error to the sums of its positions, and to the other parameters.
void CampaignGradient::gather(Workspace& work, Eigen::VectorXd& gradient) const {
  const auto& groups = model_.layout().groups;
  work.gathered.assign(gathered_size_, 0.0);
  const double* weight = work.motion_weight.data();
  for (std::size_t i = 0; i < reading_of_.size(); ++i) {
    const double error = work.errors[static_cast<Eigen::Index>(i)];
    const std::uint32_t* position = position_.data() + reading_of_[i] * groups.size();
    for (std::size_t g = 0; g < groups.size(); ++g) {
      double* const sums = work.gathered.data() + position[g];
      const auto count = static_cast<std::size_t>(groups[g].count());
      for (std::size_t slot = 0; slot < count; ++slot) sums[slot] += error * weight[slot];
      weight += count;
    }
    for (std::uint32_t t = tail_begin_[i]; t < tail_begin_[i + 1]; ++t)
      gradient[tail_index_[t]] += error * work.tail_value[t];
  }
}

/// From the sums per position to those per coefficient.
void CampaignGradient::spread(const Workspace& work, Eigen::VectorXd& gradient) const {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const FunctionGroup& group = model_.layout().groups[g];
    const int support = group.basis->support(), count = group.count();
    const double* sums = work.gathered.data() + groups_[g].gathered;
    const double* basis = groups_[g].basis.data();
    for (const int start : groups_[g].start) {
      for (int j = 0; j < support; ++j) {
        for (int slot = 0; slot < count; ++slot)
          gradient[group.index(start + j, slot)] += basis[j] * sums[slot];
      }
      sums += count;
      basis += support;
    }
  }
}

Eigen::VectorXd CampaignGradient::at(const Eigen::VectorXd& parameters, const Eigen::VectorXd& readings,
                                     Workspace& work) const {
  linearise(parameters, readings, work);
  work.errors = whitener_.weigh(work.errors);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(parameters.size());
  gather(work, gradient);
  spread(work, gradient);
  return gradient;
}

}  // namespace volcal
