#pragma once
/// Drivers of effects that are polynomials in the positions of the linear axes (EffectSchema::polynomial),
/// for one pose at a time: the same numbers as MachineEffects::drivers() but for rounding, without its
/// matrices.
///
/// The position of an axis is counted from its home in units of half its travel. Four nodes an axis determine
/// at most cubic polynomials; terms below rounding are left out, so that a product of two positions is one.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "volcal/identify/errors/machine_effects.h"
#include "volcal/model/description/machine.h"

namespace volcal {

class DriverPolynomials {
 public:
  static constexpr int kDegree = 3;  ///< in each position
  static constexpr std::size_t kMostAxes = 3;

  /// Effects, by number, of `effects` whose drivers are held here, rotary axes at 0: of declared polynomials
  /// those that depend on three linear axes at most.
  static std::vector<std::size_t> held_by(const MachineEffects& effects);

  /// `effects`: all of held_by().
  DriverPolynomials(const MachineEffects& effects, const Machine& machine);

  using Powers = std::array<std::array<double, kDegree + 1>, kAxisCount>;
  /// What the drivers at a position share.
  Powers powers_at(const AxisPosition& position) const;
  /// The driver of an amplitude, by its number in `effects`.
  double driver(std::size_t amplitude, const Powers& powers, const ApproachDirection& direction) const;

 private:
  struct Term {
    double factor;
    std::array<std::uint8_t, kMostAxes> power;
  };
  /// Of one amplitude; terms of one combination of directions after another.
  struct Driver {
    std::array<std::uint8_t, kMostAxes> axes{};  ///< of the powers
    std::vector<std::uint8_t> directions;        ///< axes on whose direction it depends
    std::vector<std::uint32_t> first_term;
  };
  struct Scale {
    std::size_t axis;
    double origin;    ///< m
    double per_unit;  ///< 1/m
  };

  void add(const MachineEffects& effects, std::size_t effect);
  std::vector<AxisPosition> node_positions(std::span<const std::size_t> axes) const;
  void add_terms(std::size_t axes, Eigen::VectorXd tensor);

  std::vector<Scale> scales_;  ///< of the axes on which a driver depends
  std::vector<Driver> drivers_;
  std::vector<Term> terms_;
};

}  // namespace volcal
