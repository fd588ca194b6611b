#include "volcal/identify/montecarlo/draw_projection.h"

#include <cmath>
#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {

DrawProjection::DrawProjection(const RepeatedCampaign& campaign, const QuantitySet& quantities)
    : campaign_(campaign), set_(quantities) {
  const Eigen::Index own = set_.rows.rows();
  Eigen::Index columns = own;
  for (const QuantitySet::Volume& volume : set_.volumes) columns += volume.rows.rows();
  if (campaign.parameters() == 0) {  // nothing varies
    projection_ = Eigen::MatrixXd::Zero(0, columns);
    of_normals_ = Eigen::MatrixXd::Zero(campaign.linear_root().cols(), columns);
    of_amplitudes_ = Eigen::MatrixXd::Zero(campaign.response().cols(), columns);
    offset_ = Eigen::VectorXd::Zero(columns).transpose();
    u_linear_ = bias_linear_ = unit_ = Eigen::VectorXd::Zero(own);
    return;
  }
  projection_.resize(campaign.parameters(), columns);
  projection_.leftCols(own) = campaign.datum().reduce_rows(set_.rows).transpose();
  Eigen::Index column = own;
  for (const QuantitySet::Volume& volume : set_.volumes) {
    projection_.middleCols(column, volume.rows.rows()) =
        campaign.datum().reduce_rows(volume.rows).transpose();
    column += volume.rows.rows();
  }
  of_normals_ = campaign.linear_root().transpose() * projection_;
  of_amplitudes_ = campaign.response().transpose() * projection_;
  offset_ = campaign.linear_bias().transpose() * projection_;
  Eigen::ArrayXd u = Eigen::ArrayXd::Zero(columns);
  for (const Eigen::MatrixXd* part : {&of_normals_, &of_amplitudes_}) {
    if (part->rows() > 0) u += part->colwise().squaredNorm().transpose().array();
  }
  u = u.sqrt();
  u_linear_ = u.head(own);
  bias_linear_ = offset_.head(own).transpose();
  unit_ = u_linear_;
  column = own;
  for (const QuantitySet::Volume& volume : set_.volumes) {
    const Eigen::Index rows = volume.rows.rows();
    const double mean = std::sqrt(u.segment(column, rows).square().mean());
    for (const std::size_t which : {volume.rms, volume.largest}) {
      double& unit = unit_[static_cast<Eigen::Index>(which)];
      if (!(unit > 0.0)) unit = mean;
    }
    column += rows;
  }
  const Eigen::ArrayXd scale = (unit_ > 0.0).select(unit_.inverse(), 0.0);
  for (Eigen::MatrixXd* matrix : {&projection_, &of_normals_, &of_amplitudes_})
    matrix->leftCols(own) *= scale.matrix().asDiagonal();
  offset_.head(own) *= scale.matrix().asDiagonal();
}

Eigen::ArrayXXd DrawProjection::finished(Eigen::MatrixXd product) const {
  Eigen::Index column = quantities();
  for (const QuantitySet::Volume& volume : set_.volumes) {
    const Eigen::Index rows = volume.rows.rows();
    const auto rms = static_cast<Eigen::Index>(volume.rms),
               largest = static_cast<Eigen::Index>(volume.largest);
    const VolumeSizes estimate = volume_sizes(volume.error);
    Eigen::ArrayXd squares = Eigen::ArrayXd::Zero(product.rows()), most = squares;
    for (Eigen::Index k = 0; k < rows; k += 3) {
      const Eigen::ArrayXd square = (product.col(column + k).array() + volume.error[k]).square() +
                                    (product.col(column + k + 1).array() + volume.error[k + 1]).square() +
                                    (product.col(column + k + 2).array() + volume.error[k + 2]).square();
      squares += square;
      most = most.max(square);
    }
    product.col(rms) = ((squares * (3.0 / static_cast<double>(rows))).sqrt() - estimate.rms) / unit_[rms];
    product.col(largest) = (most.sqrt() - estimate.largest) / unit_[largest];
    column += rows;
  }
  return product.leftCols(quantities()).array();
}

Eigen::ArrayXXd DrawProjection::of(const Eigen::MatrixXd& deviations) const {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(deviations.cols(), projection_.cols());
  add_transposed_product(deviations, projection_, product);
  return finished(std::move(product));
}

Eigen::ArrayXXd DrawProjection::of_linear_draws(std::uint64_t seed, std::uint64_t first,
                                                Eigen::Index count) const {
  Eigen::MatrixXd normals(of_normals_.rows(), count), amplitudes(of_amplitudes_.rows(), count);
  campaign_.draw_linear(seed, first, normals, amplitudes);
  Eigen::MatrixXd product = offset_.replicate(count, 1);
  add_transposed_product(normals, of_normals_, product);
  if (amplitudes.rows() > 0) add_transposed_product(amplitudes, of_amplitudes_, product);
  return finished(std::move(product));
}

}  // namespace volcal
