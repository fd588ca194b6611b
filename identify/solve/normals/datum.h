#pragma once
/// The datum: what keeps anything from being counted twice. Functions are zero at home; straightness has no
/// least-squares slope over the travel (continuous, uniformly weighted, exact from the basis); transverse
/// motions of a rotary axis have in place of a zero at home no mean over the travel. The
/// constraints are linear and hold exactly: the solver works in orthonormal coordinates z of the constrained
/// space, raw = base + Z z, with one block of Z per function. Parameters can also be frozen at `base`.

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {

/// Rows A with A c = 0 for the coefficients c of one function.
Eigen::MatrixXd datum_constraints(const Basis& basis, ErrorSymbol symbol, const Axis& axis);

class DatumSpace {
 public:
  struct FunctionCoordinates {
    ErrorSymbol symbol;
    std::vector<int> raw;   ///< indices into the parameter vector
    Eigen::MatrixXd basis;  ///< raw coefficients from reduced ones
    int offset = 0;         ///< in the reduced vector

    int size() const { return static_cast<int>(basis.cols()); }
  };
  struct BlockCoordinates {
    std::size_t block = 0;  ///< index into ParameterLayout::blocks
    int raw_offset = 0;
    int offset = 0;  ///< in the reduced vector
    int size = 0;
  };

  /// `base` gives frozen parameters their values; functions and blocks for which `is_free` is false are
  /// frozen, and so is every block that is held (ParameterBlock::is_held).
  DatumSpace(const ParameterLayout& layout, const Machine& machine, Eigen::VectorXd base,
             const std::function<bool(ErrorSymbol)>& function_is_free,
             const std::function<bool(const ParameterBlock&)>& block_is_free);
  /// Everything free that is not held.
  DatumSpace(const ParameterLayout& layout, const Machine& machine, Eigen::VectorXd base);

  int size() const { return size_; }
  const std::vector<FunctionCoordinates>& functions() const { return functions_; }
  const std::vector<BlockCoordinates>& blocks() const { return blocks_; }

  Eigen::VectorXd raw(const Eigen::VectorXd& reduced) const;
  Eigen::VectorXd reduced(const Eigen::VectorXd& raw) const;
  Eigen::VectorXd reduce_gradient(const Eigen::VectorXd& raw_gradient) const;
  /// Z^T M Z of a symmetric raw matrix (full storage).
  Eigen::MatrixXd reduce_matrix(const Eigen::MatrixXd& raw_matrix) const;
  /// Z C Z^T, the raw covariance of a reduced one.
  Eigen::MatrixXd expand_covariance(const Eigen::MatrixXd& reduced_covariance) const;
  /// A row vector in raw parameters, in reduced coordinates: a Z.
  Eigen::MatrixXd reduce_rows(const Eigen::MatrixXd& raw_rows) const;
  /// Which reduced coordinates can change a reading that depends on these raw parameters.
  std::vector<bool> touched(const std::vector<int>& raw_parameters) const;

 private:
  Eigen::VectorXd base_;
  std::vector<FunctionCoordinates> functions_;
  std::vector<BlockCoordinates> blocks_;
  int size_ = 0;
};

}  // namespace volcal
