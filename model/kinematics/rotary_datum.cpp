#include "volcal/model/kinematics/rotary_datum.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kDatumPoses = 120;
constexpr double kDependent = 1e-6;  // share of a column that its predecessors leave
constexpr double kLever = 0.3;       // m: makes rotations comparable with displacements

/// From the bed outwards, workpiece side first.
std::vector<AxisName> rotary_axes_from_bed(const Machine& machine) {
  std::vector<AxisName> table, head;
  for (const Joint& joint : machine.structure.joints) {
    if (!is_rotary(joint.axis)) continue;
    if (joint.workpiece_side) {
      table.insert(table.begin(), joint.axis);
    } else {
      head.push_back(joint.axis);
    }
  }
  table.insert(table.end(), head.begin(), head.end());
  return table;
}

std::vector<LocationSymbol> locations_by_rank(const Machine& machine) {
  std::vector<LocationSymbol> symbols = squareness_errors(machine);
  const auto possible = possible_locations(machine);
  const auto axes = rotary_axes_from_bed(machine);
  const auto add_if = [&](const auto& wanted) {
    for (const AxisName axis : axes) {
      for (const LocationSymbol& symbol : possible) {
        if (symbol.axis == axis && wanted(symbol)) symbols.push_back(symbol);
      }
    }
  };
  const auto is_zero = [](const LocationSymbol& symbol) {
    return direction_of(symbol.component) == direction_of(symbol.axis);
  };
  add_if([&](const LocationSymbol& s) { return is_rotation(s.component) && !is_zero(s); });
  add_if([](const LocationSymbol& s) { return !is_rotation(s.component); });
  add_if([&](const LocationSymbol& s) { return is_zero(s); });
  return symbols;
}

/// Columns of the locations at all poses, one block of three rows each.
Eigen::MatrixXd location_columns(const Machine& machine, const std::vector<LocationSymbol>& symbols,
                                 const std::vector<AxisPosition>& poses) {
  const KinematicChain chain(machine);
  std::vector<JointLever> levers(chain.joint_count());
  Eigen::MatrixXd columns(3 * static_cast<Eigen::Index>(poses.size()),
                          static_cast<Eigen::Index>(symbols.size()));
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    const Tool& tool = machine.tools[pose % machine.tools.size()];
    chain.levers(poses[pose], tool.offset, levers.data());
    for (std::size_t k = 0; k < symbols.size(); ++k) {
      const auto lever = std::ranges::find(levers, symbols[k].axis, &JointLever::axis);
      columns.block<3, 1>(3 * static_cast<Eigen::Index>(pose), static_cast<Eigen::Index>(k)) =
          KinematicChain::location_lever_w(*lever, symbols[k].component);
    }
  }
  return columns;
}

Eigen::MatrixXd all_frame_columns(const Machine& machine, const std::vector<AxisPosition>& poses) {
  const KinematicChain chain(machine);
  Eigen::MatrixXd columns;
  for (std::size_t pose = 0; pose < poses.size(); ++pose) {
    const auto rows = frame_columns(machine, chain, poses[pose], pose % machine.tools.size());
    if (pose == 0) columns.resize(3 * static_cast<Eigen::Index>(poses.size()), rows.cols());
    columns.middleRows<3>(3 * static_cast<Eigen::Index>(pose)) = rows;
  }
  return columns;
}

/// Takes from a vector what the orthonormal columns span, twice for rounding.
void project_out(const Eigen::MatrixXd& span, Eigen::Index count, Eigen::VectorXd& vector) {
  for (int pass = 0; pass < 2; ++pass) {
    vector -= span.leftCols(count) * (span.leftCols(count).transpose() * vector);
  }
}

}  // namespace

double radical_inverse(int index, int base) {
  double share = 0.0, place = 1.0 / base;
  for (; index > 0; index /= base, place /= base) share += place * (index % base);
  return share;
}

std::vector<AxisPosition> spread_poses(const Machine& machine, int count) {
  constexpr std::array<int, kAxisCount> kBases = {2, 3, 5, 7, 11, 13, 17, 19, 23};
  std::vector<AxisPosition> poses(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    for (const Axis& axis : machine.axes) {
      const double length = is_rotary(axis.name) ? std::min(axis.travel(), kTurn) : axis.travel();
      const double share = radical_inverse(i + 1, kBases[index_of(axis.name)]);
      poses[static_cast<std::size_t>(i)][index_of(axis.name)] = axis.travel_min + share * length;
    }
  }
  return poses;
}

Eigen::Matrix<double, 3, Eigen::Dynamic> frame_columns(const Machine& machine, const KinematicChain& chain,
                                                       const AxisPosition& position, std::size_t tool) {
  const bool are_uncertain =
      std::ranges::any_of(machine.tools, [](const Tool& each) { return each.offset_sigma > 0.0; });
  const auto tools = static_cast<Eigen::Index>(are_uncertain ? machine.tools.size() : 0);
  Eigen::Matrix<double, 3, Eigen::Dynamic> columns =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, 6 + 3 * tools);
  const Eigen::Vector3d point_w = chain.nominal_point_w(position, machine.tools[tool].offset);
  for (int k = 0; k < 3; ++k) {
    columns.col(k) = Eigen::Vector3d::Unit(k);
    columns.col(3 + k) = Eigen::Vector3d::Unit(k).cross(point_w) / kLever;
  }
  if (are_uncertain && machine.tools[tool].offset_sigma > 0.0) {
    columns.middleCols<3>(6 + 3 * static_cast<Eigen::Index>(tool)) = chain.nominal_rotation_wt(position);
  }
  return columns;
}

std::vector<PosedPoint> spread_points(const Machine& machine, int count) {
  const std::array<Eigen::Vector3d, 3> offsets = {Eigen::Vector3d(0.0, 0.0, -kLever),
                                                  Eigen::Vector3d(kLever, 0.0, 0.0),
                                                  Eigen::Vector3d(0.0, kLever, 0.0)};
  std::vector<PosedPoint> points;
  for (const AxisPosition& pose : spread_poses(machine, count))
    points.push_back({pose, offsets[points.size() % 3]});
  return points;
}

FrameChangeColumns frame_change_columns(const Machine& machine, const std::vector<LocationSymbol>& locations,
                                        const std::vector<PosedPoint>& points) {
  const KinematicChain chain(machine);
  std::vector<JointLever> levers(chain.joint_count());
  const auto rows = 3 * static_cast<Eigen::Index>(points.size());
  FrameChangeColumns columns{Eigen::MatrixXd(rows, static_cast<Eigen::Index>(locations.size())),
                             Eigen::MatrixXd(rows, 6), Eigen::MatrixXd(rows, 3)};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    const Eigen::Vector3d point_w = chain.levers(points[i].position, points[i].offset_t, levers.data());
    for (std::size_t k = 0; k < locations.size(); ++k) {
      const auto lever = std::ranges::find(levers, locations[k].axis, &JointLever::axis);
      columns.locations.block<3, 1>(row, static_cast<Eigen::Index>(k)) =
          KinematicChain::location_lever_w(*lever, locations[k].component);
    }
    const Eigen::Matrix3d rotation_wt = chain.nominal_rotation_wt(points[i].position);
    for (int k = 0; k < 3; ++k) {
      columns.workpiece.block<3, 1>(row, k) = Eigen::Vector3d::Unit(k);
      columns.workpiece.block<3, 1>(row, 3 + k) = Eigen::Vector3d::Unit(k).cross(point_w);
      columns.tools.block<3, 1>(row, k) = rotation_wt * Eigen::Vector3d::Unit(k).cross(points[i].offset_t);
    }
  }
  return columns;
}

std::vector<LocationSymbol> independent_locations(const Machine& machine) {
  if (machine.tools.empty()) return possible_locations(machine);
  const std::vector<LocationSymbol> symbols = locations_by_rank(machine);
  const std::vector<AxisPosition> poses = spread_poses(machine, kDatumPoses);
  const Eigen::MatrixXd frames = all_frame_columns(machine, poses);
  const Eigen::MatrixXd columns = location_columns(machine, symbols, poses);
  Eigen::MatrixXd span(columns.rows(), frames.cols() + columns.cols());
  Eigen::Index count = 0;
  const auto is_new = [&](Eigen::VectorXd column) {
    const double length = column.norm();
    project_out(span, count, column);
    if (column.norm() <= kDependent * length) return false;
    span.col(count++) = column.normalized();
    return true;
  };
  for (Eigen::Index k = 0; k < frames.cols(); ++k) is_new(frames.col(k));
  std::vector<LocationSymbol> independent;
  for (std::size_t k = 0; k < symbols.size(); ++k) {
    if (is_new(columns.col(static_cast<Eigen::Index>(k)))) independent.push_back(symbols[k]);
  }
  return independent;
}

}  // namespace volcal
