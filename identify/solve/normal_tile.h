#pragma once
/// Sums of one share of the readings: rows that stand in the same knot cell are gathered and enter the normal
/// matrix as one dense product.

#include <Eigen/Core>
#include <vector>

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
  void flush_run();

  const ParameterLayout& layout_;
  int shared_tail_;
  Eigen::MatrixXd& matrix_;
  Eigen::VectorXd& gradient_;
  std::vector<Segment> segments_;
  std::vector<int> start_;      ///< the cell
  std::vector<int> own_index_;  ///< own parameters of the run: rows with the same station, dead path ...
  int size_ = 0;                ///< functions and shared tail of a row; the error follows as one more
  int columns_ = 0;
  int run_begin_ = 0;
  Eigen::MatrixXd rows_;  ///< (size + 1) x observations
  Eigen::MatrixXd own_;   ///< own parameters x observations
  Eigen::MatrixXd tile_;
  Eigen::MatrixXd product_;  ///< of the run: (size + 1) x own parameters
  Eigen::MatrixXd square_;   ///< of the run: own x own
};

}  // namespace volcal
