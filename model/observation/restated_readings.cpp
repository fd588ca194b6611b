#include "volcal/model/observation/restated_readings.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "volcal/model/instruments/instrument.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/model/kinematics/chain.h"
#include "volcal/model/observation/campaign_binding.h"

namespace volcal {
namespace {

/// The instrument of a setup with the nominal tool points of one offset.
class SetupAtOffset {
 public:
  SetupAtOffset(const Instrument& instrument, const Machine& machine, const std::string& campaign_file,
                const Eigen::Vector3d& offset, const Setup& setup) {
    const KinematicChain chain(machine);
    SetupContext context{setup, machine, campaign_file, {}};
    for (std::size_t row = 0; row < setup.readings.size(); ++row)
      points_w_.push_back(chain.nominal_point_w(setup.readings.commanded_position(row), offset));
    context.nominal_point_w = points_w_;
    bound_ = instrument.bind(std::move(context));
  }

  const Eigen::Vector3d& point_w(std::size_t row) const { return points_w_[row]; }
  int channels() const { return bound_->channels(); }

  /// All nuisance parameters at their guesses, in the order of the blocks.
  std::vector<double> guesses() const {
    std::vector<double> values;
    for (const NuisanceBlock& block : bound_->nuisance())
      values.insert(values.end(), block.guess.begin(), block.guess.end());
    return values;
  }

  std::array<double, kMaxChannels> reading(std::size_t row, const Eigen::Vector3d& point_w,
                                           const std::vector<double>& nuisance) const {
    std::array<int, kMaxLocalNuisance> index{};
    bound_->local_nuisance(row, index.data());
    std::array<double, kMaxLocalNuisance> local{};
    for (int k = 0; k < bound_->local_nuisance_size(); ++k) {
      const auto place = static_cast<std::size_t>(k);
      local[place] = nuisance[static_cast<std::size_t>(index[place])];
    }
    ToolState<double> state;
    state.point_w = point_w;
    std::array<double, kMaxChannels> predicted{};
    bound_->predict(row, state, local.data(), predicted.data());
    return predicted;
  }

 private:
  std::vector<Eigen::Vector3d> points_w_;
  std::unique_ptr<BoundSetup> bound_;
};

}  // namespace

void restate_readings(const Machine& machine, const std::string& campaign_file, const Eigen::Vector3d& former,
                      const Eigen::Vector3d& stated, Setup& setup) {
  const Instrument* instrument = find_instrument(setup.instrument);
  if (instrument == nullptr || setup.readings.size() == 0) return;
  const SetupAtOffset before(*instrument, machine, campaign_file, former, setup);
  const SetupAtOffset after(*instrument, machine, campaign_file, stated, setup);
  const std::vector<double> nuisance = before.guesses();
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    const auto counted_before = before.reading(row, before.point_w(row), nuisance);
    const auto counted_after = after.reading(row, before.point_w(row), nuisance);
    for (std::size_t channel = 0; channel < static_cast<std::size_t>(before.channels()); ++channel)
      setup.readings.value[channel][row] += counted_after[channel] - counted_before[channel];
  }
}

}  // namespace volcal
