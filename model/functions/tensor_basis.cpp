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
constexpr double kSameEnd = 1e-9;  // of the range

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
  double share = 1.0;
  for (std::size_t i = 0; i < sides_.size(); ++i) share *= presence(sides_[i], place[i]);
  return share * held_row(place);
}

Eigen::VectorXd TensorBasis::held_row(std::span<const double> place) const {
  Eigen::VectorXd row = Eigen::VectorXd::Ones(1);
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Eigen::VectorXd own = splines_[i]->row(std::clamp(place[i], sides_[i].from, sides_[i].to));
    Eigen::VectorXd product(row.size() * own.size());
    for (Eigen::Index k = 0; k < row.size(); ++k) product.segment(k * own.size(), own.size()) = row[k] * own;
    row = std::move(product);
  }
  return row;
}

bool TensorBasis::is_beyond(std::span<const double> place) const {
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const double margin = kSameEnd * (sides_[i].to - sides_[i].from);
    if (place[i] < sides_[i].from - margin || place[i] > sides_[i].to + margin) return true;
  }
  return false;
}

double TensorBasis::root_mean_square(const Eigen::VectorXd& coefficients) const {
  Eigen::MatrixXd values = coefficients;  // of the variables so far at their samples, one after the other
  Eigen::Index places = 1;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Eigen::MatrixXd along = samples(i);
    const Eigen::Index own = along.cols(), rest = values.size() / places / own;
    Eigen::VectorXd next(places * along.rows() * rest);
    for (Eigen::Index place = 0; place < places; ++place) {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      const Eigen::Map<const RowMajor> block(values.data() + place * own * rest, own, rest);
      Eigen::Map<RowMajor>(next.data() + place * along.rows() * rest, along.rows(), rest) = along * block;
    }
    places *= along.rows();
    values = next;
  }
  return values.norm() / std::sqrt(static_cast<double>(values.size()));
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
