#include "volcal/identify/errors/rigid_compromise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using Columns3 = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// Gauss-Legendre, 12 points on -1..1: positive nodes and their weights (Abramowitz and Stegun, Table 25.4).
constexpr std::array<double, 6> kNodes = {0.125233408511468915, 0.367831498998180194, 0.587317954286617447,
                                          0.769902674194304687, 0.904117256370474857, 0.981560634246719251};
constexpr std::array<double, 6> kWeights = {0.249147045813402785, 0.233492536538354809, 0.203167426723065922,
                                            0.160078328543346226, 0.106939325995318431, 0.047175336386511827};

/// offset + minus n and offset + plus n of every number.
std::vector<double> both_signs(const std::array<double, 6>& numbers, double offset, double minus,
                               double plus) {
  std::vector<double> all;
  for (const double number : numbers) {
    all.push_back(offset + minus * number);
    all.push_back(offset + plus * number);
  }
  return all;
}

/// Where a squareness error moves its axis, m per m and rad (docs/notation.md, Datum).
Vector3d squareness_direction(LocationSymbol symbol) {
  return Vector3d::Unit(direction_of(symbol.component)).cross(Vector3d::Unit(direction_of(symbol.axis)));
}

}  // namespace

class RigidCompromise::Sums {
 public:
  /// A linear axis of the chain.
  struct ChainAxis {
    AxisName name = AxisName::X;
    Vector3d direction = Vector3d::UnitX();
    double middle = 0.0;               ///< m
    double home = 0.0;                 ///< m
    double variance = 0.0;             ///< of a position, m^2
    std::vector<double> node, weight;  ///< of Gauss' rule over the travel; weights sum to 1
  };

  /// Of one axis at one position, per amplitude.
  struct AtNode {
    Columns3 main;      ///< mean over the other axes, m
    Columns3 rotation;  ///< before its mean is taken off, rad
  };

  Sums(const FitResult& result, const Tool& tool, const Conditions& conditions)
      : parameters_(result.parameters),
        displacements_(result, tool, conditions),
        chain_(result.machine),
        tool_(tool),
        effects_(displacements_.coupled_effects()) {
    if (effects_.empty()) return;
    for (const Joint& joint : result.machine.structure.joints) {
      if (is_rotary(joint.axis)) continue;
      const Axis& axis = result.machine.axis(joint.axis);
      const double half = 0.5 * axis.travel(), middle = axis.travel_min + half;
      axes_.push_back({joint.axis, Vector3d::Unit(direction_of(joint.axis)), middle, axis.home,
                       half * half / 3.0, both_signs(kNodes, middle, -half, half),
                       both_signs(kWeights, 0.0, 0.5, 0.5)});
    }
    mean_ = Columns3::Zero(3, amplitudes());
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      mean_rotation_.push_back(Columns3::Zero(3, amplitudes()));
      for (std::size_t n = 0; n < axes_[i].node.size(); ++n) {
        const AtNode& there = at(i, axes_[i].node[n], 0);
        mean_rotation_[i] += axes_[i].weight[n] * there.rotation;
        if (i == 0) mean_ += axes_[i].weight[n] * there.main;
      }
    }
    for (std::size_t i = 0; i < axes_.size(); ++i) slopes_.push_back(mean_slope(i));
    find_squareness(result.machine);
  }

  bool empty() const { return effects_.empty(); }
  const MachineEffects& effects() const { return effects_; }

  Columns3 main(std::size_t axis, double q, int direction) { return at(axis, q, direction).main - mean_; }
  Columns3 rotation(std::size_t axis, double q, int direction) {
    return at(axis, q, direction).rotation - mean_rotation_[axis];
  }
  Columns3 main_at_home(std::size_t axis) { return main(axis, axes_[axis].home, 0); }
  Columns3 rotation_at_home(std::size_t axis) { return rotation(axis, axes_[axis].home, 0); }

  /// Rotation E_i less that at home, and what that makes of the axes behind for each of them.
  Columns3 rotation_from_home(std::size_t axis, double q, int direction) {
    return rotation(axis, q, direction) - rotation_at_home(axis);
  }
  Columns3 main_with_rotations_at_home(std::size_t axis, double q, int direction) {
    Columns3 moved = main(axis, q, direction);
    const ChainAxis& own = axes_[axis];
    for (std::size_t i = 0; i < axis; ++i) {
      const Columns3 turned = rotation_at_home(i);
      for (Eigen::Index c = 0; c < moved.cols(); ++c)
        moved.col(c) += (q - own.middle) * Vector3d(turned.col(c)).cross(own.direction);
    }
    return moved;
  }

  /// Error motions with the slopes of their straightness, 6 x amplitudes.
  PoseErrorRows sloping_motions(std::size_t axis, double q, int direction) {
    PoseErrorRows rows = PoseErrorRows::Zero(6, amplitudes());
    const Columns3 rotation = rotation_from_home(axis, q, direction);
    rows.topRows<3>() = main_with_rotations_at_home(axis, q, direction) -
                        main_with_rotations_at_home(axis, axes_[axis].home, 0);
    rows.bottomRows<3>() = rotation;
    const Vector3d to_point = arm(axis, q);
    for (Eigen::Index c = 0; c < rows.cols(); ++c)
      rows.col(c).head<3>() -= Vector3d(rotation.col(c)).cross(to_point);
    return rows;
  }
  const std::map<LocationSymbol, Eigen::RowVectorXd>& squareness() const { return squareness_; }

  std::size_t place_of(AxisName name) const {
    return static_cast<std::size_t>(std::ranges::find(axes_, name, &ChainAxis::name) - axes_.begin());
  }
  const std::vector<ChainAxis>& axes() const { return axes_; }

  /// Arm of an axis' rotation with the other axes at their middles, m.
  Vector3d arm(std::size_t axis, double q) const {
    AxisPosition position{};
    for (const ChainAxis& each : axes_) position[index_of(each.name)] = each.middle;
    position[index_of(axes_[axis].name)] = q;
    JointLever levers[kAxisCount];
    chain_.levers(position, tool_.offset, levers);
    return std::find_if(levers, levers + chain_.joint_count(),
                        [&](const JointLever& lever) { return lever.axis == axes_[axis].name; })
        ->arm_s;
  }

  Vector3d summed(const Columns3& columns) const {
    Vector3d sum = Vector3d::Zero();
    for (Eigen::Index c = 0; c < columns.cols(); ++c)
      sum += columns.col(c) * parameters_[effects_.columns()[static_cast<std::size_t>(c)].parameter];
    return sum;
  }

 private:
  /// A slope that is less than this share of the motion's own size is rounding.
  static constexpr double kNoSlope = 1e-12;

  Eigen::Index amplitudes() const { return static_cast<Eigen::Index>(effects_.amplitude_count()); }

  /// Least squares over the travel, uniformly weighted, mean of both directions; per amplitude.
  Columns3 mean_slope(std::size_t axis) {
    const ChainAxis& own = axes_[axis];
    Columns3 moment = Columns3::Zero(3, amplitudes());
    double size = 0.0;
    for (std::size_t n = 0; n < own.node.size(); ++n) {
      const Columns3 shift = sloping_motions(axis, own.node[n], 0).topRows<3>();
      moment += own.weight[n] * (own.node[n] - own.middle) * shift;
      size = std::max(size, shift.cwiseAbs().maxCoeff());
    }
    const double none = kNoSlope * size * std::sqrt(own.variance);
    for (double& entry : moment.reshaped()) {
      if (std::abs(entry) <= none) entry = 0.0;
    }
    return moment / own.variance;
  }

  void find_squareness(const Machine& machine) {
    for (const LocationSymbol symbol : squareness_errors(machine)) {
      const std::size_t later = place_of(symbol.axis);
      const Vector3d turned = squareness_direction(symbol);
      Eigen::RowVectorXd angle = turned.transpose() * slopes_[later];
      const std::size_t earlier = place_of(kLinearAxes[static_cast<std::size_t>(
          3 - direction_of(symbol.axis) - direction_of(symbol.component))]);
      if (earlier < axes_.size())
        angle += turned.sum() * (axes_[later].direction.transpose() * slopes_[earlier]);
      squareness_.emplace(symbol, angle);
    }
  }

  const AtNode& at(std::size_t axis, double q, int direction) {
    const auto [place, is_new] = known_.try_emplace({axis, direction, q});
    if (is_new) place->second = moments(axis, q, direction);
    return place->second;
  }

  AtNode moments(std::size_t axis, double q, int direction) const {
    std::vector<AxisPosition> positions(1, AxisPosition{});
    std::vector<double> weights(1, 1.0);
    positions[0][index_of(axes_[axis].name)] = q;
    for (std::size_t k = 0; k < axes_.size(); ++k) {
      if (k == axis) continue;
      std::vector<AxisPosition> more;
      std::vector<double> more_weights;
      for (std::size_t i = 0; i < positions.size(); ++i) {
        for (std::size_t n = 0; n < axes_[k].node.size(); ++n) {
          more.push_back(positions[i]);
          more.back()[index_of(axes_[k].name)] = axes_[k].node[n];
          more_weights.push_back(weights[i] * axes_[k].weight[n]);
        }
      }
      positions = std::move(more);
      weights = std::move(more_weights);
    }
    ApproachDirection approach{};
    approach[index_of(axes_[axis].name)] = static_cast<std::int8_t>(direction);
    const std::vector<Columns3> unit = displacements_.coupled_units(positions, {&approach, 1});
    AtNode sums{Columns3::Zero(3, amplitudes()), Columns3::Zero(3, amplitudes())};
    Vector3d weight_of_rotation = Vector3d::Zero();
    for (std::size_t i = 0; i < positions.size(); ++i) sums.main += weights[i] * unit[i];
    for (std::size_t k = axis + 1; k < axes_.size(); ++k) {
      const auto& behind = axes_[k];
      Columns3 moment = Columns3::Zero(3, amplitudes());
      for (std::size_t i = 0; i < positions.size(); ++i)
        moment += (weights[i] * (positions[i][index_of(behind.name)] - behind.middle)) * unit[i];
      for (Eigen::Index c = 0; c < moment.cols(); ++c)
        sums.rotation.col(c) += behind.direction.cross(Vector3d(moment.col(c)));
      weight_of_rotation += behind.variance * (Vector3d::Ones() - behind.direction);
    }
    for (int row = 0; row < 3; ++row) {
      if (weight_of_rotation[row] > 0.0) {
        sums.rotation.row(row) /= weight_of_rotation[row];
      } else {
        sums.rotation.row(row).setZero();
      }
    }
    return sums;
  }

  Eigen::VectorXd parameters_;
  LinearDisplacements displacements_;
  KinematicChain chain_;
  Tool tool_;
  MachineEffects effects_;
  std::vector<ChainAxis> axes_;  ///< workpiece to tool
  Columns3 mean_;
  std::vector<Columns3> mean_rotation_;
  std::vector<Columns3> slopes_;  ///< of sloping_motions(), m per m
  std::map<LocationSymbol, Eigen::RowVectorXd> squareness_;
  std::map<std::tuple<std::size_t, int, double>, AtNode> known_;
};

RigidCompromise::RigidCompromise(const FitResult& result, const Tool& tool, const Conditions& conditions)
    : sums_(std::make_shared<Sums>(result, tool, conditions)) {}

bool RigidCompromise::empty() const { return sums_->empty(); }

std::vector<int> RigidCompromise::parameters() const {
  std::vector<int> all;
  for (std::size_t c = 0; c < sums_->effects().amplitude_count(); ++c)
    all.push_back(sums_->effects().columns()[c].parameter);
  return all;
}

PoseErrorRows RigidCompromise::motions(AxisName axis, double q, int direction) const {
  const std::size_t place = sums_->place_of(axis);
  if (place == sums_->axes().size())
    return PoseErrorRows::Zero(6, static_cast<Eigen::Index>(sums_->effects().amplitude_count()));
  PoseErrorRows rows = sums_->sloping_motions(place, q, direction);
  const double travelled = q - sums_->axes()[place].home;
  for (const auto& [symbol, angle] : sums_->squareness()) {
    if (symbol.axis == axis) rows.topRows<3>() -= travelled * squareness_direction(symbol) * angle;
  }
  return rows;
}

Eigen::RowVectorXd RigidCompromise::squareness(LocationSymbol symbol) const {
  const auto found = sums_->squareness().find(symbol);
  if (found != sums_->squareness().end()) return found->second;
  return Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(sums_->effects().amplitude_count()));
}

Vector3d RigidCompromise::along(AxisName axis, double q, int direction) const {
  const std::size_t place = sums_->place_of(axis);
  if (sums_->empty() || place == sums_->axes().size()) return Vector3d::Zero();
  return sums_->summed(sums_->main(place, q, direction) - sums_->main_at_home(place));
}

Vector3d RigidCompromise::at(const AxisPosition& position, const ApproachDirection& direction) const {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < sums_->axes().size(); ++i) {
    const AxisName name = sums_->axes()[i].name;
    const double q = position[index_of(name)];
    const int approach = direction[index_of(name)];
    sum += along(name, q, approach);
    const Vector3d rotation = sums_->summed(sums_->rotation(i, q, approach));
    const Vector3d at_home = sums_->summed(sums_->rotation_at_home(i));
    for (std::size_t k = i + 1; k < sums_->axes().size(); ++k) {
      const auto& behind = sums_->axes()[k];
      sum += (position[index_of(behind.name)] - behind.middle) * rotation.cross(behind.direction) -
             (behind.home - behind.middle) * at_home.cross(behind.direction);
    }
  }
  return sum;
}

}  // namespace volcal
