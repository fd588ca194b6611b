#pragma once
/// Effects of a result that act on the machine itself, evaluated at poses: what their amplitudes add to error
/// motions and to the tool's offset. Drivers are those of the catalogue (model/effects), asked for at the
/// stated conditions; effects on stations, the floor or readings belong to the measurement and are not here.
///
/// An effect that acts in several places with one amplitude is here one effect a place, all with the same
/// parameters.
///
/// At direction of approach 0 a driver is the mean of both directions. A temperature that an effect follows
/// late stands at its stated value long enough for the lag to be over.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/pose.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// What the driver of an effect varies with, found by varying one at a time over the travel; of a curve or
/// surface all that it is drawn over.
struct EffectReach {
  bool acts = false;  ///< not 0 at every pose and condition
  std::array<bool, kAxisCount> position{};
  std::array<bool, kAxisCount> direction{};
  std::set<std::string> temperature;  ///< channels
  bool time = false;
  bool feed = false;

  int positions() const;  ///< number of axes on whose position it depends
  std::vector<Variable> variables() const;
};

/// A parameter of an effect and what it acts on. `shape`: derivative to a parameter of the shape.
struct EffectColumn {
  std::size_t effect = 0;
  int amplitude = 0;
  int shape = -1;  ///< -1: the amplitude itself
  EffectTarget target;
  int parameter = 0;            ///< of the result
  int amplitude_parameter = 0;  ///< the same for an amplitude
};

/// What a curve or surface that has faded out may still be.
struct FadedSurface {
  std::size_t effect = 0;
  EffectTarget target;
  double u = 0.0;  ///< of the target, m or rad
};

class MachineEffects {
 public:
  /// Copies what it needs of `result`.
  MachineEffects(const FitResult& result, const Tool& tool, const Conditions& conditions);

  bool empty() const { return columns_.empty(); }
  /// All amplitudes first, then derivatives to shapes.
  const std::vector<EffectColumn>& columns() const { return columns_; }
  std::size_t amplitude_count() const { return amplitude_count_; }
  const EffectName& name(std::size_t effect) const;
  const std::string& label(std::size_t effect) const;
  const EffectReach& reach(std::size_t effect) const;
  std::size_t effect_count() const;
  /// Numbers of the effects that are asked for here: of a subset() those of the subset.
  std::span<const std::size_t> numbers() const { return used_; }
  /// A curve or surface without a name, which fades out beyond its readings.
  bool is_surface(std::size_t effect) const;
  /// EffectSchema::polynomial of its kind.
  bool is_polynomial(std::size_t effect) const;

  /// Drivers, poses x amplitudes; `direction` holds one entry for all poses or one each.
  Eigen::MatrixXd drivers(std::span<const AxisPosition> positions,
                          std::span<const ApproachDirection> directions) const;
  /// What curves and surfaces have lost where they fade out beyond their readings, poses x amplitudes:
  /// drivers with the last value held, less drivers(). Empty where no pose is beyond.
  Eigen::MatrixXd faded_drivers(std::span<const AxisPosition> positions,
                                std::span<const ApproachDirection> directions) const;
  /// Standard uncertainties that come of it at one pose: by the curve's or surface's last value, or by its
  /// root mean square where that is more.
  std::vector<FadedSurface> faded_surfaces(const AxisPosition& position,
                                           const ApproachDirection& direction) const;
  /// Drivers and slopes of the drivers to the parameters of the shape: poses x columns.
  Eigen::MatrixXd drivers_and_slopes(std::span<const AxisPosition> positions,
                                     std::span<const ApproachDirection> directions) const;

  /// The effects of these numbers alone.
  MachineEffects subset(std::span<const std::size_t> effects) const;

 private:
  struct Shared;
  Eigen::MatrixXd at_given_directions(std::span<const AxisPosition> positions,
                                      std::span<const ApproachDirection> directions, bool slopes) const;
  Eigen::MatrixXd evaluate(std::span<const AxisPosition> positions,
                           std::span<const ApproachDirection> directions, bool slopes) const;

  std::shared_ptr<const Shared> shared_;
  std::vector<EffectColumn> columns_;
  std::size_t amplitude_count_ = 0;
  std::vector<std::size_t> used_;  ///< numbers of the effects
  std::array<bool, kAxisCount>
      uneven_in_direction_{};  ///< the mean of both directions is not the driver at 0
};

/// An effect of the model that acts on no pose: it needs a path or a setup, as a following error on circles.
struct EffectOnNoPose {
  std::string label;
  std::set<Variable> conditions;  ///< that drive it
};
std::vector<EffectOnNoPose> effects_on_no_pose(const FitResult& result);

}  // namespace volcal
