#include "volcal/model/instruments/instrument.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "volcal/model/description/errors.h"

namespace volcal {

void SetupContext::fail(const std::string& problem, const std::string& remedy) const {
  throw InputError({campaign_file, setup.source_line}, "setup \"" + setup.name + "\": " + problem, remedy);
}

void BoundSetup::local_nuisance(std::size_t /*row*/, int* index) const {
  std::iota(index, index + local_size_, 0);
}

void BoundSetup::linearize_lanes(std::size_t first_row, int count, const ToolStateLanes& state,
                                 const double* nuisance, LinearizationLanes& out) const {
  ToolState<double> tool;
  Linearization reading;
  for (int i = 0; i < kLanes; ++i) {
    for (int k = 0; k < 3; ++k) {
      tool.point_w[k] = state.point_w[k][i];
      tool.rotation_tool_side[k] = state.rotation_tool_side[k][i];
      tool.rotation_workpiece_side[k] = state.rotation_workpiece_side[k][i];
    }
    linearize(first_row + static_cast<std::size_t>(std::min(i, count - 1)), tool, nuisance, reading);
    for (int channel = 0; channel < out.channels(); ++channel) {
      out.predicted(channel)[i] = reading.predicted[channel];
      for (int k = 0; k < out.state_size(); ++k) out.d_state(channel)[k][i] = reading.d_state[channel][k];
      for (int k = 0; k < out.nuisance_size(); ++k)
        out.d_nuisance(channel)[k][i] = reading.d_nuisance[channel][k];
    }
  }
}

void LinearizationLanes::resize(int channels, int state_size, int nuisance_size) {
  channels_ = channels;
  state_size_ = state_size;
  nuisance_size_ = nuisance_size;
  const int lanes = channels * (1 + state_size + nuisance_size);
  lanes_.resize(static_cast<std::size_t>(lanes));
}

double BoundSetup::noise_constant(const Options& noise, int /*channel*/) const {
  return noise.number("constant").value_or(0.0);
}

void BoundSetup::add_nuisance(NuisanceBlock block) {
  local_size_ += block.size();
  nuisance_.push_back(std::move(block));
}

}  // namespace volcal
