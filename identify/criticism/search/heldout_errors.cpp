#include "volcal/identify/criticism/search/heldout_errors.h"

#include <Eigen/LU>
#include <atomic>
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

namespace {

void set_covariance(const Eigen::MatrixXd& covariance, HeldoutBlock& block) {
  block.expected = covariance.trace();
  block.squares = covariance.squaredNorm();
  auto lower = cholesky_lower(covariance);
  block.is_definite = lower.has_value();
  block.lower = lower ? *std::move(lower) : Eigen::MatrixXd(covariance.diagonal().cwiseSqrt().asDiagonal());
}

/// Of one block; the square of the spread in its place.
HeldoutFigures figures_of(double expected, double squares, const Eigen::VectorXd& left,
                          double log_likelihood) {
  return {.count = static_cast<double>(left.size()),
          .squares = left.squaredNorm(),
          .expected = expected,
          .spread = 2.0 * squares,
          .log_likelihood = log_likelihood};
}

double log_likelihood(double squares, double log_determinant, Eigen::Index count) {
  return -0.5 * (squares + log_determinant + static_cast<double>(count) * std::log(2.0 * std::numbers::pi));
}

HeldoutFigures sum(const std::vector<HeldoutFigures>& of_blocks) {
  HeldoutFigures all;
  for (const HeldoutFigures& each : of_blocks) {
    all.count += each.count;
    all.squares += each.squares;
    all.expected += each.expected;
    all.spread += each.spread;
    all.log_likelihood += each.log_likelihood;
  }
  all.spread = std::sqrt(all.spread);
  return all;
}

HeldoutFigures figures_of(const HeldoutBlock& block, const Eigen::VectorXd& left) {
  Eigen::MatrixXd whitened = left;
  solve_lower(block.lower, whitened);
  return figures_of(block.expected, block.squares, left,
                    log_likelihood(whitened.squaredNorm(), log_determinant(block.lower), left.size()));
}

/// With L L^T + M S M^T in the place of the block's covariance, S = diag(signs).
std::optional<HeldoutFigures> figures_with(const HeldoutBlock& block, const Eigen::MatrixXd& more,
                                           const Eigen::VectorXd& signs, const Eigen::VectorXd& left) {
  const Eigen::Index columns = more.cols();
  const Eigen::MatrixXd products = more.transpose() * more;
  const Eigen::MatrixXd turned = block.lower.triangularView<Eigen::Lower>().transpose() * more;
  const double expected = block.expected + signs.dot(products.diagonal());
  const double squares = block.squares + 2.0 * signs.dot(turned.colwise().squaredNorm().transpose()) +
                         (signs.asDiagonal() * products.cwiseProduct(products) * signs.asDiagonal()).sum();

  Eigen::MatrixXd whitened(more.rows(), columns + 1);
  whitened << more, left;
  solve_lower(block.lower, whitened);
  const Eigen::MatrixXd gram = whitened.transpose() * whitened;
  const Eigen::MatrixXd inner = Eigen::MatrixXd(signs.asDiagonal()) + gram.topLeftCorner(columns, columns);
  const Eigen::PartialPivLU<Eigen::MatrixXd> factor(inner);
  const double ratio = signs.prod() * factor.determinant();  // of the determinants with and without
  const Eigen::VectorXd across = gram.col(columns).head(columns);
  const double quadratic = gram(columns, columns) - across.dot(factor.solve(across));
  if (!(ratio > 0.0) || !(quadratic >= 0.0)) return std::nullopt;
  return figures_of(expected, squares, left,
                    log_likelihood(quadratic, log_determinant(block.lower) + std::log(ratio), left.size()));
}

}  // namespace

HeldoutErrors::HeldoutErrors(const NoiseData& data, const std::vector<bool>& heldout,
                             std::span<const NoiseParameters> noise, const Projector& projector,
                             const RowsOf& rows_of, const ColumnOf& column_of, int threads)
    : fixed_(std::make_shared<const Fixed>(data, heldout, noise)),
      shared_rows_(shared_rows(*fixed_, column_of, projector.parameters(), threads)),
      blocks_(fixed_->sequences.size()) {
  run_parallel(blocks_.size(), threads, [&](std::size_t k) {
    const Sequence& held = fixed_->sequences[k];
    HeldoutBlock& block = blocks_[k];
    for (const std::size_t place : held.place)
      block.observation.push_back(static_cast<Eigen::Index>(held.sequence->observation[place]));
    Eigen::MatrixXd covariance = held.noise_covariance(data, noise[held.sequence->group]);
    // J A^-1 J^T - J A^-1 B^T - B A^-1 J^T = (J - B) A^-1 (J - B)^T - B A^-1 B^T
    const Eigen::MatrixXd apart = projector.rotated_rows(rows_of(block.observation) - shared_rows_[k]);
    add_gram_upper(apart, 1.0, covariance);
    add_gram_upper(projector.rotated_rows(shared_rows_[k]), -1.0, covariance);
    symmetrise_from_upper(covariance);
    set_covariance(covariance, block);
  });
}

std::optional<HeldoutFigures> HeldoutErrors::figures_accepting(const Accepted& accepted,
                                                               const Eigen::VectorXd& residual,
                                                               int threads) const {
  const Eigen::Index more = accepted.columns.cols(), before = accepted.directions.rows() - more;
  const Rows further = shared_rows(
      *fixed_, [&](Eigen::Index k) -> Eigen::VectorXd { return accepted.columns.col(k); }, more, threads);
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(2 * more);
  signs.tail(more).setConstant(-1.0);
  std::vector<HeldoutFigures> of_blocks(blocks_.size());
  std::atomic<bool> definite{true};
  run_parallel(blocks_.size(), threads, [&](std::size_t k) {
    const HeldoutBlock& block = blocks_[k];
    const Eigen::MatrixXd shared = shared_rows_[k] * accepted.directions.topRows(before) +
                                   further[k] * accepted.directions.bottomRows(more);
    Eigen::MatrixXd both(shared.rows(), 2 * more);
    both << accepted.moved(block.observation, Eigen::all) - shared, shared;
    const auto figures =
        block.is_definite ? figures_with(block, both, signs, residual(block.observation)) : std::nullopt;
    if (figures) {
      of_blocks[k] = *figures;
    } else {
      definite = false;
    }
  });
  if (!definite) return std::nullopt;
  return sum(of_blocks);
}

HeldoutFigures heldout_figures(const std::vector<HeldoutBlock>& blocks, const Eigen::VectorXd& residual) {
  std::vector<HeldoutFigures> of_blocks;
  for (const HeldoutBlock& block : blocks)
    of_blocks.push_back(figures_of(block, residual(block.observation)));
  return sum(of_blocks);
}

}  // namespace volcal
