#include "volcal/identify/criticism/search/heldout_errors.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/noise/shared_noise.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {

/// A sequence with the places of its held-out observations.
struct HeldoutErrors::Sequence {
  std::shared_ptr<const NoiseSequence> sequence;  ///< that `shared` refers to
  SharedNoise shared;
  std::vector<std::size_t> place;  ///< in the sequence

  Eigen::MatrixXd noise_covariance(const NoiseData& data, const NoiseParameters& noise) const;
};

struct HeldoutErrors::Fixed {
  std::vector<Sequence> sequences;
  Whitener whitener;  ///< of the readings that are not held out

  Fixed(const NoiseData& data, const std::vector<bool>& heldout, std::span<const NoiseParameters> noise);
};

HeldoutErrors::Fixed::Fixed(const NoiseData& data, const std::vector<bool>& heldout,
                            std::span<const NoiseParameters> noise)
    : whitener(without(data, heldout), noise) {
  for (const NoiseSequence& sequence : data.sequences) {
    const auto own = std::make_shared<const NoiseSequence>(sequence);
    Sequence held{own, SharedNoise(*own, noise[own->group]), {}};
    for (std::size_t i = 0; i < own->observation.size(); ++i) {
      const std::size_t observation = own->observation[i];
      if (heldout[observation] && std::isfinite(data.sigma[observation])) held.place.push_back(i);
    }
    if (!held.place.empty()) sequences.push_back(std::move(held));
  }
}

/// B of every sequence.
HeldoutErrors::Rows HeldoutErrors::shared_rows(const Fixed& fixed, const ColumnOf& column_of,
                                               Eigen::Index columns, int threads) {
  bool any = false;
  Rows rows;
  for (const Sequence& held : fixed.sequences) {
    rows.emplace_back(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(held.place.size()), columns));
    any = any || !held.shared.none();
  }
  if (!any) return rows;
  run_parallel(static_cast<std::size_t>(columns), threads, [&](std::size_t parameter) {
    const auto column = static_cast<Eigen::Index>(parameter);
    const Eigen::VectorXd weights = fixed.whitener.weigh(column_of(column));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Sequence& held = fixed.sequences[k];
      if (held.shared.none()) continue;
      const Eigen::VectorXd product = held.shared.times(weights);
      for (std::size_t i = 0; i < held.place.size(); ++i)
        rows[k](static_cast<Eigen::Index>(i), column) = product[static_cast<Eigen::Index>(held.place[i])];
    }
  });
  return rows;
}

/// Sigma of the held-out observations.
Eigen::MatrixXd HeldoutErrors::Sequence::noise_covariance(const NoiseData& data,
                                                          const NoiseParameters& noise) const {
  const auto count = static_cast<Eigen::Index>(place.size());
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double value =
          shared.covariance(place[static_cast<std::size_t>(i)], place[static_cast<std::size_t>(j)]);
      covariance(i, j) = covariance(j, i) = value;
    }
    const std::size_t observation = sequence->observation[place[static_cast<std::size_t>(i)]];
    const double white = noise.white * data.sigma[observation];
    const double long_part = data.length.empty() ? 0.0 : noise.per_metre * data.length[observation];
    covariance(i, i) += white * white + long_part * long_part;
  }
  return covariance;
}

HeldoutErrors::HeldoutErrors(const NoiseData& data, const std::vector<bool>& heldout,
                             std::span<const NoiseParameters> noise, const Projector& projector,
                             const RowsOf& rows_of, const ColumnOf& column_of, int threads)
    : fixed_(std::make_shared<const Fixed>(data, heldout, noise)),
      shared_rows_(shared_rows(*fixed_, column_of, projector.parameters(), threads)) {
  for (std::size_t k = 0; k < fixed_->sequences.size(); ++k) {
    const Sequence& held = fixed_->sequences[k];
    HeldoutBlock& block = blocks_.emplace_back();
    for (const std::size_t place : held.place)
      block.observation.push_back(static_cast<Eigen::Index>(held.sequence->observation[place]));
    block.covariance = held.noise_covariance(data, noise[held.sequence->group]);
    // J A^-1 J^T - J A^-1 B^T - B A^-1 J^T = (J - B) A^-1 (J - B)^T - B A^-1 B^T
    const Eigen::MatrixXd apart = projector.rotated_rows(rows_of(block.observation) - shared_rows_[k]);
    add_gram_upper(apart, 1.0, block.covariance);
    add_gram_upper(projector.rotated_rows(shared_rows_[k]), -1.0, block.covariance);
    symmetrise_from_upper(block.covariance);
  }
}

std::vector<HeldoutBlock> HeldoutErrors::accepting(const Eigen::MatrixXd& columns, const Projector& projector,
                                                   const RowsOf& rows_of, int threads) const {
  const Eigen::Index more = columns.cols();
  const Rows further = shared_rows(
      *fixed_, [&](Eigen::Index k) -> Eigen::VectorXd { return columns.col(k); }, more, threads);
  std::vector<HeldoutBlock> blocks = blocks_;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    HeldoutBlock& block = blocks[k];
    Eigen::MatrixXd rows(shared_rows_[k].rows(), shared_rows_[k].cols() + more);
    rows << shared_rows_[k], further[k];
    add_gram_upper(projector.last_rotated_rows(rows, more), -1.0, block.covariance);
    rows.leftCols(shared_rows_[k].cols()) = rows_of(block.observation) - shared_rows_[k];
    rows.rightCols(more) = columns(block.observation, Eigen::all) - further[k];
    add_gram_upper(projector.last_rotated_rows(rows, more), 1.0, block.covariance);
    symmetrise_from_upper(block.covariance);
  }
  return blocks;
}

HeldoutFigures heldout_figures(const std::vector<HeldoutBlock>& blocks, const Eigen::VectorXd& residual) {
  HeldoutFigures figures;
  double variance = 0.0;
  for (const HeldoutBlock& block : blocks) {
    Eigen::MatrixXd left = residual(block.observation);
    const auto count = static_cast<double>(left.size());
    figures.count += count;
    figures.squares += left.squaredNorm();
    figures.expected += block.covariance.trace();
    variance += 2.0 * block.covariance.squaredNorm();
    auto lower = cholesky_lower(block.covariance);
    if (!lower) lower = block.covariance.diagonal().cwiseSqrt().asDiagonal();  // x not determined: rounding
    solve_lower(*lower, left);
    figures.log_likelihood -=
        0.5 * (left.squaredNorm() + log_determinant(*lower) + count * std::log(2.0 * std::numbers::pi));
  }
  figures.spread = std::sqrt(variance);
  return figures;
}

}  // namespace volcal
