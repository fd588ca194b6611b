#include "volcal/identify/solve/normal_tile.h"

#include <algorithm>

#include "volcal/identify/solve/dense.h"

namespace volcal {
namespace {

constexpr int kMaxColumns = 128;

/// out[j * count + slot] = basis[j] * weight[slot]
template <int kSupport, int kCount>
double* outer_product(const double* basis, const double* weight, double scale, double* out) {
  for (int j = 0; j < kSupport; ++j) {
    const double b = scale * basis[j];
    for (int s = 0; s < kCount; ++s) *out++ = b * weight[s];
  }
  return out;
}

double* outer_product(const double* basis, int support, const double* weight, int count, double scale,
                      double* out) {
  if (support == 4 && count == 6) return outer_product<4, 6>(basis, weight, scale, out);
  for (int j = 0; j < support; ++j) {
    const double b = scale * basis[j];
    for (int s = 0; s < count; ++s) *out++ = b * weight[s];
  }
  return out;
}

// Compiled for several processors, chosen at run time. No sum is reordered and nothing contracted
// (-ffp-contract=off): all versions round alike.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define VOLCAL_PROCESSOR_VERSIONS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VOLCAL_PROCESSOR_VERSIONS
#endif

/// sum += factor * values
VOLCAL_PROCESSOR_VERSIONS
void add_scaled(const double* values, double factor, int size, double* sum) {
  for (int i = 0; i < size; ++i) sum[i] += factor * values[i];
}

}  // namespace

NormalTile::NormalTile(const ParameterLayout& layout, int shared_tail, Eigen::MatrixXd& matrix,
                       Eigen::VectorXd& gradient)
    : layout_(layout), shared_tail_(shared_tail), matrix_(matrix), gradient_(gradient) {
  for (const FunctionGroup& group : layout.groups) {
    segments_.push_back({group.offset, group.basis->support() * group.count()});
  }
  if (shared_tail > 0) segments_.push_back({layout.function_size, shared_tail});
  for (const Segment& segment : segments_) size_ += segment.size;
  rows_.resize(size_ + 1, kMaxColumns);
  tile_.resize(size_ + 1, size_ + 1);
}

void NormalTile::add(const RowJacobian& row, int channel, double scale, double error) {
  if (columns_ == kMaxColumns) flush();
  if (columns_ == 0) {
    begin_cell(row);
  } else if (row.start != start_) {
    flush();
    begin_cell(row);
  } else if (!std::equal(own_index_.begin(), own_index_.end(), row.tail_index.begin() + shared_tail_,
                         row.tail_index.end())) {
    flush_run();
    begin_run(row);
  }
  double* out = rows_.col(columns_).data();
  const double* basis = row.basis_value.data();
  const double* weight = row.weight[channel].data();
  for (const FunctionGroup& group : layout_.groups) {
    out = outer_product(basis, group.basis->support(), weight, group.count(), scale, out);
    basis += group.basis->support();
    weight += group.count();
  }
  const double* tail = row.tail_value[channel].data();
  for (int k = 0; k < shared_tail_; ++k) *out++ = scale * tail[k];
  *out = scale * error;
  double* own = own_.col(columns_).data();
  for (std::size_t k = 0; k < own_index_.size(); ++k)
    own[k] = scale * tail[shared_tail_ + static_cast<int>(k)];
  ++columns_;
}

void NormalTile::begin_cell(const RowJacobian& row) {
  start_ = row.start;
  for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
    segments_[g].parameter = layout_.groups[g].index(start_[g], 0);
  }
  begin_run(row);
}

void NormalTile::begin_run(const RowJacobian& row) {
  run_begin_ = columns_;
  own_index_.assign(row.tail_index.begin() + shared_tail_, row.tail_index.end());
  const auto own_size = static_cast<Eigen::Index>(own_index_.size());
  if (own_.rows() != own_size) own_.resize(own_size, kMaxColumns);
}

/// Products of the run's own parameters with themselves and with everything else.
void NormalTile::flush_run() {
  const auto own_size = own_.rows();
  product_.setZero(size_ + 1, own_size);
  square_.setZero(own_size, own_size);
  for (int column = run_begin_; column < columns_; ++column) {
    const double* own = own_.col(column).data();
    for (Eigen::Index k = 0; k < own_size; ++k) {
      add_scaled(rows_.col(column).data(), own[k], size_ + 1, product_.col(k).data());
      for (Eigen::Index i = 0; i <= k; ++i) square_(i, k) += own[i] * own[k];
    }
  }
  for (Eigen::Index k = 0; k < own_size; ++k) {
    const int column = own_index_[static_cast<std::size_t>(k)];
    const double* value = product_.col(k).data();
    for (const Segment& segment : segments_) {
      double* sum = &matrix_(segment.parameter, column);
      for (int i = 0; i < segment.size; ++i) sum[i] += *value++;
    }
    gradient_[column] += *value;
    for (Eigen::Index other = 0; other < own_size; ++other) {
      const int row = own_index_[static_cast<std::size_t>(other)];
      if (row <= column) matrix_(row, column) += square_(std::min(other, k), std::max(other, k));
    }
  }
}

void NormalTile::flush() {
  if (columns_ == 0) return;
  flush_run();
  outer_product_upper(rows_.data(), size_ + 1, columns_, tile_);
  int column = 0;
  for (std::size_t g = 0; g < segments_.size(); ++g) {
    for (int c = 0; c < segments_[g].size; ++c, ++column) {
      const double* value = tile_.col(column).data();
      for (std::size_t h = 0; h <= g; ++h) {
        const int count = h == g ? c + 1 : segments_[h].size;
        double* sum = &matrix_(segments_[h].parameter, segments_[g].parameter + c);
        for (int i = 0; i < count; ++i) sum[i] += value[i];
        value += count;
      }
    }
  }
  const double* value = tile_.col(size_).data();
  for (const Segment& segment : segments_) {
    gradient_.segment(segment.parameter, segment.size) +=
        Eigen::Map<const Eigen::VectorXd>(value, segment.size);
    value += segment.size;
  }
  columns_ = 0;
}

}  // namespace volcal
