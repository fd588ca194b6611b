#pragma once
/// Normal matrix of readings that meet the same positions again and again, as on grids. The rows' parameters
/// come in segments: the functions of a group, which all see the basis at the position of its axis; the
/// parameters of every reading; a reading's own. Products of two segments' derivatives are summed per pair
/// of their positions, and the bases multiply the sums instead of every product:
///
///   M_gh = sum over pairs (p, r) of (b_g(p) b_h(r)^T) (x) sum over readings at (p, r) of w_g w_h^T,
///
/// exact. A reading then costs 6 x 6 products per pair of axes, not 24 x 24 with cubic splines.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "volcal/identify/numeric/tile_array.h"
#include "volcal/model/observation/block_model.h"

namespace volcal {

class PairSums {
 public:
  /// `model` must outlive the object.
  explicit PairSums(const BlockModel& model);

  /// Whether positions recur so often that pairs are less work than products of whole rows, with tables of
  /// bounded size.
  static bool pay(const BlockModel& model);

  void set_zero();
  /// Rows of a block as BlockModel::make_rows() makes them, from the beginning of a TileArray on.
  void add(const ReadingBlock& block, const double* rows);
  /// Adds the sums of others, in their order for every number of threads.
  void add(std::span<const PairSums* const> others, int threads);
  /// Adds J^T J of all rows to the upper triangle of `matrix`; below the diagonal it is changed, too. Pairs
  /// of segments have parts of the matrix of their own, which threads share.
  void add_to(Eigen::MatrixXd& matrix, int threads) const;

 private:
  struct Segment {
    int begin = 0;              ///< in a row
    int size = 0;               ///< derivatives
    int stride = 0;             ///< size, filled up
    std::size_t positions = 1;  ///< groups: of the axis; own parameters: their lists
    bool is_group = false;
  };
  /// Sums of two segments: one block per pair of positions, or per position where both have the same.
  struct Pair {
    std::size_t down, across;
    bool same_position;
    std::size_t begin;   ///< in sums_
    std::size_t blocks;  ///< down.stride x across.size each
  };

  static std::vector<Segment> segments_of(const BlockModel& model);
  static std::vector<Pair> pairs_of(const BlockModel& model, const std::vector<Segment>& segments);
  std::size_t block_size(const Pair& pair) const {
    return static_cast<std::size_t>(segments_[pair.down].stride) *
           static_cast<std::size_t>(segments_[pair.across].size);
  }
  const std::uint32_t* positions_of(std::size_t segment, const ReadingBlock& block,
                                    std::uint32_t* constant) const;
  void add_group_pair(const Pair& pair, Eigen::MatrixXd& matrix) const;
  void add_pair(const Pair& pair, Eigen::MatrixXd& matrix) const;
  int spread(std::size_t segment, std::size_t position, int k, int* parameter, double* factor) const;

  const BlockModel& model_;
  std::vector<Segment> segments_;
  std::vector<Pair> pairs_;
  std::vector<int> shared_parameters_;
  TileArray sums_;
};

}  // namespace volcal
