#include "volcal/identify/criticism/search/heldout_errors.h"

#include <cmath>
#include <numbers>

#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/noise/shared_noise.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {
namespace {

/// A sequence with the places of its held-out observations.
struct HeldoutSequence {
  const NoiseSequence* sequence;
  SharedNoise shared;
  std::vector<std::size_t> place;  ///< in the sequence
  Eigen::MatrixXd shared_rows;     ///< B
};

std::vector<HeldoutSequence> heldout_sequences(const NoiseData& data, const std::vector<bool>& heldout,
                                               std::span<const NoiseParameters> noise) {
  std::vector<HeldoutSequence> all;
  for (const NoiseSequence& sequence : data.sequences) {
    HeldoutSequence held{&sequence, SharedNoise(sequence, noise[sequence.group]), {}, {}};
    for (std::size_t i = 0; i < sequence.observation.size(); ++i) {
      const std::size_t observation = sequence.observation[i];
      if (heldout[observation] && std::isfinite(data.sigma[observation])) held.place.push_back(i);
    }
    if (!held.place.empty()) all.push_back(std::move(held));
  }
  return all;
}

void find_shared_rows(std::vector<HeldoutSequence>& sequences, const Whitener& whitener,
                      const ColumnOf& column_of, Eigen::Index parameters, int threads) {
  bool any = false;
  for (HeldoutSequence& held : sequences) {
    held.shared_rows.setZero(static_cast<Eigen::Index>(held.place.size()), parameters);
    any = any || !held.shared.none();
  }
  if (!any) return;
  run_parallel(static_cast<std::size_t>(parameters), threads, [&](std::size_t parameter) {
    const auto column = static_cast<Eigen::Index>(parameter);
    const Eigen::VectorXd weights = whitener.weigh(column_of(column));
    for (HeldoutSequence& held : sequences) {
      if (held.shared.none()) continue;
      const Eigen::VectorXd product = held.shared.times(weights);
      for (std::size_t i = 0; i < held.place.size(); ++i) {
        held.shared_rows(static_cast<Eigen::Index>(i), column) =
            product[static_cast<Eigen::Index>(held.place[i])];
      }
    }
  });
}

/// Sigma of the held-out observations.
Eigen::MatrixXd noise_covariance(const HeldoutSequence& held, const NoiseData& data,
                                 const NoiseParameters& noise) {
  const auto count = static_cast<Eigen::Index>(held.place.size());
  Eigen::MatrixXd covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double value = held.shared.covariance(held.place[static_cast<std::size_t>(i)],
                                                  held.place[static_cast<std::size_t>(j)]);
      covariance(i, j) = covariance(j, i) = value;
    }
    const std::size_t observation = held.sequence->observation[held.place[static_cast<std::size_t>(i)]];
    const double white = noise.white * data.sigma[observation];
    const double long_part = data.length.empty() ? 0.0 : noise.per_metre * data.length[observation];
    covariance(i, i) += white * white + long_part * long_part;
  }
  return covariance;
}

}  // namespace

std::vector<HeldoutBlock> heldout_errors(const NoiseData& data, const std::vector<bool>& heldout,
                                         std::span<const NoiseParameters> noise, const Projector& projector,
                                         const RowsOf& rows_of, const ColumnOf& column_of, int threads) {
  std::vector<HeldoutSequence> sequences = heldout_sequences(data, heldout, noise);
  const Whitener whitener(without(data, heldout), noise);
  find_shared_rows(sequences, whitener, column_of, projector.parameters(), threads);
  std::vector<HeldoutBlock> blocks;
  for (const HeldoutSequence& held : sequences) {
    HeldoutBlock& block = blocks.emplace_back();
    for (const std::size_t place : held.place)
      block.observation.push_back(static_cast<Eigen::Index>(held.sequence->observation[place]));
    block.covariance = noise_covariance(held, data, noise[held.sequence->group]);
    // J A^-1 J^T - J A^-1 B^T - B A^-1 J^T = (J - B) A^-1 (J - B)^T - B A^-1 B^T
    const Eigen::MatrixXd apart = projector.rotated_rows(rows_of(block.observation) - held.shared_rows);
    add_gram_upper(apart, 1.0, block.covariance);
    add_gram_upper(projector.rotated_rows(held.shared_rows), -1.0, block.covariance);
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
