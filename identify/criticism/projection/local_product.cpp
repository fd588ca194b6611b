#include "volcal/identify/criticism/projection/local_product.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/tile_array.h"
#include "volcal/identify/numeric/tile_kernel.h"

namespace volcal {
namespace {

constexpr Eigen::Index kGathered = 128;  // rows of a cell that are multiplied at once
static_assert(kColumnBlock % kTileAlignment == 0);

}  // namespace

LocalProduct::LocalProduct(std::shared_ptr<const LocalRows> rows,
                           const std::vector<std::vector<std::size_t>>& order)
    : rows_(std::move(rows)) {
  for (const std::vector<std::size_t>& part : order) {
    std::vector<SortedGroup>& groups = parts_.emplace_back();
    for (const LocalRows::Group& group : rows_->groups) groups.push_back(sorted(group, part));
  }
}

LocalProduct::SortedGroup LocalProduct::sorted(const LocalRows::Group& group,
                                               const std::vector<std::size_t>& order) {
  const auto coefficient = [&](Eigen::Index row) {
    return group.first[order[static_cast<std::size_t>(row)]];
  };
  SortedGroup result;
  result.width = group.derivatives.rows();
  result.row.resize(order.size());
  std::iota(result.row.begin(), result.row.end(), Eigen::Index{0});
  std::ranges::stable_sort(result.row, {}, coefficient);
  const auto count = static_cast<Eigen::Index>(order.size());
  result.derivatives.setZero(whole_lines(result.width), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index row = result.row[static_cast<std::size_t>(k)];
    const auto observation = static_cast<Eigen::Index>(order[static_cast<std::size_t>(row)]);
    result.derivatives.col(k).head(result.width) = group.derivatives.col(observation);
    if (result.cells.empty() || result.cells.back().coefficient != coefficient(row))
      result.cells.push_back({coefficient(row), k, k});
    ++result.cells.back().end;
  }
  return result;
}

Eigen::MatrixXd LocalProduct::zero_sums() const {
  return Eigen::MatrixXd::Zero(kColumnBlock, rows_->coefficients + kTileAlignment);
}

void LocalProduct::add(std::size_t part, const Eigen::MatrixXd& weighed, Eigen::MatrixXd& sums) const {
  const TileKernel& kernel = tile_kernel();
  Eigen::MatrixXd gathered(weighed.rows(), kGathered);
  for (const SortedGroup& group : parts_[part]) {
    for (const Cell& cell : group.cells) {
      for (Eigen::Index begin = cell.begin; begin < cell.end; begin += kGathered) {
        const Eigen::Index count = std::min(kGathered, cell.end - begin);
        for (Eigen::Index k = 0; k < count; ++k)
          gathered.col(k) = weighed.col(group.row[static_cast<std::size_t>(begin + k)]);
        kernel.multiply(
            {gathered.data(), gathered.rows(), static_cast<int>(gathered.rows())},
            {group.derivatives.col(begin).data(), group.derivatives.rows(), static_cast<int>(group.width)},
            static_cast<int>(count), true, sums.col(cell.coefficient).data(), sums.rows());
      }
    }
  }
}

void LocalProduct::combine(const Eigen::MatrixXd& sums, Eigen::Ref<Eigen::MatrixXd> products) const {
  for (const LocalRows::Combination& function : rows_->combinations) {
    const Eigen::MatrixXd own = sums(Eigen::seqN(0, products.cols()), function.coefficients).transpose();
    Eigen::MatrixXd combined = Eigen::MatrixXd::Zero(function.basis.cols(), products.cols());
    add_transposed_product(function.basis, own, combined);
    products.middleRows(function.column, combined.rows()) = combined;
  }
}

}  // namespace volcal
