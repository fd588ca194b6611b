#include "volcal/identify/errors/driver_polynomials.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>

namespace volcal {
namespace {

constexpr std::array<double, DriverPolynomials::kDegree + 1> kPolynomialNodes = {-1.0, -0.5, 0.5, 1.0};
constexpr std::size_t kNodesOfAxis = kPolynomialNodes.size();
constexpr double kLeastTerm = 1e-14;  // of the largest coefficient

/// Coefficients of the powers from the values at the nodes.
Eigen::Matrix4d coefficients_of_values() {
  Eigen::Matrix4d powers;
  for (int i = 0; i < powers.rows(); ++i) {
    double power = 1.0;
    for (int k = 0; k < powers.cols(); ++k, power *= kPolynomialNodes[static_cast<std::size_t>(i)])
      powers(i, k) = power;
  }
  return powers.inverse();
}

/// Linear axes on whose position an effect depends.
std::vector<std::size_t> axes_of(const EffectReach& reach) {
  std::vector<std::size_t> axes;
  for (const AxisName axis : kAllAxes) {
    if (!is_rotary(axis) && reach.position[index_of(axis)]) axes.push_back(index_of(axis));
  }
  return axes;
}

std::vector<std::uint8_t> directions_of(const EffectReach& reach) {
  std::vector<std::uint8_t> axes;
  for (const AxisName axis : kAllAxes) {
    if (reach.direction[index_of(axis)]) axes.push_back(static_cast<std::uint8_t>(index_of(axis)));
  }
  return axes;
}

/// Number of a combination of directions, and back.
std::size_t combination_of(std::span<const std::uint8_t> axes, const ApproachDirection& direction) {
  std::size_t number = 0;
  for (const std::uint8_t axis : axes) number = 3 * number + static_cast<std::size_t>(direction[axis] + 1);
  return number;
}

ApproachDirection directions_of_combination(std::span<const std::uint8_t> axes, std::size_t number) {
  ApproachDirection direction{};
  for (std::size_t i = axes.size(); i-- > 0; number /= 3)
    direction[axes[i]] = static_cast<std::int8_t>(static_cast<int>(number % 3) - 1);
  return direction;
}

/// Applies the matrix to one index of a tensor with kNodesOfAxis values an index; `stride` of that index.
void transform_index(const Eigen::Matrix4d& matrix, std::size_t stride, Eigen::VectorXd& tensor) {
  const auto size = static_cast<std::size_t>(tensor.size());
  for (std::size_t outer = 0; outer < size; outer += stride * kNodesOfAxis) {
    for (std::size_t inner = 0; inner < stride; ++inner) {
      Eigen::Map<Eigen::Vector4d, 0, Eigen::InnerStride<>> line(
          tensor.data() + outer + inner, Eigen::InnerStride<>(static_cast<Eigen::Index>(stride)));
      line = (matrix * line).eval();
    }
  }
}

}  // namespace

std::vector<std::size_t> DriverPolynomials::held_by(const MachineEffects& effects) {
  std::vector<std::size_t> held;
  for (const std::size_t effect : effects.numbers()) {
    if (effects.is_polynomial(effect) && axes_of(effects.reach(effect)).size() <= kMostAxes)
      held.push_back(effect);
  }
  return held;
}

DriverPolynomials::DriverPolynomials(const MachineEffects& effects, const Machine& machine) {
  for (const std::size_t effect : effects.numbers()) {
    for (const std::size_t a : axes_of(effects.reach(effect))) {
      if (std::ranges::find(scales_, a, &Scale::axis) != scales_.end()) continue;
      const Axis& axis = machine.axis(kAllAxes[a]);
      scales_.push_back({a, axis.home, axis.travel() > 0.0 ? 2.0 / axis.travel() : 1.0});
    }
  }
  for (const std::size_t effect : effects.numbers()) add(effects, effect);
}

/// Positions at all combinations of the nodes of these axes, the first fastest; other axes at 0.
std::vector<AxisPosition> DriverPolynomials::node_positions(std::span<const std::size_t> axes) const {
  std::vector<AxisPosition> positions = {AxisPosition{}};
  for (const std::size_t axis : axes) {
    const Scale& scale = *std::ranges::find(scales_, axis, &Scale::axis);
    std::vector<AxisPosition> more;
    for (const double node : kPolynomialNodes) {
      for (AxisPosition position : positions) {
        position[axis] = scale.origin + node / scale.per_unit;
        more.push_back(position);
      }
    }
    positions = std::move(more);
  }
  return positions;
}

/// The polynomial through the drivers at node_positions() of as many axes.
void DriverPolynomials::add_terms(std::size_t axes, Eigen::VectorXd tensor) {
  std::size_t stride = 1;
  for (std::size_t i = 0; i < axes; ++i, stride *= kNodesOfAxis)
    transform_index(coefficients_of_values(), stride, tensor);
  const double least = kLeastTerm * tensor.cwiseAbs().maxCoeff();
  for (Eigen::Index place = 0; place < tensor.size(); ++place) {
    if (std::abs(tensor[place]) <= least) continue;
    Term term{tensor[place], {}};
    auto rest = static_cast<std::size_t>(place);
    for (std::size_t i = 0; i < axes; ++i, rest /= kNodesOfAxis)
      term.power[i] = static_cast<std::uint8_t>(rest % kNodesOfAxis);
    terms_.push_back(term);
  }
}

/// One effect's drivers, in the order of its amplitudes.
void DriverPolynomials::add(const MachineEffects& all, std::size_t number) {
  const MachineEffects effect = all.subset({&number, 1});
  const std::vector<std::size_t> axes = axes_of(all.reach(number));
  Driver form;
  for (std::size_t i = 0; i < axes.size(); ++i) form.axes[i] = static_cast<std::uint8_t>(axes[i]);
  form.directions = directions_of(all.reach(number));
  std::size_t combinations = 1;
  for (std::size_t i = 0; i < form.directions.size(); ++i) combinations *= 3;
  const std::vector<AxisPosition> positions = node_positions(axes);
  std::vector<Eigen::MatrixXd> values;
  for (std::size_t combination = 0; combination < combinations; ++combination) {
    const ApproachDirection direction = directions_of_combination(form.directions, combination);
    values.push_back(effect.drivers(positions, {&direction, 1}));
  }
  for (std::size_t c = 0; c < effect.amplitude_count(); ++c) {
    Driver& driver = drivers_.emplace_back(form);
    for (const Eigen::MatrixXd& of_combination : values) {
      driver.first_term.push_back(static_cast<std::uint32_t>(terms_.size()));
      add_terms(axes.size(), of_combination.col(static_cast<Eigen::Index>(c)));
    }
    driver.first_term.push_back(static_cast<std::uint32_t>(terms_.size()));
  }
}

DriverPolynomials::Powers DriverPolynomials::powers_at(const AxisPosition& position) const {
  Powers powers;
  powers[0][0] = 1.0;  // where a driver depends on fewer axes, its powers of the first are 0
  for (const Scale& scale : scales_) {
    const double t = (position[scale.axis] - scale.origin) * scale.per_unit;
    powers[scale.axis] = {1.0, t, t * t, t * t * t};
  }
  return powers;
}

double DriverPolynomials::driver(std::size_t amplitude, const Powers& powers,
                                 const ApproachDirection& direction) const {
  const Driver& driver = drivers_[amplitude];
  const std::size_t combination = combination_of(driver.directions, direction);
  double sum = 0.0;
  for (std::uint32_t i = driver.first_term[combination]; i < driver.first_term[combination + 1]; ++i) {
    const Term& term = terms_[i];
    sum += term.factor * powers[driver.axes[0]][term.power[0]] * powers[driver.axes[1]][term.power[1]] *
           powers[driver.axes[2]][term.power[2]];
  }
  return sum;
}

}  // namespace volcal
