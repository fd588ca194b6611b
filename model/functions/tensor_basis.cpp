#include "volcal/model/functions/tensor_basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

constexpr int kDegree = 3;
constexpr int kSamplesPerPiece = 4;

std::shared_ptr<const Basis> spline(const TensorBasis::Side& side) {
  Axis range;
  range.travel_min = side.from;
  range.travel_max = side.to;
  FunctionSpec spec;
  spec.degree = kDegree;
  spec.breakpoints = uniform_breakpoints(range, side.pieces);
  return find_basis("bspline")->make(spec, range);
}

/// 1 within the range, 0 from one piece beyond it on.
double presence(const TensorBasis::Side& side, double at) {
  const double beyond = std::max({0.0, side.from - at, at - side.to});
  const double share = beyond * side.pieces / (side.to - side.from);
  return share >= 1.0 ? 0.0 : 0.5 * (1.0 + std::cos(std::numbers::pi * share));
}

}  // namespace

TensorBasis::TensorBasis(std::vector<Side> sides) : sides_(std::move(sides)) {
  for (const Side& side : sides_) {
    splines_.push_back(spline(side));
    size_ *= splines_.back()->size();
  }
}

Eigen::VectorXd TensorBasis::row(std::span<const double> place) const {
  Eigen::VectorXd row = Eigen::VectorXd::Ones(1);
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const double held = std::clamp(place[i], sides_[i].from, sides_[i].to);
    const Eigen::VectorXd own = presence(sides_[i], place[i]) * splines_[i]->row(held);
    Eigen::VectorXd product(row.size() * own.size());
    for (Eigen::Index k = 0; k < row.size(); ++k) product.segment(k * own.size(), own.size()) = row[k] * own;
    row = std::move(product);
  }
  return row;
}

Eigen::VectorXd TensorBasis::nodes(std::size_t side) const {
  const int pieces = sides_[side].pieces;
  Eigen::VectorXd nodes(size(side));
  for (int j = 0; j < nodes.size(); ++j) {
    double sum = 0.0;
    for (int k = 1; k <= kDegree; ++k) sum += std::clamp(j + k - kDegree, 0, pieces);
    nodes[j] = sum / (kDegree * pieces);
  }
  return nodes;
}

Eigen::MatrixXd TensorBasis::samples(std::size_t side) const {
  const int places = kSamplesPerPiece * sides_[side].pieces + 1;
  Eigen::MatrixXd values(places, size(side));
  for (int i = 0; i < places; ++i) {
    const double share = static_cast<double>(i) / (places - 1);
    values.row(i) = splines_[side]->row(sides_[side].from + share * (sides_[side].to - sides_[side].from));
  }
  return values;
}

}  // namespace volcal
