#include "volcal/identify/errors/error_grid.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/model/description/parameter_names.h"
#include "volcal/model/kinematics/vector_loops.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using SixNumbers = Eigen::Matrix<double, 6, 1>;  // upper triangle of a 3 x 3 matrix, row by row

constexpr Eigen::Index kErrorsOfNode = 6;  // D, e
constexpr Eigen::Index kRotationsOfNode = 3;

/// e -> e x u
Matrix3d crossed_with(AxisName axis) {
  Matrix3d matrix;
  for (int i = 0; i < 3; ++i) matrix.col(i) = Vector3d::Unit(i).cross(Vector3d::Unit(direction_of(axis)));
  return matrix;
}

SixNumbers upper(const Matrix3d& m) { return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)}; }

SixNumbers upper_of_both(const Matrix3d& m) { return upper(m + m.transpose()); }

/// Axis whose function or location a parameter belongs to; none for anything else.
std::vector<std::optional<AxisName>> axes_of_parameters(const ParameterLayout& layout) {
  std::vector<std::optional<AxisName>> axes(static_cast<std::size_t>(layout.size));
  for (const FunctionGroup& group : layout.groups)
    std::fill_n(axes.begin() + group.offset, group.size(), group.axis);
  for (const ParameterBlock& block : layout.blocks) {
    if (block.location) axes[static_cast<std::size_t>(block.offset)] = block.location->axis;
  }
  return axes;
}

bool is_nearer_workpiece(const Structure& structure, AxisName first, AxisName second) {
  const auto place = [&](AxisName axis) { return std::ranges::find(structure.joints, axis, &Joint::axis); };
  return place(first) < place(second);
}

/// One number of the covariances along the third axis, the nodes of the first two given.
struct CovarianceRow {
  const double* position;  ///< q_c, m
  const double* of_second;
  const double* of_first;
  const double* of_first_per_q;
  std::size_t count;
};

/// s0 + s1 q_c + s2 q_c^2 + T_bc + U_ac + q_b U'_ac
VOLCAL_VECTOR_LOOPS void sum_covariances(const CovarianceRow& row, double q, double s0, double s1, double s2,
                                         double* __restrict sums) {
  const double* const __restrict position = row.position;
  const double* const __restrict second = row.of_second;
  const double* const __restrict first = row.of_first;
  const double* const __restrict first_per_q = row.of_first_per_q;
  for (std::size_t k = 0; k < row.count; ++k) {
    const double along = s0 + position[k] * (s1 + position[k] * s2);
    sums[k] = along + second[k] + (first[k] + q * first_per_q[k]);
  }
}

/// Tables of six numbers per pair of nodes, each number's along the second axis contiguous.
class PairNumbers {
 public:
  PairNumbers(std::size_t first, std::size_t second) : second_(second), numbers_(6 * first * second) {}

  void set(std::size_t i, std::size_t k, const SixNumbers& six) {
    for (std::size_t n = 0; n < 6; ++n) numbers_[(6 * i + n) * second_ + k] = six[static_cast<int>(n)];
  }
  const double* row(std::size_t i, std::size_t n) const { return numbers_.data() + (6 * i + n) * second_; }

 private:
  std::size_t second_;
  std::vector<double> numbers_;
};

Eigen::Index index_at(std::size_t node, Eigen::Index count) {
  return static_cast<Eigen::Index>(node) * count;
}

/// Of D and e: each axis' nodes with themselves, side by side, and those of two axes with each other.
struct ErrorBlocks {
  MatrixXd aa, bb, cc, ab, ac, bc;
};

/// Sums the covariances of F + q_c G + D_c along the third axis.
class CovarianceSums {
 public:
  CovarianceSums(const AxisGrid& grid, const ErrorBlocks& blocks)
      : grid_(grid),
        blocks_(blocks),
        crossed_b_(crossed_with(grid.axes[1])),
        crossed_c_(crossed_with(grid.axes[2])),
        of_second_(grid.nodes[1].size(), grid.nodes[2].size()),
        of_first_(grid.nodes[0].size(), grid.nodes[2].size()),
        of_first_per_q_(grid.nodes[0].size(), grid.nodes[2].size()),
        numbers_(6 * grid.nodes[2].size()) {
    for (std::size_t k = 0; k < grid.nodes[2].size(); ++k) tabulate(k);
  }

  /// Of the nodes along the third axis, those of the first two given.
  void along_third(std::size_t i, std::size_t j, Covariance3* covariances) {
    const Matrix6d moments = moments_at(i, j);
    const SixNumbers s0 = upper(moments.topLeftCorner<3, 3>());
    const SixNumbers s1 = upper_of_both(moments.topRightCorner<3, 3>());
    const SixNumbers s2 = upper(moments.bottomRightCorner<3, 3>());
    const std::vector<double>& q_c = grid_.nodes[2];
    const std::size_t count = q_c.size();
    for (std::size_t n = 0; n < 6; ++n) {
      const auto m = static_cast<int>(n);
      sum_covariances(
          {q_c.data(), of_second_.row(j, n), of_first_.row(i, n), of_first_per_q_.row(i, n), count},
          grid_.nodes[1][j], s0[m], s1[m], s2[m], numbers_.data() + n * count);
    }
    for (std::size_t k = 0; k < count; ++k) {
      const double* const at = numbers_.data() + k;
      covariances[k] = {at[0], at[count], at[2 * count], at[3 * count], at[4 * count], at[5 * count]};
    }
  }

 private:
  static Matrix6d pair(const MatrixXd& blocks, std::size_t i, std::size_t k) {
    return blocks.block<6, 6>(index_at(i, kErrorsOfNode), index_at(k, kErrorsOfNode));
  }

  /// What a node of the third axis adds.
  void tabulate(std::size_t k) {
    const Matrix3d crossed_c = grid_.nodes[2][k] * crossed_c_;
    const SixNumbers third = upper(blocks_.cc.block<3, 3>(0, index_at(k, kErrorsOfNode)));
    for (std::size_t j = 0; j < grid_.nodes[1].size(); ++j) {
      const Matrix6d block = pair(blocks_.bc, j, k);
      of_second_.set(
          j, k,
          third + upper_of_both(block.topLeftCorner<3, 3>() + crossed_c * block.bottomLeftCorner<3, 3>()));
    }
    for (std::size_t i = 0; i < grid_.nodes[0].size(); ++i) {
      const Matrix6d block = pair(blocks_.ac, i, k);
      const Matrix3d of_rotation = block.bottomLeftCorner<3, 3>();
      of_first_.set(i, k, upper_of_both(block.topLeftCorner<3, 3>() + crossed_c * of_rotation));
      of_first_per_q_.set(i, k, upper_of_both(crossed_b_ * of_rotation));
    }
  }

  /// Covariance of F and G.
  Matrix6d moments_at(std::size_t i, std::size_t j) const {
    Matrix6d from_first = Matrix6d::Identity(), from_second = Matrix6d::Identity();
    from_first.bottomRightCorner<3, 3>() = from_second.bottomRightCorner<3, 3>() = crossed_c_;
    from_first.topRightCorner<3, 3>() = grid_.nodes[1][j] * crossed_b_;
    const Matrix6d first = blocks_.aa.middleCols<6>(index_at(i, kErrorsOfNode));
    const Matrix6d second = blocks_.bb.middleCols<6>(index_at(j, kErrorsOfNode));
    const Matrix6d both = from_first * pair(blocks_.ab, i, j) * from_second.transpose();
    return from_first * first * from_first.transpose() + from_second * second * from_second.transpose() +
           both + both.transpose();
  }

  const AxisGrid& grid_;
  const ErrorBlocks& blocks_;
  Matrix3d crossed_b_, crossed_c_;
  PairNumbers of_second_, of_first_, of_first_per_q_;
  std::vector<double> numbers_;
};

/// Parameters of one axis' errors, in the order of their rows.
struct ParametersOfAxis {
  std::vector<int> own;
  std::vector<int> turning;   ///< of standing axes nearer the workpiece, which turn this axis' travel
  std::vector<int> constant;  ///< of standing axes and the tool, with the first axis alone
};

/// Derivatives of the errors of functions, locations and the tool.
class RigidRows {
 public:
  RigidRows(const FitResult& result, const Tool& tool)
      : layout_(result.layout),
        tool_(tool),
        chain_(result.machine),
        travel_(result),
        offset_(layout_.find_block(tool_parameter(tool.name))) {}

  PoseErrorRows at(const AxisPosition& position) const {
    PoseErrorRows rows = pose_error_rows(chain_, layout_, position, tool_.offset, travel_.held(position));
    if (offset_ != nullptr) rows.block<3, 3>(0, offset_->offset) = chain_.nominal_rotation_wt(position);
    return rows;
  }

 private:
  const ParameterLayout& layout_;
  const Tool& tool_;
  KinematicChain chain_;
  MeasuredTravel travel_;
  const ParameterBlock* offset_;  ///< of the tool's estimated offset; null where it is none
};

bool stands_in_grids(AxisName axis) { return is_rotary(axis) || is_parallel(axis); }

ParametersOfAxis parameters_of(const FitResult& result, AxisName name, bool is_first,
                               const Eigen::Matrix<double, 6, Eigen::Dynamic>& at_zero) {
  const auto owners = axes_of_parameters(result.layout);
  ParametersOfAxis parameters;
  for (int p = 0; p < result.layout.size; ++p) {
    const std::optional<AxisName> owner = owners[static_cast<std::size_t>(p)];
    if (owner == name) parameters.own.push_back(p);
    if ((owner && !stands_in_grids(*owner)) || at_zero.col(p).isZero(0.0)) continue;
    if (is_first) parameters.constant.push_back(p);
    if (owner && is_nearer_workpiece(result.machine.structure, *owner, name)) parameters.turning.push_back(p);
  }
  return parameters;
}

}  // namespace

std::vector<AxisPosition> AxisGrid::positions() const {
  std::vector<AxisPosition> all;
  AxisPosition position = standing;
  for (const double first : nodes[0]) {
    position[index_of(axes[0])] = first;
    for (const double second : nodes[1]) {
      position[index_of(axes[1])] = second;
      for (const double third : nodes[2]) {
        position[index_of(axes[2])] = third;
        all.push_back(position);
      }
    }
  }
  return all;
}

AxisGrid axis_grid(const Machine& machine, int per_axis) {
  AxisGrid grid;
  std::size_t place = 0;
  for (const AxisName axis : kLinearAxes) {
    if (machine.has_axis(axis)) continue;
    grid.axes[place] = axis;
    grid.nodes[place++] = {0.0};
  }
  for (const Joint& joint : machine.structure.joints) {
    if (is_rotary(joint.axis)) continue;
    const Axis& axis = machine.axis(joint.axis);
    if (is_parallel(axis.name)) {
      grid.standing[index_of(axis.name)] = axis.home;
      continue;
    }
    grid.axes[place] = axis.name;
    for (int i = 0; i < per_axis; ++i) {
      const double share = per_axis > 1 ? static_cast<double>(i) / (per_axis - 1) : 0.5;
      grid.nodes[place].push_back(axis.travel_min + share * axis.travel());
    }
    ++place;
  }
  return grid;
}

Matrix3d Covariance3::matrix() const {
  Matrix3d full;
  full << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return full;
}

ErrorGrid::ErrorGrid(const FitResult& result, const Tool& tool, AxisGrid grid, const Conditions& conditions)
    : result_(result), grid_(std::move(grid)), field_(result, tool, conditions) {
  for (std::size_t axis = 0; axis < 3; ++axis) axes_[axis] = errors_of(axis, tool);
}

ErrorGrid::AxisErrors ErrorGrid::errors_of(std::size_t axis, const Tool& tool) const {
  const AxisName name = grid_.axes[axis];
  const std::vector<double>& nodes = grid_.nodes[axis];
  const RigidRows rigid(result_, tool);
  const auto at_zero = rigid.at(grid_.standing);
  const auto [own, turning, constant] = parameters_of(result_, name, axis == 0, at_zero);
  AxisErrors all;
  for (const auto& part : {own, turning, constant})
    all.parameters.insert(all.parameters.end(), part.begin(), part.end());
  const auto size = static_cast<Eigen::Index>(all.parameters.size());
  all.errors = MatrixXd::Zero(size, index_at(nodes.size(), kErrorsOfNode));
  all.rotations = MatrixXd::Zero(size, index_at(nodes.size(), kRotationsOfNode));
  const Matrix3d crossed = crossed_with(name);
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    AxisPosition position = grid_.standing;
    position[index_of(name)] = nodes[node];
    const auto rows = rigid.at(position);
    auto errors = all.errors.middleCols<6>(index_at(node, kErrorsOfNode));
    auto rotations = all.rotations.middleCols<3>(index_at(node, kRotationsOfNode));
    Eigen::Index row = 0;
    for (const int p : own) {
      errors.row(row) = rows.col(p).transpose();
      rotations.row(row++) = rows.col(p).tail<3>().transpose();
    }
    for (const int p : turning)
      errors.row(row++).head<3>() = nodes[node] * (crossed * at_zero.col(p).tail<3>()).transpose();
    for (const int p : constant) {
      errors.row(row).head<3>() = at_zero.col(p).head<3>().transpose();
      rotations.row(row++) = at_zero.col(p).tail<3>().transpose();
    }
  }
  return all;
}

std::array<Eigen::VectorXd, 3> ErrorGrid::along_axes(Rows rows, const Eigen::VectorXd& parameters) const {
  std::array<Eigen::VectorXd, 3> values;
  for (std::size_t axis = 0; axis < 3; ++axis)
    values[axis] = (axes_[axis].*rows).transpose() * parameters(axes_[axis].parameters);
  return values;
}

PlaneTables ErrorGrid::displacements_by(const Eigen::VectorXd& parameters) const {
  PlaneTables tables(grid_.counts());
  const std::array<Eigen::VectorXd, 3> errors = along_axes(&AxisErrors::errors, parameters);
  const auto displacement = [&](std::size_t axis, std::size_t node) -> Vector3d {
    return errors[axis].segment<3>(index_at(node, kErrorsOfNode));
  };
  const auto rotation = [&](std::size_t axis, std::size_t node) -> Vector3d {
    return errors[axis].segment<3>(index_at(node, kErrorsOfNode) + 3);
  };
  const Matrix3d crossed_b = crossed_with(grid_.axes[1]), crossed_c = crossed_with(grid_.axes[2]);
  const std::vector<double>&q_b = grid_.nodes[1], &q_c = grid_.nodes[2];
  const auto [a, b, c] = grid_.counts();
  for (std::size_t i = 0; i < a; ++i) {
    const Vector3d own = displacement(0, i), turning_b = crossed_b * rotation(0, i),
                   turning_c = crossed_c * rotation(0, i);
    for (std::size_t j = 0; j < b; ++j)
      tables.first_second[i * b + j] = own + displacement(1, j) + q_b[j] * turning_b;
    for (std::size_t k = 0; k < c; ++k)
      tables.first_third[i * c + k] = displacement(2, k) + q_c[k] * turning_c;
  }
  for (std::size_t j = 0; j < b; ++j) {
    const Vector3d turning_c = crossed_c * rotation(1, j);
    for (std::size_t k = 0; k < c; ++k) tables.second_third[j * c + k] = q_c[k] * turning_c;
  }
  return tables;
}

PlaneTables ErrorGrid::rotations_by(const Eigen::VectorXd& parameters) const {
  PlaneTables tables(grid_.counts());
  const std::array<Eigen::VectorXd, 3> rotations = along_axes(&AxisErrors::rotations, parameters);
  const auto rotation = [&](std::size_t axis, std::size_t node) -> Vector3d {
    return rotations[axis].segment<3>(index_at(node, kRotationsOfNode));
  };
  const auto [a, b, c] = grid_.counts();
  for (std::size_t i = 0; i < a; ++i) {
    for (std::size_t j = 0; j < b; ++j) tables.first_second[i * b + j] = rotation(0, i) + rotation(1, j);
    for (std::size_t k = 0; k < c; ++k) tables.first_third[i * c + k] = rotation(2, k);
  }
  std::ranges::fill(tables.second_third, Vector3d::Zero());
  return tables;
}

MatrixXd ErrorGrid::weighted(Rows rows, std::size_t i, std::size_t j) const {
  if (result_.covariance.size() == 0)
    return MatrixXd::Zero(static_cast<Eigen::Index>(axes_[i].parameters.size()), (axes_[j].*rows).cols());
  const MatrixXd covariance = result_.covariance(axes_[j].parameters, axes_[i].parameters);
  MatrixXd product = MatrixXd::Zero(covariance.cols(), (axes_[j].*rows).cols());
  add_transposed_product(covariance, axes_[j].*rows, product);
  return product;
}

MatrixXd ErrorGrid::between(Rows rows, std::size_t i, std::size_t j) const {
  const MatrixXd right = weighted(rows, i, j);
  MatrixXd product = MatrixXd::Zero((axes_[i].*rows).cols(), right.cols());
  add_transposed_product(axes_[i].*rows, right, product);
  return product;
}

MatrixXd ErrorGrid::at_nodes(Rows rows, std::size_t axis, Eigen::Index count) const {
  const MatrixXd& left = axes_[axis].*rows;
  const MatrixXd right = weighted(rows, axis, axis);
  MatrixXd blocks(count, left.cols());
  for (Eigen::Index column = 0; column < left.cols(); column += count) {
    blocks.middleCols(column, count).noalias() =
        left.middleCols(column, count).transpose() * right.middleCols(column, count);
  }
  return blocks;
}

/// What effects and expansions add to a plane of nodes.
class ErrorGrid::Conditional {
 public:
  enum class Needs { Displacements, Rotations };  ///< the second beside the first

  Conditional(const ErrorGrid& grid, Needs needs)
      : grid_(grid), parameters_(grid.field_.condition_parameters()) {
    const Eigen::MatrixXd& covariance = grid.result_.covariance;
    if (covariance.size() == 0) return;
    own_ = covariance(parameters_, parameters_);
    for (const int parameter : parameters_) {
      const Eigen::VectorXd column = covariance.col(parameter);
      shared_displacement_.push_back(grid.displacements_by(column));
      if (needs == Needs::Rotations) shared_rotation_.push_back(grid.rotations_by(column));
    }
  }

  bool empty() const { return !grid_.field_.depends_on_conditions(); }

  /// For the nodes of the second and third axis at node `first` of the first.
  void set_plane(std::size_t first) {
    AxisGrid plane = grid_.grid_;
    plane.nodes[0] = {grid_.grid_.nodes[0][first]};
    positions_ = plane.positions();
    rows_ = grid_.field_.condition_rows(positions_, {});
    displacement_.clear();
    rotation_.clear();
    for (const PlaneTables& shared : shared_displacement_)
      displacement_.push_back(sum_planes(plane_of(shared, first)));
    for (const PlaneTables& shared : shared_rotation_)
      rotation_.push_back(sum_planes(plane_of(shared, first)));
  }

  /// Adds J C_e0 + C_0e J^T + J C_ee J^T to the covariance of the displacement.
  void add_covariance(std::size_t node, Covariance3& covariance) const {
    const auto rows = rows_of(node).topRows<3>();
    for (Eigen::Index j = 0; j < own_.cols(); ++j) {
      const Vector3d row = rows.col(j);
      const Vector3d half = displacement_[static_cast<std::size_t>(j)][node] + half_of_own(rows, j);
      covariance.xx += 2.0 * row[0] * half[0];
      covariance.xy += row[0] * half[1] + row[1] * half[0];
      covariance.xz += row[0] * half[2] + row[2] * half[0];
      covariance.yy += 2.0 * row[1] * half[1];
      covariance.yz += row[1] * half[2] + row[2] * half[1];
      covariance.zz += 2.0 * row[2] * half[2];
    }
  }

  void add(std::size_t node, NodeError& error) const {
    const auto rows = rows_of(node);
    error.value += grid_.field_.condition_value(positions_[node], rows);
    for (Eigen::Index j = 0; j < own_.cols(); ++j) {
      const auto place = static_cast<std::size_t>(j);
      PoseErrorVector half = half_of_own(rows, j);
      half.head<3>() += displacement_[place][node];
      half.tail<3>() += rotation_[place][node];
      error.variance += 2.0 * rows.col(j).cwiseProduct(half);
    }
  }

 private:
  /// Half of C_ee J^T, the column of one parameter.
  template <class Rows>
  Eigen::Matrix<double, Rows::RowsAtCompileTime, 1> half_of_own(const Rows& rows, Eigen::Index j) const {
    Eigen::Matrix<double, Rows::RowsAtCompileTime, 1> sum = 0.5 * own_(0, j) * rows.col(0);
    for (Eigen::Index i = 1; i < own_.rows(); ++i) sum += 0.5 * own_(i, j) * rows.col(i);
    return sum;
  }

  PoseErrorRows::ConstColsBlockXpr rows_of(std::size_t node) const {
    const auto count = static_cast<Eigen::Index>(parameters_.size());
    return rows_.middleCols(static_cast<Eigen::Index>(node) * count, count);
  }

  const ErrorGrid& grid_;
  std::vector<int> parameters_;
  PoseErrorRows rows_;  ///< of the plane's nodes
  MatrixXd own_;
  std::vector<PlaneTables> shared_displacement_, shared_rotation_;  ///< by parameter
  std::vector<AxisPosition> positions_;
  std::vector<std::vector<Vector3d>> displacement_, rotation_;
};

void ErrorGrid::for_each_plane_of_covariances(const UseOfPlane& use) const {
  const auto own = [&](std::size_t axis) { return at_nodes(&AxisErrors::errors, axis, kErrorsOfNode); };
  const auto both = [&](std::size_t i, std::size_t j) { return between(&AxisErrors::errors, i, j); };
  const ErrorBlocks blocks{own(0), own(1), own(2), both(0, 1), both(0, 2), both(1, 2)};
  const auto [a, b, c] = grid_.counts();
  std::vector<Covariance3> plane(b * c);
  CovarianceSums sums(grid_, blocks);
  Conditional conditional(*this, Conditional::Needs::Displacements);
  for (std::size_t i = 0; i < a; ++i) {
    for (std::size_t j = 0; j < b; ++j) sums.along_third(i, j, plane.data() + j * c);
    if (!conditional.empty()) {
      conditional.set_plane(i);
      for (std::size_t node = 0; node < plane.size(); ++node) conditional.add_covariance(node, plane[node]);
    }
    use(i, plane);
  }
}

std::vector<Covariance3> ErrorGrid::displacement_covariances() const {
  const auto [a, b, c] = grid_.counts();
  std::vector<Covariance3> covariances;
  covariances.reserve(a * b * c);
  for_each_plane_of_covariances([&](std::size_t /*first*/, std::span<const Covariance3> plane) {
    covariances.insert(covariances.end(), plane.begin(), plane.end());
  });
  return covariances;
}

PlaneTables ErrorGrid::rotation_variances() const {
  PlaneTables tables(grid_.counts());
  const auto [a, b, c] = grid_.counts();
  const auto own = [&](std::size_t axis) { return at_nodes(&AxisErrors::rotations, axis, kRotationsOfNode); };
  const auto at = [](const MatrixXd& blocks, std::size_t i, std::size_t k) -> Vector3d {
    return blocks.block<3, 3>(index_at(i, kRotationsOfNode), index_at(k, kRotationsOfNode)).diagonal();
  };
  const MatrixXd aa = own(0), bb = own(1), cc = own(2);
  const MatrixXd ab = between(&AxisErrors::rotations, 0, 1), ac = between(&AxisErrors::rotations, 0, 2),
                 bc = between(&AxisErrors::rotations, 1, 2);
  for (std::size_t i = 0; i < a; ++i) {
    for (std::size_t j = 0; j < b; ++j)
      tables.first_second[i * b + j] = at(aa, 0, i) + at(bb, 0, j) + 2.0 * at(ab, i, j);
    for (std::size_t k = 0; k < c; ++k) tables.first_third[i * c + k] = at(cc, 0, k) + 2.0 * at(ac, i, k);
  }
  for (std::size_t j = 0; j < b; ++j) {
    for (std::size_t k = 0; k < c; ++k) tables.second_third[j * c + k] = 2.0 * at(bc, j, k);
  }
  return tables;
}

void ErrorGrid::for_each_plane(const UseOfNodes& use) const {
  const PlaneTables displacements = this->displacements(), rotations = this->rotations(),
                    variances = rotation_variances();
  const auto own = [&](std::size_t axis) { return at_nodes(&AxisErrors::errors, axis, kErrorsOfNode); };
  const auto both = [&](std::size_t i, std::size_t j) { return between(&AxisErrors::errors, i, j); };
  const ErrorBlocks blocks{own(0), own(1), own(2), both(0, 1), both(0, 2), both(1, 2)};
  const auto [a, b, c] = grid_.counts();
  CovarianceSums sums(grid_, blocks);
  Conditional conditional(*this, Conditional::Needs::Rotations);
  std::vector<Covariance3> covariances(b * c);
  std::vector<NodeError> nodes(b * c);
  for (std::size_t i = 0; i < a; ++i) {
    for (std::size_t j = 0; j < b; ++j) sums.along_third(i, j, covariances.data() + j * c);
    const auto displacement = sum_planes(plane_of(displacements, i));
    const auto rotation = sum_planes(plane_of(rotations, i));
    const auto rotation_variance = sum_planes(plane_of(variances, i));
    if (!conditional.empty()) conditional.set_plane(i);
    for (std::size_t node = 0; node < nodes.size(); ++node) {
      nodes[node].value << displacement[node], rotation[node];
      nodes[node].variance << covariances[node].variances(), rotation_variance[node];
      if (!conditional.empty()) conditional.add(node, nodes[node]);
    }
    use(i, nodes);
  }
}

}  // namespace volcal
