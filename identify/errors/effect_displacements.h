#pragma once
/// Displacements of the tool that effects on linear axes or the tool make, rotary axes at 0: amplitude x
/// driver x lever, the lever being the displacement by one unit of what the effect acts on.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "volcal/identify/errors/driver_polynomials.h"
#include "volcal/identify/errors/machine_effects.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

class EffectDisplacements {
 public:
  /// Keeps what it needs of all that is given.
  EffectDisplacements(const FitResult& result, const KinematicChain& chain, const Tool& tool,
                      const MachineEffects& effects);

  bool empty() const { return effects_.empty(); }
  const MachineEffects& effects() const { return effects_; }

  /// `held`: the position at which drivers are asked for, within what was measured.
  Eigen::Vector3d at(const AxisPosition& position, const AxisPosition& held,
                     const ApproachDirection& direction) const;
  /// Displacements per unit of every amplitude, one matrix per position, m per unit.
  std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> units(
      std::span<const AxisPosition> positions, std::span<const AxisPosition> held,
      std::span<const ApproachDirection> directions) const;

 private:
  /// Linear in the positions of the linear axes.
  struct Lever {
    Eigen::Vector3d at_zero;
    std::vector<std::pair<std::size_t, Eigen::Vector3d>> per_metre;  ///< of the axes on which it depends

    Eigen::Vector3d at(const AxisPosition& position) const {
      Eigen::Vector3d lever = at_zero;
      for (const auto& [axis, change] : per_metre) lever += position[axis] * change;
      return lever;
    }
  };
  /// An amplitude's value and what it moves.
  struct Part {
    double amplitude;
    Lever lever;
  };

  static Lever lever_of(const KinematicChain& chain, const Tool& tool, const EffectTarget& target);
  static std::vector<Part> parts_of(const FitResult& result, const KinematicChain& chain, const Tool& tool,
                                    const MachineEffects& effects);

  MachineEffects effects_, others_;  ///< all; those whose drivers are not held as polynomials
  DriverPolynomials polynomials_;
  std::vector<Part> parts_, polynomial_parts_, other_parts_;  ///< by amplitude
};

}  // namespace volcal
