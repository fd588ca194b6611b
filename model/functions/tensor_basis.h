#pragma once
/// Functions of one to three variables f(u) = sum_j c_j B_j(u): products of cubic B-splines with equal pieces
/// (de Boor 1978, A Practical Guide to Splines, ch. XVII). Coefficients of the last variable stand next to
/// each other. Immutable, so thread-safe.

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "volcal/model/functions/basis.h"

namespace volcal {

class TensorBasis {
 public:
  /// Range of a variable, in its own unit, from < to, and into how many pieces it is cut, at least 1.
  struct Side {
    double from = 0.0;
    double to = 1.0;
    int pieces = 1;
  };

  explicit TensorBasis(std::vector<Side> sides);

  int size() const { return size_; }
  const std::vector<Side>& sides() const { return sides_; }
  /// Functions of each variable.
  int size(std::size_t side) const { return splines_[side]->size(); }
  /// All basis functions at a place, one value per variable. Beyond a range the last value is held and fades
  /// to zero over the length of one piece.
  Eigen::VectorXd row(std::span<const double> place) const;
  /// The same with the last value held for good.
  Eigen::VectorXd held_row(std::span<const double> place) const;
  /// Whether a value is outside its range by more than rounding.
  bool is_beyond(std::span<const double> place) const;
  /// Of the function with these coefficients over its range.
  double root_mean_square(const Eigen::VectorXd& coefficients) const;
  /// Where the functions of one variable are centred (Greville abscissae), 0..1 of its range.
  Eigen::VectorXd nodes(std::size_t side) const;
  /// The functions of one variable at equally spaced places of its range, places x functions.
  Eigen::MatrixXd samples(std::size_t side) const;

 private:
  std::vector<Side> sides_;
  std::vector<std::shared_ptr<const Basis>> splines_;
  int size_ = 1;
};

}  // namespace volcal
