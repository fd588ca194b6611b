#pragma once
/// Sums of one share of the readings: rows that stand in the same knot cell are gathered and enter the normal
/// matrix as one dense product.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "volcal/identify/numeric/tile_array.h"
#include "volcal/identify/numeric/tile_kernel.h"
#include "volcal/model/observation/parameters.h"
#include "volcal/model/observation/row_jacobian.h"

namespace volcal {

class NormalTile {
 public:
  /// `shared_tail`: MeasurementModel::shared_tail_size(). The sums go to `matrix` (upper triangle) and
  /// `gradient`, both of the layout's size.
  NormalTile(const ParameterLayout& layout, int shared_tail, Eigen::MatrixXd& matrix,
             Eigen::VectorXd& gradient);

  /// Adds one observation: `scale` is the square root of its weight, `error` predicted minus reading.
  void add(const RowJacobian& row, int channel, double scale, double error);
  /// Brings everything added so far into the sums.
  void flush();

 private:
  /// Parameters that are contiguous both in the tile and in the parameter vector.
  struct Segment {
    int parameter;
    int size;
  };

  void begin_cell(const RowJacobian& row);
  void begin_run(const RowJacobian& row);
  void reserve(int own_size);
  void flush_run();
  void flush_rows();
  void flush_cell();
  double* sums_at(int row, int column) { return matrix_.data() + column * matrix_.rows() + row; }

  const ParameterLayout& layout_;
  const TileKernel& kernel_;
  int shared_tail_;
  Eigen::MatrixXd& matrix_;
  Eigen::VectorXd& gradient_;
  std::vector<Segment> segments_;
  std::vector<int> start_;      ///< the cell
  std::vector<int> own_index_;  ///< own parameters of the run: rows with the same station, dead path ...
  int size_ = 0;                ///< functions and shared tail of a row; error and own parameters follow
  std::ptrdiff_t stride_ = 0;
  int columns_ = 0;
  int run_begin_ = 0;
  bool in_cell_ = false;
  bool tile_is_filled_ = false;  ///< with earlier rows of the cell
  TileArray rows_;               ///< stride x observations
  TileArray tile_;               ///< of the cell: stride x (size + 1)
  TileArray product_;            ///< of the run: stride x own parameters
};

}  // namespace volcal
