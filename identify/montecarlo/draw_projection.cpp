#include "volcal/identify/montecarlo/draw_projection.h"

#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {

DrawProjection::DrawProjection(const RepeatedCampaign& campaign, const QuantitySet& quantities)
    : campaign_(campaign), set_(quantities) {
  const Eigen::Index count = set_.rows.rows();
  u_linear_ = bias_linear_ = unit_ = Eigen::ArrayXd::Zero(count);
  const Eigen::MatrixXd rows = all_rows();
  if (campaign.parameters() == 0) {  // nothing varies
    projection_ = Eigen::MatrixXd::Zero(0, rows.rows());
    of_normals_ = Eigen::MatrixXd::Zero(0, rows.rows());
    of_amplitudes_ = Eigen::MatrixXd::Zero(campaign.response().cols(), rows.rows());
    offset_ = Eigen::RowVectorXd::Zero(rows.rows());
    return;
  }
  projection_ = campaign.datum().reduce_rows(rows).transpose();
  of_normals_ = campaign.linear_root().transpose() * projection_;
  of_amplitudes_ = campaign.response().transpose() * projection_;
  offset_ = campaign.linear_bias().transpose() * projection_;
  for (const Eigen::MatrixXd* part : {&of_normals_, &of_amplitudes_}) {
    if (part->rows() > 0) u_linear_ += part->leftCols(count).colwise().squaredNorm().transpose().array();
  }
  u_linear_ = u_linear_.sqrt();
  bias_linear_ = offset_.head(count).transpose();
  set_unit();
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(rows.rows());
  scale.head(count) = (unit_ > 0.0).select(unit_.inverse(), 0.0);
  for (Eigen::MatrixXd* matrix : {&projection_, &of_normals_, &of_amplitudes_}) *matrix *= scale.asDiagonal();
  offset_ *= scale.asDiagonal();
  of_normals_ = upper_factor(std::move(of_normals_));
}

Eigen::MatrixXd DrawProjection::all_rows() const {
  Eigen::Index count = set_.rows.rows();
  for (const QuantitySet::Volume& volume : set_.volumes) count += volume.size.rows().rows();
  Eigen::MatrixXd rows(count, set_.rows.cols());
  rows.topRows(set_.rows.rows()) = set_.rows;
  Eigen::Index row = set_.rows.rows();
  for (const QuantitySet::Volume& volume : set_.volumes) {
    rows.middleRows(row, volume.size.rows().rows()) = volume.size.rows();
    row += volume.size.rows().rows();
  }
  return rows;
}

void DrawProjection::set_unit() {
  unit_ = u_linear_;
  for (const QuantitySet::Volume& volume : set_.volumes) {
    for (const std::size_t which : {volume.rms, volume.largest}) {
      double& unit = unit_[static_cast<Eigen::Index>(which)];
      if (!(unit > 0.0)) unit = volume.size.u();
    }
  }
}

Eigen::MatrixXd DrawProjection::with_sizes(Eigen::MatrixXd columns) const {
  Eigen::Index first = quantities();
  if (first == columns.cols()) return columns;
  for (const QuantitySet::Volume& volume : set_.volumes) {
    const Eigen::Index count = volume.size.rows().rows();
    const VolumeSize::Sizes sizes = volume.size.sizes(columns.middleCols(first, count));
    const auto rms = static_cast<Eigen::Index>(volume.rms),
               largest = static_cast<Eigen::Index>(volume.largest);
    columns.col(rms) = (sizes.rms - volume.size.rms()) / unit_[rms];
    columns.col(largest) = (sizes.largest - volume.size.largest()) / unit_[largest];
    first += count;
  }
  columns.conservativeResize(Eigen::NoChange, quantities());
  return columns;
}

Eigen::MatrixXd DrawProjection::of(const Eigen::MatrixXd& deviations) const {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(deviations.cols(), projection_.cols());
  add_transposed_product(deviations, projection_, columns);
  return with_sizes(std::move(columns));
}

Eigen::MatrixXd DrawProjection::of_linear_draws(std::uint64_t seed, std::uint64_t first,
                                                Eigen::Index count) const {
  Eigen::MatrixXd normals(of_normals_.rows(), count), amplitudes(of_amplitudes_.rows(), count);
  campaign_.draw_linear(seed, first, normals, amplitudes);
  Eigen::MatrixXd columns = offset_.replicate(count, 1);
  add_transposed_product_upper(normals, of_normals_, columns);
  if (amplitudes.rows() > 0) add_transposed_product(amplitudes, of_amplitudes_, columns);
  return with_sizes(std::move(columns));
}

}  // namespace volcal
