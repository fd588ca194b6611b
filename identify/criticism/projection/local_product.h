#pragma once
/// Products of the model's local columns (local_rows.h) with many columns side by side, knot cell by knot
/// cell.

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <vector>

#include "volcal/identify/noise/local_rows.h"

namespace volcal {

class LocalProduct {
 public:
  /// `order`: for each part, its observations in the order of the rows that are multiplied.
  LocalProduct(std::shared_ptr<const LocalRows> rows, const std::vector<std::vector<std::size_t>>& order);

  Eigen::Index columns() const { return rows_->columns(); }
  /// What add() adds to, for kColumnBlock columns.
  Eigen::MatrixXd zero_sums() const;
  /// Adds the products of a part's observations; `weighed`: whole lines of at most kColumnBlock columns x
  /// observations of the part.
  void add(std::size_t part, const Eigen::MatrixXd& weighed, Eigen::MatrixXd& sums) const;
  /// Products with the model's columns from those with coefficients: columns() x as many as `products` has.
  void combine(const Eigen::MatrixXd& sums, Eigen::Ref<Eigen::MatrixXd> products) const;

 private:
  /// Neighbours among a group's rows that depend on the same coefficients.
  struct Cell {
    Eigen::Index coefficient, begin, end;
  };
  /// A group's rows of one part, cell by cell.
  struct SortedGroup {
    std::vector<Eigen::Index> row;  ///< among those of the part
    std::vector<Cell> cells;
    Eigen::Index width = 0;
    Eigen::MatrixXd derivatives;  ///< width, filled up with zeros, x rows
  };
  static SortedGroup sorted(const LocalRows::Group& group, const std::vector<std::size_t>& order);

  std::shared_ptr<const LocalRows> rows_;
  std::vector<std::vector<SortedGroup>> parts_;
};

}  // namespace volcal
