#include "volcal/identify/solve/normals/stated_sigma.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/model/description/errors.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

constexpr double kWorthRenewing = 0.01;  // relative change of a standard deviation

void state(const ReadingIndex& index, std::size_t setup, const Eigen::VectorXd& parameters, bool estimated,
           std::vector<double>& sigma) {
  const MeasurementModel& model = index.model();
  const Setup& source = model.campaign().setups[setup];
  for (std::size_t row = 0; row < source.readings.size(); ++row) {
    for (int channel = 0; channel < model.bound(setup).channels(); ++channel) {
      const double value = model.sigma(setup, row, channel, parameters, estimated);
      if (!(value > 0.0)) {
        throw InputError({model.campaign().file, source.source_line},
                         "setup \"" + source.name + "\": the standard deviation of its readings is zero",
                         "give noise = { constant_um = ... } or a sigma_um column");
      }
      sigma[index.first_observation(setup, row) + static_cast<std::size_t>(channel)] = value;
    }
  }
}

}  // namespace

std::vector<double> stated_sigma(const ReadingIndex& index, const Eigen::VectorXd& parameters) {
  std::vector<double> sigma(index.observations());
  for (std::size_t setup = 0; setup < index.model().campaign().setups.size(); ++setup) {
    state(index, setup, parameters, false, sigma);
  }
  return sigma;
}

bool renew_sigma_of_angles(const ReadingIndex& index, const Eigen::VectorXd& parameters,
                           std::vector<double>& sigma) {
  const std::vector<std::vector<bool>> is_angle = angle_channels(index.model().campaign());
  bool any = false;
  for (std::size_t setup = 0; setup < is_angle.size(); ++setup) {
    if (std::ranges::find(is_angle[setup], true) == is_angle[setup].end()) continue;
    state(index, setup, parameters, false, sigma);
    any = true;
  }
  return any;
}

bool renew_sigma_of_lengths(const ReadingIndex& index, const Eigen::VectorXd& parameters,
                            std::vector<double>& sigma) {
  std::vector<double> renewed(sigma.size());
  for (std::size_t setup = 0; setup < index.model().campaign().setups.size(); ++setup)
    state(index, setup, parameters, true, renewed);
  bool differs = false;
  for (std::size_t i = 0; i < sigma.size(); ++i)
    differs = differs || std::abs(renewed[i] - sigma[i]) > kWorthRenewing * sigma[i];
  if (differs) sigma = std::move(renewed);
  return differs;
}

}  // namespace volcal
