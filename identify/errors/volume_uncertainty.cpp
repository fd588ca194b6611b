#include "volcal/identify/errors/volume_uncertainty.h"

#include <Eigen/QR>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace volcal {
namespace {

/// Displacements of points by unit shifts and unit turns about their mean, orthonormal columns.
Eigen::MatrixXd rigid_motions(std::span<const AxisPosition> positions, const Eigen::Vector3d& movable) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const AxisPosition& position : positions)
    centre += Eigen::Map<const Eigen::Vector3d>(position.data()) / static_cast<double>(positions.size());
  Eigen::MatrixXd motions(static_cast<Eigen::Index>(3 * positions.size()), 6);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Eigen::Vector3d arm = Eigen::Map<const Eigen::Vector3d>(positions[i].data()) - centre;
    auto rows = motions.middleRows<3>(static_cast<Eigen::Index>(3 * i));
    rows.leftCols<3>().setIdentity();
    for (int k = 0; k < 3; ++k) rows.col(3 + k) = Eigen::Vector3d::Unit(k).cross(arm);
    rows = movable.asDiagonal() * rows;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition(motions);
  return decomposition.householderQ() * Eigen::MatrixXd::Identity(motions.rows(), decomposition.rank());
}

/// Columns that are not 0 everywhere.
std::vector<Eigen::Index> filled_columns(const Eigen::MatrixXd& rows) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index column = 0; column < rows.cols(); ++column) {
    if (!rows.col(column).isZero(0.0)) columns.push_back(column);
  }
  return columns;
}

}  // namespace

double volume_uncertainty(const FitResult& result, const Tool& tool, const Conditions& conditions,
                          std::span<const AxisPosition> positions,
                          std::span<const ApproachDirection> directions) {
  if (positions.size() != directions.size())
    throw std::invalid_argument("as many positions as directions are needed");
  if (positions.empty() || result.covariance.isZero(0.0)) return 0.0;
  const ErrorField field(result, tool, conditions);
  Eigen::Vector3d movable = Eigen::Vector3d::Zero();
  for (const Axis& axis : result.machine.axes) {
    if (index_of(axis.name) < 3) movable[static_cast<Eigen::Index>(index_of(axis.name))] = 1.0;
  }
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(3 * positions.size()), result.layout.size);
  for (std::size_t i = 0; i < positions.size(); ++i)
    rows.middleRows<3>(static_cast<Eigen::Index>(3 * i)) =
        movable.asDiagonal() * field.rows(positions[i], directions[i]).topRows<3>();
  const std::vector<Eigen::Index> filled = filled_columns(rows);
  const Eigen::MatrixXd covariance = result.covariance(filled, filled);
  const Eigen::MatrixXd bent = rows(Eigen::all, filled), motions = rigid_motions(positions, movable);
  const Eigen::MatrixXd gram = bent.transpose() * bent, shared = motions.transpose() * bent;
  const double variance =
      gram.cwiseProduct(covariance).sum() - (shared * covariance * shared.transpose()).trace();
  return std::sqrt(std::max(0.0, variance) / static_cast<double>(positions.size()));
}

}  // namespace volcal
