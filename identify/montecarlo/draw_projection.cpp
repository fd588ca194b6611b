#include "volcal/identify/montecarlo/draw_projection.h"

#include <cmath>
#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {

DrawProjection::DrawProjection(const RepeatedCampaign& campaign, const QuantitySet& quantities)
    : campaign_(campaign), set_(quantities) {
  const Eigen::Index count = set_.rows.rows();
  if (campaign.parameters() == 0) {  // nothing varies
    projection_ = Eigen::MatrixXd::Zero(0, count);
    of_normals_ = Eigen::MatrixXd::Zero(0, count);
    of_amplitudes_ = Eigen::MatrixXd::Zero(campaign.response().cols(), count);
    offset_ = Eigen::RowVectorXd::Zero(count);
    u_linear_ = bias_linear_ = unit_ = Eigen::ArrayXd::Zero(count);
    return;
  }
  projection_ = campaign.datum().reduce_rows(set_.rows).transpose();
  of_normals_ = campaign.linear_root().transpose() * projection_;
  of_amplitudes_ = campaign.response().transpose() * projection_;
  offset_ = campaign.linear_bias().transpose() * projection_;
  u_linear_ = Eigen::ArrayXd::Zero(count);
  for (const Eigen::MatrixXd* part : {&of_normals_, &of_amplitudes_}) {
    if (part->rows() > 0) u_linear_ += part->colwise().squaredNorm().transpose().array();
  }
  u_linear_ = u_linear_.sqrt();
  bias_linear_ = offset_.transpose();
  set_unit();
  const Eigen::VectorXd scale = (unit_ > 0.0).select(unit_.inverse(), 0.0);
  for (Eigen::MatrixXd* matrix : {&projection_, &of_normals_, &of_amplitudes_}) *matrix *= scale.asDiagonal();
  offset_ *= scale.asDiagonal();
  of_normals_ = upper_factor(std::move(of_normals_));
}

void DrawProjection::set_unit() {
  unit_ = u_linear_;
  for (const QuantitySet::Volume& volume : set_.volumes) {
    double squares = 0.0;
    for (const auto& component : volume.components) {
      const double u = component ? u_linear_[static_cast<Eigen::Index>(*component)] : 0.0;
      squares += u * u;
    }
    for (const std::size_t which : {volume.rms, volume.largest}) {
      double& unit = unit_[static_cast<Eigen::Index>(which)];
      if (!(unit > 0.0)) unit = std::sqrt(squares / static_cast<double>(volume.components.size()));
    }
  }
}

void DrawProjection::add_sizes(Eigen::MatrixXd& t) const {
  Eigen::ArrayXd square(t.rows()), squares(t.rows()), most(t.rows());
  for (const QuantitySet::Volume& volume : set_.volumes) {
    const VolumeSizes estimate = volume_sizes(volume.error);
    squares.setZero();
    most.setZero();
    for (std::size_t k = 0; k < volume.components.size(); ++k) {
      const double error = volume.error[static_cast<Eigen::Index>(k)];
      if (k % 3 == 0) square.setZero();
      if (const auto& component = volume.components[k]) {
        const auto column = static_cast<Eigen::Index>(*component);
        square += (t.col(column).array() * unit_[column] + error).square();
      } else {
        square += error * error;
      }
      if (k % 3 != 2) continue;
      squares += square;
      most = most.max(square);
    }
    const auto rms = static_cast<Eigen::Index>(volume.rms),
               largest = static_cast<Eigen::Index>(volume.largest);
    const double share = 3.0 / static_cast<double>(volume.components.size());
    t.col(rms) = ((squares * share).sqrt() - estimate.rms) / unit_[rms];
    t.col(largest) = (most.sqrt() - estimate.largest) / unit_[largest];
  }
}

Eigen::MatrixXd DrawProjection::of(const Eigen::MatrixXd& deviations) const {
  Eigen::MatrixXd t = Eigen::MatrixXd::Zero(deviations.cols(), projection_.cols());
  add_transposed_product(deviations, projection_, t);
  add_sizes(t);
  return t;
}

Eigen::MatrixXd DrawProjection::of_linear_draws(std::uint64_t seed, std::uint64_t first,
                                                Eigen::Index count) const {
  Eigen::MatrixXd normals(of_normals_.rows(), count), amplitudes(of_amplitudes_.rows(), count);
  campaign_.draw_linear(seed, first, normals, amplitudes);
  Eigen::MatrixXd t = offset_.replicate(count, 1);
  add_transposed_product_upper(normals, of_normals_, t);
  if (amplitudes.rows() > 0) add_transposed_product(amplitudes, of_amplitudes_, t);
  add_sizes(t);
  return t;
}

}  // namespace volcal
