#include "volcal/identify/solve/normals/normal_tile.h"

#include <algorithm>

namespace volcal {
namespace {

constexpr int kMaxColumns = 48;  // rows of three cubic axes stay in the first-level cache

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

}  // namespace

NormalTile::NormalTile(const ParameterLayout& layout, int shared_tail, Eigen::MatrixXd& matrix,
                       Eigen::VectorXd& gradient)
    : layout_(layout),
      kernel_(tile_kernel()),
      shared_tail_(shared_tail),
      matrix_(matrix),
      gradient_(gradient) {
  for (const FunctionGroup& group : layout.groups) {
    segments_.push_back({group.offset, group.basis->support() * group.count()});
  }
  if (shared_tail > 0) segments_.push_back({layout.function_size, shared_tail});
  for (const Segment& segment : segments_) size_ += segment.size;
  reserve(kTileAlignment);
}

/// Makes room for rows with `own_size` own parameters, and as many more as the stride holds; nothing may be
/// gathered.
void NormalTile::reserve(int own_size) {
  stride_ = whole_lines(size_ + 1 + own_size);
  rows_.resize((stride_ + kTileAlignment) * kMaxColumns);
  tile_.resize(stride_ * whole_lines(size_ + 1));
  product_.resize(stride_ * whole_lines(stride_ - size_ - 1));
}

void NormalTile::add(const RowJacobian& row, int channel, double scale, double error) {
  if (columns_ == kMaxColumns) flush_rows();
  if (!in_cell_ || row.start != start_) {
    flush();
    begin_cell(row);
  } else if (!std::equal(own_index_.begin(), own_index_.end(), row.tail_index.begin() + shared_tail_,
                         row.tail_index.end())) {
    flush_run();
    begin_run(row);
  }
  double* out = rows_.data() + columns_ * stride_;
  const double* basis = row.basis_value.data();
  const double* weight = row.weight[channel].data();
  for (const FunctionGroup& group : layout_.groups) {
    const int support = group.basis->support();
    out = outer_product(basis, support, weight, group.count(), scale, out);
    basis += support;
    weight += group.count();
  }
  const double* tail = row.tail_value[channel].data();
  for (int k = 0; k < shared_tail_; ++k) *out++ = scale * tail[k];
  *out++ = scale * error;
  tail += shared_tail_;
  for (std::size_t k = 0; k < own_index_.size(); ++k) out[k] = scale * tail[k];
  ++columns_;
}

void NormalTile::begin_cell(const RowJacobian& row) {
  in_cell_ = true;
  start_ = row.start;
  for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
    segments_[g].parameter = layout_.groups[g].index(start_[g], 0);
  }
  begin_run(row);
}

void NormalTile::begin_run(const RowJacobian& row) {
  run_begin_ = columns_;
  const int own_size = static_cast<int>(row.tail_index.size()) - shared_tail_;
  if (size_ + 1 + own_size > stride_) {
    flush_rows();
    flush_cell();
    reserve(own_size);
  }
  own_index_.assign(row.tail_index.begin() + shared_tail_, row.tail_index.end());
}

/// Products of the run's own parameters with themselves and with everything else.
void NormalTile::flush_run() {
  const int own_size = static_cast<int>(own_index_.size());
  if (columns_ == run_begin_ || own_size == 0) return;
  const double* rows = rows_.data() + run_begin_ * stride_;
  kernel_.multiply({rows, stride_, size_ + 1 + own_size}, {rows + size_ + 1, stride_, own_size},
                   columns_ - run_begin_, false, product_.data(), stride_);
  for (int k = 0; k < own_size; ++k) {
    const int column = own_index_[static_cast<std::size_t>(k)];
    const double* value = product_.data() + k * stride_;
    for (const Segment& segment : segments_) {
      kernel_.add(value, 0, segment.size, 1, false, sums_at(segment.parameter, column), 0);
      value += segment.size;
    }
    gradient_[column] += *value++;
    for (int other = 0; other < own_size; ++other) {
      const int row = own_index_[static_cast<std::size_t>(other)];
      if (row <= column) matrix_(row, column) += value[other];
    }
  }
}

/// Brings the gathered rows into the cell's tile.
void NormalTile::flush_rows() {
  if (columns_ == 0) return;
  flush_run();
  kernel_.outer_upper(rows_.data(), stride_, size_ + 1, columns_, tile_is_filled_, tile_.data());
  tile_is_filled_ = true;
  columns_ = run_begin_ = 0;
}

void NormalTile::flush_cell() {
  if (!tile_is_filled_) return;
  const std::ptrdiff_t matrix_stride = matrix_.rows();
  int column = 0;
  for (std::size_t g = 0; g < segments_.size(); ++g) {
    const Segment& across = segments_[g];
    const double* value = tile_.data() + column * stride_;
    for (std::size_t h = 0; h <= g; ++h) {
      const Segment& down = segments_[h];
      kernel_.add(value, stride_, down.size, across.size, h == g, sums_at(down.parameter, across.parameter),
                  matrix_stride);
      value += down.size;
    }
    column += across.size;
  }
  const double* value = tile_.data() + size_ * stride_;
  for (const Segment& segment : segments_) {
    kernel_.add(value, 0, segment.size, 1, false, gradient_.data() + segment.parameter, 0);
    value += segment.size;
  }
  tile_is_filled_ = false;
}

void NormalTile::flush() {
  if (!in_cell_) return;
  flush_rows();
  flush_cell();
  in_cell_ = false;
}

}  // namespace volcal
