#include "volcal/identify/montecarlo/draw_gradients.h"

#include <algorithm>
#include <span>

namespace volcal {
namespace {

constexpr auto kDraws = static_cast<std::size_t>(DrawGradients::kDraws);

}  // namespace

DrawGradients::DrawGradients(const BlockModel& model, const Whitener& whitener)
    : model_(model), whitener_(whitener), states_(model) {}

DrawGradients::Workspace::Workspace(const DrawGradients& gradients)
    : values(gradients.states_),
      sums(gradients.states_),
      seen(kDraws),
      readings(kDraws * gradients.model_.blocks().size()) {}

Eigen::MatrixXd DrawGradients::at(const Eigen::MatrixXd& parameters, const Eigen::MatrixXd& readings,
                                  Workspace& work) const {
  states_.set_parameters(parameters, work.values);
  for (std::size_t b = 0; b < model_.blocks().size(); ++b) predict(b, parameters, work);
  take_errors(readings, work);
  work.sums.set_zero();
  Eigen::Index observation = 0;
  for (std::size_t b = 0; b < model_.blocks().size(); ++b) {
    add_loads(b, observation, work);
    observation += Eigen::Index{model_.blocks()[b].size} * work.readings[b * kDraws].channels();
  }
  return states_.gradients(work.sums).leftCols(parameters.cols());
}

void DrawGradients::predict(std::size_t block, const Eigen::MatrixXd& parameters, Workspace& work) const {
  states_.find(block, work.values, work.seen.data());
  const bool has_offsets = !model_.model().binding().effects.empty();
  for (std::size_t k = 0; k < kDraws; ++k) {
    LinearizationLanes& reading = work.readings[block * kDraws + k];
    const Eigen::Index column = std::min(static_cast<Eigen::Index>(k), parameters.cols() - 1);
    model_.measure(model_.blocks()[block], parameters.col(column), work.seen[k].tool, reading);
    for (int channel = 0; channel < reading.channels() && has_offsets; ++channel)
      add_scaled(work.seen[k].offset[channel], 1.0, reading.predicted(channel));
  }
}

/// Weighted errors of all readings, a column per draw.
void DrawGradients::take_errors(const Eigen::MatrixXd& readings, Workspace& work) const {
  work.errors = -readings;
  for (Eigen::Index k = 0; k < readings.cols(); ++k) {
    double* error = work.errors.col(k).data();
    for (std::size_t b = 0; b < model_.blocks().size(); ++b) {
      const LinearizationLanes& reading = work.readings[b * kDraws + static_cast<std::size_t>(k)];
      for (int i = 0; i < model_.blocks()[b].size; ++i) {
        for (int channel = 0; channel < reading.channels(); ++channel)
          *error++ += reading.predicted(channel)[i];
      }
    }
    work.errors.col(k) = whitener_.weigh(work.errors.col(k));
  }
}

/// What the errors of a block's readings do on the tool, on the readings and on parameters of their own.
void DrawGradients::add_loads(std::size_t block, Eigen::Index first_observation, Workspace& work) const {
  const ReadingBlock& place = model_.blocks()[block];
  const std::span<const int> nuisance = model_.nuisance_of(place);
  for (Eigen::Index k = 0; k < work.errors.cols(); ++k) {
    const LinearizationLanes& reading = work.readings[block * kDraws + static_cast<std::size_t>(k)];
    StateMap::Seen& load = work.seen[static_cast<std::size_t>(k)];
    for (int c = 0; c < reading.state_size(); ++c) state_component(load.tool, c).fill(0.0);
    for (int channel = 0; channel < reading.channels(); ++channel) {
      Lanes& error = load.offset[channel];
      error.fill(0.0);
      for (int i = 0; i < place.size; ++i)
        error[i] = work.errors(first_observation + Eigen::Index{i} * reading.channels() + channel, k);
      for (int c = 0; c < reading.state_size(); ++c)
        add_product(error, reading.d_state(channel)[c], state_component(load.tool, c));
      for (std::size_t n = 0; n < nuisance.size(); ++n)
        work.sums.of_parameter(nuisance[n]).value[k] += dot(error, reading.d_nuisance(channel)[n]);
    }
  }
  states_.add_work(block, work.seen.data(), work.sums);
}

}  // namespace volcal
