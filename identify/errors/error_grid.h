#pragma once
/// Volumetric errors and their covariances on a grid of the axes X, Y, Z, rotary axes at 0, U, V, W standing.
///
/// With a, b, c the linear axes from the workpiece to the tool and u their directions, the first-order error
/// (chain.h) is e = F(a, b) + q_c G(a, b) + D_c(q_c),
///   F = D_a + D_b + q_b e_a x u_b,   G = (e_a + e_b) x u_c,
/// where D_i, e_i are linear in the parameters of one axis: displacement with the other axes at 0, rotation.
/// An axis that stands, turned or moved, adds a constant and turns the travel of the axes behind it.
/// Covariances of two axes' D and e are one block per pair of their nodes; everything on the grid is summed
/// from these blocks. Effects and expansions of scales are added node by node: with J the derivatives of the
/// errors to their parameters and C the covariance, cov e = cov e_0 + J C_e0 + C_0e J^T + J C_ee J^T, where
/// C_0e is a field of the linear axes like e_0 itself, one for each parameter. Equal to volumetric_error() at
/// every node but for rounding, 1e-12 of the largest.

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/plane_tables.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

/// Positions of X, Y, Z; always three axes, those that a machine lacks first, with the one node 0. Parallel
/// axes stand.
struct AxisGrid {
  std::array<AxisName, 3> axes{};            ///< workpiece to tool
  std::array<std::vector<double>, 3> nodes;  ///< m
  AxisPosition standing{};                   ///< of every other axis, m or rad

  std::array<std::size_t, 3> counts() const { return {nodes[0].size(), nodes[1].size(), nodes[2].size()}; }
  /// Of every node, the last axis fastest.
  std::vector<AxisPosition> positions() const;
};

/// `per_axis` nodes on each of X, Y, Z, ends of the travel included; U, V, W at home.
AxisGrid axis_grid(const Machine& machine, int per_axis);

/// Of a displacement, m^2.
struct Covariance3 {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  Eigen::Vector3d variances() const { return {xx, yy, zz}; }
  Eigen::Matrix3d matrix() const;
};

/// The errors at one node of a plane, mean of both directions of approach.
struct NodeError {
  PoseErrorVector value;     ///< ex ey ez, m; ea eb ec, rad; workpiece coordinates
  PoseErrorVector variance;  ///< m^2, rad^2
};

/// Errors of one tool at stated conditions: of a tool whose offset was estimated with its fitted error, of
/// another without the stated variance of its offset. `result` must outlive it.
class ErrorGrid {
 public:
  ErrorGrid(const FitResult& result, const Tool& tool, AxisGrid grid, const Conditions& conditions);
  ErrorGrid(const FitResult& result, const Tool& tool, AxisGrid grid)
      : ErrorGrid(result, tool, std::move(grid), default_conditions(result)) {}

  /// ex ey ez, m, and ea eb ec, rad, without effects and expansions.
  PlaneTables displacements() const { return displacements_by(result_.parameters); }
  PlaneTables rotations() const { return rotations_by(result_.parameters); }
  /// Errors and variances at the nodes of the second and third axis, node after node of the first.
  using UseOfNodes = std::function<void(std::size_t first, std::span<const NodeError> plane)>;
  void for_each_plane(const UseOfNodes& use) const;
  /// At every node, the last axis fastest.
  std::vector<Covariance3> displacement_covariances() const;
  /// The same for the nodes of the second and third axis at node after node of the first.
  using UseOfPlane = std::function<void(std::size_t first, std::span<const Covariance3> plane)>;
  void for_each_plane_of_covariances(const UseOfPlane& use) const;
  /// Of ea eb ec, rad^2, without effects and expansions.
  PlaneTables rotation_variances() const;

 private:
  /// Derivatives of one axis' errors to the parameters that they depend on. What no linear axis moves (rotary
  /// axes, a tool's offset) counts to the first axis.
  struct AxisErrors {
    std::vector<int> parameters;
    Eigen::MatrixXd errors;     ///< parameters x 6 nodes: D, e
    Eigen::MatrixXd rotations;  ///< parameters x 3 nodes: of the tool
  };

  using Rows = Eigen::MatrixXd AxisErrors::*;
  /// At the nodes of every axis, with other parameters in place of the result's.
  std::array<Eigen::VectorXd, 3> along_axes(Rows rows, const Eigen::VectorXd& parameters) const;
  PlaneTables displacements_by(const Eigen::VectorXd& parameters) const;
  PlaneTables rotations_by(const Eigen::VectorXd& parameters) const;

  AxisErrors errors_of(std::size_t axis, const Tool& tool) const;
  /// Covariance of the parameters of two axes, times the rows of the second.
  Eigen::MatrixXd weighted(Rows rows, std::size_t i, std::size_t j) const;
  /// Covariances of the rows of two axes, all nodes with all nodes.
  Eigen::MatrixXd between(Rows rows, std::size_t i, std::size_t j) const;
  /// Of the rows of one axis, each node with itself: `count` x `count` side by side.
  Eigen::MatrixXd at_nodes(Rows rows, std::size_t axis, Eigen::Index count) const;

  class Conditional;

  const FitResult& result_;
  AxisGrid grid_;
  ErrorField field_;
  std::array<AxisErrors, 3> axes_;
};

}  // namespace volcal
