#pragma once
/// Instruments: what a reading is as a function of the tool's pose and of nuisance parameters.
/// A new instrument is one file (an equation class and its schema) and one line in registry.cpp.

#include <ceres/jet.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/schema.h"
#include "volcal/model/kinematics/lanes.h"

namespace volcal {

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

/// Tool relative to workpiece at one reading. `point_w`: functional point in workpiece coordinates, m, errors
/// included. Rotations: small angles, rad, split by the side of the bed that causes them; their sum is the
/// orientation error of the tool relative to the workpiece.
template <class T>
struct ToolState {
  Vector3<T> point_w = Vector3<T>::Zero();
  Vector3<T> rotation_tool_side = Vector3<T>::Zero();
  Vector3<T> rotation_workpiece_side = Vector3<T>::Zero();
};
inline constexpr int kStateSize = 9;
inline constexpr int kMaxChannels = 3;
inline constexpr int kMaxLocalNuisance = 12;
using InstrumentJet = ceres::Jet<double, kStateSize + kMaxLocalNuisance>;

/// Parameters that a setup brings with it. Blocks of equal `name` in several setups are one block.
struct NuisanceBlock {
  std::string name;                 ///< unique and readable: "station P1", "S1: dead path"
  std::vector<std::string> labels;  ///< one per parameter: "x", "y", "z"
  std::vector<bool> is_angle;       ///< unit rad (or dimensionless) instead of m
  Eigen::VectorXd guess;
  Eigen::VectorXd prior_mean;
  Eigen::VectorXd prior_sigma;      ///< 0 = no prior
  bool weak_default_prior = false;  ///< the prior is ours, not the user's: stated in the result

  int size() const { return static_cast<int>(guess.size()); }
};

/// Derivatives of one row's channels: to the state (point, tool-side, workpiece-side rotation) and to the
/// row's local nuisance parameters.
struct Linearization {
  double predicted[kMaxChannels];
  double d_state[kMaxChannels][kStateSize];
  double d_nuisance[kMaxChannels][kMaxLocalNuisance];
};

/// ToolState of consecutive readings, side by side.
struct ToolStateLanes {
  Lanes point_w[3];
  Lanes rotation_tool_side[3];
  Lanes rotation_workpiece_side[3];
};

/// Component 0 to kStateSize - 1 of ToolStateLanes, in the order of ToolState.
template <class StateLanes>
auto& state_component(StateLanes& state, int number) {
  if (number < 3) return state.point_w[number];
  return number < 6 ? state.rotation_tool_side[number - 3] : state.rotation_workpiece_side[number - 6];
}

/// Linearization of consecutive readings, side by side.
class LinearizationLanes {
 public:
  /// `state_size`: kStateSize, or 3 where no channel depends on rotations.
  void resize(int channels, int state_size, int nuisance_size);
  int channels() const { return channels_; }
  int state_size() const { return state_size_; }
  int nuisance_size() const { return nuisance_size_; }
  Lanes& predicted(int channel) { return *from(channel); }
  const Lanes& predicted(int channel) const { return *from(channel); }
  /// The derivatives of a channel to the state stand one after another, and so do those to the nuisance.
  Lanes* d_state(int channel) { return from(channels_ + channel * state_size_); }
  const Lanes* d_state(int channel) const { return from(channels_ + channel * state_size_); }
  Lanes* d_nuisance(int channel) { return from(channels_ * (1 + state_size_) + channel * nuisance_size_); }
  const Lanes* d_nuisance(int channel) const {
    return from(channels_ * (1 + state_size_) + channel * nuisance_size_);
  }

 private:
  Lanes* from(int index) { return lanes_.data() + index; }
  const Lanes* from(int index) const { return lanes_.data() + index; }

  int channels_ = 0;
  int state_size_ = 0;
  int nuisance_size_ = 0;
  std::vector<Lanes> lanes_;
};

/// What an instrument needs to know of a setup before it can predict.
struct SetupContext {
  const Setup& setup;
  const Machine& machine;
  std::string campaign_file;                     ///< for messages
  std::vector<Eigen::Vector3d> nominal_point_w;  ///< per row, m

  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;
};

/// An instrument applied to one setup. Thread-safe after construction.
class BoundSetup {
 public:
  virtual ~BoundSetup() = default;

  int channels() const { return channels_; }
  const std::vector<NuisanceBlock>& nuisance() const { return nuisance_; }
  int local_nuisance_size() const { return local_size_; }
  /// Which parameters of the concatenated blocks row `row` uses, `local_nuisance_size()` indices.
  virtual void local_nuisance(std::size_t row, int* index) const;
  /// Length (m) that scales the per-metre part of the noise of a channel.
  virtual double noise_length(std::size_t row, int channel) const = 0;
  /// The same where the nuisance parameters of the row, as linearize() takes them, are known better than by
  /// their guesses: the length from a station follows where the station is found to stand.
  virtual double noise_length_at(std::size_t row, int channel, const double* /*nuisance*/) const {
    return noise_length(row, channel);
  }
  /// Constant part of a channel's noise from the noise table (m or rad).
  virtual double noise_constant(const Options& noise, int channel) const;

  virtual void predict(std::size_t row, const ToolState<double>& state, const double* nuisance,
                       double* predicted) const = 0;
  virtual void predict(std::size_t row, const ToolState<InstrumentJet>& state, const InstrumentJet* nuisance,
                       InstrumentJet* predicted) const = 0;
  virtual void linearize(std::size_t row, const ToolState<double>& state, const double* nuisance,
                         Linearization& out) const = 0;
  /// linearize() of rows first_row to first_row + count, which have the same nuisance parameters; lanes from
  /// `count` on are finite, nothing else is known of them. `out` has its size.
  virtual void linearize_lanes(std::size_t first_row, int count, const ToolStateLanes& state,
                               const double* nuisance, LinearizationLanes& out) const;
  /// Whether readings depend on the tool's rotation, besides the point that it moves.
  virtual bool sees_rotation() const { return false; }
  /// Whether the guesses of the nuisance parameters foresee sign and size of a channel's changes; where not,
  /// readings are not judged by them.
  virtual bool is_foreseen(int /*channel*/) const { return true; }

 protected:
  void set_channels(int channels) { channels_ = channels; }
  void add_nuisance(NuisanceBlock block);
  void set_local_nuisance_size(int size) { local_size_ = size; }

 private:
  int channels_ = 1;
  int local_size_ = 0;
  std::vector<NuisanceBlock> nuisance_;
};

/// Gives an equation class its double and Jet versions: `Equation` has a template
/// `void equation(std::size_t row, const ToolState<T>&, const T* nuisance, T* predicted) const`.
template <class Equation>
class EquationBase : public BoundSetup {
 public:
  void predict(std::size_t row, const ToolState<double>& state, const double* nuisance,
               double* predicted) const override {
    static_cast<const Equation*>(this)->equation(row, state, nuisance, predicted);
  }
  void predict(std::size_t row, const ToolState<InstrumentJet>& state, const InstrumentJet* nuisance,
               InstrumentJet* predicted) const override {
    static_cast<const Equation*>(this)->equation(row, state, nuisance, predicted);
  }
};

class Instrument {
 public:
  virtual ~Instrument() = default;
  virtual const InstrumentSchema& schema() const = 0;
  /// Throws InputError when the setup cannot be used; its place is the campaign file and setup.
  virtual std::unique_ptr<BoundSetup> bind(SetupContext context) const = 0;
};

}  // namespace volcal
