#pragma once
/// Columns of a linear model in the form in which they arise: an observation depends on a few neighbouring
/// coefficients of every group of functions, and the datum combines the coefficients of one function. What
/// the products of dense columns cost is a multiple of what these cost.

#include <Eigen/Core>
#include <vector>

namespace volcal {

struct LocalRows {
  /// Functions of one axis that share a basis.
  struct Group {
    std::vector<Eigen::Index> first;  ///< per observation: the first coefficient it depends on
    Eigen::MatrixXd derivatives;      ///< neighbouring coefficients x observations
  };
  /// Columns of one function from its coefficients.
  struct Combination {
    std::vector<int> coefficients;
    Eigen::MatrixXd basis;    ///< coefficients x columns
    Eigen::Index column = 0;  ///< the first
  };
  std::vector<Group> groups;
  std::vector<Combination> combinations;  ///< of the first columns() columns, all of them
  Eigen::Index coefficients = 0;

  Eigen::Index columns() const {
    return combinations.empty() ? 0 : combinations.back().column + combinations.back().basis.cols();
  }
};

}  // namespace volcal
