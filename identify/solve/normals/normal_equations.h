#pragma once
/// Weighted normal equations of a campaign, accumulated without storing a Jacobian. Where the readings'
/// positions recur, products are summed by pairs of positions (pair_sums.h); elsewhere readings are visited
/// by knot cell, so that the active coefficients of a batch are the same and its outer products are one dense
/// matrix product. Sums run over chunks fixed by the number of readings: results do not depend on the number
/// of threads.

#include <Eigen/Core>
#include <mutex>
#include <optional>
#include <vector>

#include "volcal/identify/solve/normals/pair_sums.h"
#include "volcal/model/observation/block_model.h"
#include "volcal/model/observation/measurement_model.h"

namespace ceres {
class LossFunction;
}

namespace volcal {

/// M = J^T W J (upper triangle filled until symmetrised), g = J^T W e with e = predicted - reading,
/// cost = 1/2 sum rho(w e^2).
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double cost = 0.0;
  double squares = 0.0;  ///< sum of w e^2, loss not applied
  std::size_t observations = 0;
};

/// Observation numbering: setup by setup, row by row, channel by channel.
class ReadingIndex {
 public:
  explicit ReadingIndex(const MeasurementModel& model);

  struct Reading {
    std::uint32_t setup;
    std::uint32_t row;
  };
  std::size_t observations() const { return observations_; }
  std::size_t first_observation(std::size_t setup, std::size_t row) const {
    return first_[setup] + row * static_cast<std::size_t>(model_.bound(setup).channels());
  }
  /// Observations that the campaign leaves out, ascending.
  std::vector<std::size_t> left_out() const;
  /// Readings sorted by knot cell, then setup.
  const std::vector<Reading>& sorted() const;
  const MeasurementModel& model() const { return model_; }
  const BlockModel& blocks() const { return blocks_; }

 private:
  const MeasurementModel& model_;
  BlockModel blocks_;
  std::vector<std::size_t> first_;
  std::size_t observations_ = 0;
  mutable std::once_flag is_sorted_;  ///< few campaigns need it
  mutable std::vector<Reading> sorted_;
};

/// What an accumulation computes: M costs more than all the rest.
enum class Sums { All, AllButMatrix };

class NormalAccumulator {
 public:
  /// `weight`: 1/sigma^2 per observation, 0 = left out. `loss` may be null (least squares). `share`: one
  /// block of readings in so many is summed, always the same ones, scattered over the campaign.
  NormalAccumulator(const ReadingIndex& index, const std::vector<double>& weight,
                    const ceres::LossFunction* loss, int threads, std::size_t share = 1);

  /// All readings, or only those of setups for which `include[setup]`. The sums hold until the next call;
  /// AllButMatrix leaves an undefined M.
  const NormalEquations& accumulate(const Eigen::VectorXd& parameters,
                                    const std::vector<bool>* include = nullptr, Sums what = Sums::All);

 private:
  /// Of one chunk, kept because memory is slow to come by; the first becomes the total.
  struct Chunk {
    NormalEquations sums;
    std::optional<GradientSums> gradient;
    std::optional<PairSums> pairs;
    BlockLevers levers;
    BlockLinearization linearized;
    TileArray rows;
  };

  std::vector<Chunk> make_chunks() const;
  void add_blocks(std::size_t chunk, const Eigen::VectorXd& parameters, const TabulatedFunctions& tabulated,
                  const std::vector<bool>* include, Sums what, Chunk& out) const;
  void add_block(const ReadingBlock& block, Sums what, Chunk& out) const;
  void add_by_cell(std::size_t chunk, const Eigen::VectorXd& parameters, const TabulatedFunctions& tabulated,
                   const std::vector<bool>* include, NormalEquations& sums) const;
  double observe(std::size_t observation, double error, NormalEquations& sums) const;
  void collect(Sums what);
  std::size_t begin_of(std::size_t chunk, std::size_t count) const {
    return in_share(count) * chunk / chunks_.size();
  }
  std::size_t in_share(std::size_t count) const { return (count + share_ - 1) / share_; }
  std::size_t item(std::size_t of_share, std::size_t count) const;

  const ReadingIndex& index_;
  const std::vector<double>& weight_;
  const ceres::LossFunction* loss_;
  int threads_;
  std::size_t share_;
  bool by_pairs_;
  std::vector<Chunk> chunks_;
};

}  // namespace volcal
