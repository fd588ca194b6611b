#include "volcal/identify/errors/effect_displacements.h"

#include <algorithm>

namespace volcal {

using Eigen::Vector3d;

namespace {

MachineEffects held_as_polynomials(const MachineEffects& effects) {
  return effects.subset(DriverPolynomials::held_by(effects));
}

MachineEffects not_held(const MachineEffects& effects) {
  const std::vector<std::size_t> held = DriverPolynomials::held_by(effects);
  std::vector<std::size_t> others;
  for (const std::size_t effect : effects.numbers()) {
    if (std::ranges::find(held, effect) == held.end()) others.push_back(effect);
  }
  return effects.subset(others);
}

}  // namespace

EffectDisplacements::EffectDisplacements(const FitResult& result, const KinematicChain& chain,
                                         const Tool& tool, const MachineEffects& effects)
    : effects_(effects),
      others_(not_held(effects)),
      polynomials_(held_as_polynomials(effects), result.machine),
      parts_(parts_of(result, chain, tool, effects)),
      polynomial_parts_(parts_of(result, chain, tool, held_as_polynomials(effects))),
      other_parts_(parts_of(result, chain, tool, others_)) {}

EffectDisplacements::Lever EffectDisplacements::lever_of(const KinematicChain& chain, const Tool& tool,
                                                         const EffectTarget& target) {
  const auto at = [&](const AxisPosition& position) -> Vector3d {
    if (target.kind == TargetKind::ToolOffset) return Vector3d::Unit(target.component);
    if (target.kind != TargetKind::Motion || is_rotary(target.symbol.axis)) return Vector3d::Zero();
    JointLever levers[kAxisCount];
    chain.levers(position, tool.offset, levers);
    return KinematicChain::motion_lever_w(joint_lever(levers, chain.joint_count(), target.symbol.axis),
                                          target.symbol.component);
  };
  Lever lever{at({}), {}};
  for (const AxisName axis : kAllAxes) {
    if (is_rotary(axis)) continue;
    AxisPosition a_metre_on{};
    a_metre_on[index_of(axis)] = 1.0;
    const Vector3d change = at(a_metre_on) - lever.at_zero;
    if (!change.isZero(0.0)) lever.per_metre.emplace_back(index_of(axis), change);
  }
  return lever;
}

std::vector<EffectDisplacements::Part> EffectDisplacements::parts_of(const FitResult& result,
                                                                     const KinematicChain& chain,
                                                                     const Tool& tool,
                                                                     const MachineEffects& effects) {
  std::vector<Part> parts;
  for (std::size_t c = 0; c < effects.amplitude_count(); ++c) {
    const EffectColumn& column = effects.columns()[c];
    parts.push_back({result.parameters[column.parameter], lever_of(chain, tool, column.target)});
  }
  return parts;
}

Vector3d EffectDisplacements::at(const AxisPosition& position, const AxisPosition& held,
                                 const ApproachDirection& direction) const {
  Vector3d displacement = Vector3d::Zero();
  if (!polynomial_parts_.empty()) {
    const DriverPolynomials::Powers powers = polynomials_.powers_at(held);
    for (std::size_t c = 0; c < polynomial_parts_.size(); ++c) {
      const Part& part = polynomial_parts_[c];
      displacement += part.amplitude * polynomials_.driver(c, powers, direction) * part.lever.at(position);
    }
  }
  if (other_parts_.empty()) return displacement;
  const Eigen::MatrixXd drivers = others_.drivers({&held, 1}, {&direction, 1});
  for (std::size_t c = 0; c < other_parts_.size(); ++c) {
    const Part& part = other_parts_[c];
    displacement += part.amplitude * drivers(0, static_cast<Eigen::Index>(c)) * part.lever.at(position);
  }
  return displacement;
}

std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> EffectDisplacements::units(
    std::span<const AxisPosition> positions, std::span<const AxisPosition> held,
    std::span<const ApproachDirection> directions) const {
  const Eigen::MatrixXd drivers = effects_.drivers(held, directions);
  std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> units;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    auto& of_pose = units.emplace_back(3, drivers.cols());
    for (Eigen::Index c = 0; c < drivers.cols(); ++c)
      of_pose.col(c) = drivers(static_cast<Eigen::Index>(i), c) *
                       parts_[static_cast<std::size_t>(c)].lever.at(positions[i]);
  }
  return units;
}

}  // namespace volcal
