#include "volcal/identify/solve/normals/pair_sums.h"

#include <algorithm>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/model/kinematics/vector_loops.h"

namespace volcal {
namespace {

constexpr std::size_t kMostNumbers = std::size_t{1} << 20;  // of a table: 8 MiB
constexpr std::ptrdiff_t kNumbersAtOnce = 8192;             // of sums that are joined
constexpr std::size_t kMostWork = 4;  // spreading the sums may take 1/4 of the work of whole rows

/// kRowAlignment numbers, which the compiler puts into as few registers as there are.
using Octet [[gnu::vector_size(64), gnu::may_alias]] = double;
static_assert(sizeof(Octet) == BlockModel::kRowAlignment * sizeof(double));
static_assert(BlockModel::kRowAlignment == kTileAlignment);

/// Rows of two segments, and where the sums of each row stand.
struct RowPair {
  const double* down;
  const double* across;
  std::ptrdiff_t width;  ///< from row to row
  int rows;
  const std::size_t* place;
};

/// kColumns columns of sums += down across^T, kRowAlignment rows of them; `stride`: from column to column.
/// Sums stay in registers while the position does not change.
template <int kColumns>
[[gnu::always_inline]] inline void add_columns(const RowPair& pair, std::ptrdiff_t stride, double* sums) {
  Octet sum[kColumns];
  const double* down = pair.down;
  const double* across = pair.across;
  for (int row = 0; row < pair.rows;) {
    const std::size_t place = pair.place[row];
    double* const block = sums + place;
    for (int k = 0; k < kColumns; ++k) sum[k] = *reinterpret_cast<const Octet*>(block + k * stride);
    for (; row < pair.rows && pair.place[row] == place; ++row, down += pair.width, across += pair.width) {
      const Octet of_row = *reinterpret_cast<const Octet*>(down);
      for (int k = 0; k < kColumns; ++k) sum[k] += of_row * across[k];
    }
    for (int k = 0; k < kColumns; ++k) *reinterpret_cast<Octet*>(block + k * stride) = sum[k];
  }
}

/// kRowAlignment rows of sums, `columns` of them, at most 8.
VOLCAL_VECTOR_LOOPS void add_octet(const RowPair& pair, int columns, std::ptrdiff_t stride, double* sums) {
  switch (columns) {
    case 1:
      return add_columns<1>(pair, stride, sums);
    case 2:
      return add_columns<2>(pair, stride, sums);
    case 3:
      return add_columns<3>(pair, stride, sums);
    case 4:
      return add_columns<4>(pair, stride, sums);
    case 5:
      return add_columns<5>(pair, stride, sums);
    case 6:
      return add_columns<6>(pair, stride, sums);
    case 7:
      return add_columns<7>(pair, stride, sums);
    default:
      return add_columns<8>(pair, stride, sums);
  }
}

/// sums(down, across) += a(down) b(across) for each row; `down` is a multiple of kRowAlignment.
void add_products(RowPair pair, int down, int across, double* sums) {
  constexpr int kMostColumns = 8;
  const double* const first = pair.across;
  const std::ptrdiff_t stride = down;
  for (int i = 0; i < down; i += BlockModel::kRowAlignment, pair.down += BlockModel::kRowAlignment) {
    for (int k = 0; k < across; k += kMostColumns) {
      pair.across = first + k;
      add_octet(pair, std::min(kMostColumns, across - k), stride, sums + k * stride + i);
    }
  }
}

VOLCAL_VECTOR_LOOPS void add_multiple(const double* __restrict from, double factor, int size,
                                      double* __restrict to) {
  for (int i = 0; i < size; ++i) to[i] += factor * from[i];
}

bool any(const double* numbers, std::size_t count) {
  return std::any_of(numbers, numbers + count, [](double v) { return v != 0.0; });
}

}  // namespace

std::vector<PairSums::Segment> PairSums::segments_of(const BlockModel& model) {
  std::vector<Segment> segments;
  const auto add = [&](int size, std::size_t positions, bool is_group) {
    const std::size_t number = segments.size();
    const int begin = model.segment_begin(number);
    segments.push_back({begin, size, model.segment_begin(number + 1) - begin, positions, is_group});
  };
  const auto& groups = model.model().layout().groups;
  for (std::size_t g = 0; g < groups.size(); ++g)
    add(groups[g].count(), model.model().tables().positions(g), true);
  add(model.model().shared_tail_size(), 1, false);
  std::size_t own = 0;
  for (const auto& parameters : model.own_parameters()) own = std::max(own, parameters.size());
  add(static_cast<int>(own), model.own_parameters().size(), false);
  return segments;
}

std::vector<PairSums::Pair> PairSums::pairs_of(const BlockModel& model,
                                               const std::vector<Segment>& segments) {
  const auto& groups = model.model().layout().groups;
  std::vector<Pair> pairs;
  std::size_t begin = 0;
  for (std::size_t across = 0; across < segments.size(); ++across) {
    for (std::size_t down = 0; down <= across; ++down) {
      const Segment& a = segments[down];
      const Segment& b = segments[across];
      if (a.size == 0 || b.size == 0) continue;
      const bool same = down == across || (b.is_group && groups[down].axis == groups[across].axis);
      const std::size_t blocks = same ? a.positions : a.positions * b.positions;
      pairs.push_back({down, across, same, begin, blocks});
      begin += blocks * static_cast<std::size_t>(a.stride) * static_cast<std::size_t>(b.size);
    }
  }
  return pairs;
}

bool PairSums::pay(const BlockModel& model) {
  const std::vector<Segment> segments = segments_of(model);
  const auto& groups = model.model().layout().groups;
  const auto parameters = [&](std::size_t s) {
    return static_cast<std::size_t>(segments[s].size) *
           (segments[s].is_group ? static_cast<std::size_t>(groups[s].basis->support()) : 1);
  };
  std::size_t numbers = 0, work = 0, of_a_row = 0, readings = 0;
  for (const Pair& pair : pairs_of(model, segments)) {
    const std::size_t products = parameters(pair.down) * parameters(pair.across);
    numbers += pair.blocks * static_cast<std::size_t>(segments[pair.down].stride) *
               static_cast<std::size_t>(segments[pair.across].size);
    work += pair.blocks * products;
    of_a_row += products;
  }
  for (const ReadingBlock& block : model.blocks()) readings += static_cast<std::size_t>(block.size);
  return numbers <= kMostNumbers && kMostWork * work <= readings * of_a_row;
}

PairSums::PairSums(const BlockModel& model)
    : model_(model),
      segments_(segments_of(model)),
      pairs_(pairs_of(model, segments_)),
      shared_parameters_(model.shared_parameters()) {
  if (pairs_.empty()) return;
  const Pair& last = pairs_.back();
  sums_.resize(static_cast<std::ptrdiff_t>(last.begin + last.blocks * block_size(last)));
}

void PairSums::set_zero() { std::fill_n(sums_.data(), sums_.size(), 0.0); }

void PairSums::add(std::span<const PairSums* const> others, int threads) {
  const std::ptrdiff_t size = sums_.size(), parts = (size + kNumbersAtOnce - 1) / kNumbersAtOnce;
  run_parallel(static_cast<std::size_t>(parts), threads, [&](std::size_t part) {
    const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(part) * kNumbersAtOnce;
    const auto count = static_cast<int>(std::min(kNumbersAtOnce, size - begin));
    for (const PairSums* other : others)
      add_multiple(other->sums_.data() + begin, 1.0, count, sums_.data() + begin);
  });
}

/// Numbers of the positions where the block's readings stand.
const std::uint32_t* PairSums::positions_of(std::size_t segment, const ReadingBlock& block,
                                            std::uint32_t* constant) const {
  if (segments_[segment].is_group) {
    const FunctionGroup& group = model_.model().layout().groups[segment];
    return model_.model().tables().entries(block.setup, index_of(group.axis)).data() + block.first_row;
  }
  const bool is_own = segment + 1 == segments_.size();
  std::fill_n(constant, block.size, is_own ? block.own : 0U);
  return constant;
}

void PairSums::add(const ReadingBlock& block, const double* rows) {
  for (const Pair& pair : pairs_) {
    std::uint32_t constant[2][kLanes];
    std::size_t place[kLanes];
    const std::uint32_t* const down = positions_of(pair.down, block, constant[0]);
    const std::uint32_t* const across = positions_of(pair.across, block, constant[1]);
    const std::size_t size = block_size(pair), stride = segments_[pair.across].positions;
    for (int i = 0; i < block.size; ++i)
      place[i] = pair.begin + size * (pair.same_position ? down[i] : down[i] * stride + across[i]);
    add_products({rows + segments_[pair.down].begin, rows + segments_[pair.across].begin, model_.row_width(),
                  block.size, place},
                 segments_[pair.down].stride, segments_[pair.across].size, sums_.data());
  }
}

void PairSums::add_to(Eigen::MatrixXd& matrix, int threads) const {
  run_parallel(pairs_.size(), threads, [&](std::size_t i) {
    const Pair& pair = pairs_[i];
    if (segments_[pair.across].is_group) {
      add_group_pair(pair, matrix);
    } else {
      add_pair(pair, matrix);
    }
  });
}

/// Both segments are functions: contiguous coefficients down a column.
void PairSums::add_group_pair(const Pair& pair, Eigen::MatrixXd& matrix) const {
  const MeasurementModel& model = model_.model();
  const FunctionGroup& down = model.layout().groups[pair.down];
  const FunctionGroup& across = model.layout().groups[pair.across];
  const int support = down.basis->support(), across_support = across.basis->support();
  const int stride = segments_[pair.down].stride, size = support * down.count();
  std::vector<double> column(static_cast<std::size_t>(size));
  const std::size_t across_positions = segments_[pair.across].positions;
  for (std::size_t b = 0; b < pair.blocks; ++b) {
    const double* block = sums_.data() + pair.begin + b * block_size(pair);
    if (!any(block, block_size(pair))) continue;
    const std::size_t p = pair.same_position ? b : b / across_positions;
    const std::size_t r = pair.same_position ? b : b % across_positions;
    const double* const basis = model.tables().values(pair.down, support, p);
    const double* const across_basis = model.tables().values(pair.across, across_support, r);
    const int row = down.index(model.tables().start(pair.down, p), 0);
    const int first = model.tables().start(pair.across, r);
    for (int slot = 0; slot < across.count(); ++slot, block += stride) {
      std::size_t at = 0;
      for (int j = 0; j < support; ++j) {
        for (int i = 0; i < down.count(); ++i) column[at++] = basis[j] * block[i];
      }
      for (int l = 0; l < across_support; ++l) {
        add_multiple(column.data(), across_basis[l], size, &matrix(row, across.index(first + l, slot)));
      }
    }
  }
}

/// Parameters that derivative `k` of a segment belongs to at a position, and its factors to them.
int PairSums::spread(std::size_t segment, std::size_t position, int k, int* parameter, double* factor) const {
  const MeasurementModel& model = model_.model();
  if (segments_[segment].is_group) {
    const FunctionGroup& group = model.layout().groups[segment];
    const int support = group.basis->support(), start = model.tables().start(segment, position);
    std::copy_n(model.tables().values(segment, support, position), support, factor);
    for (int j = 0; j < support; ++j) parameter[j] = group.index(start + j, k);
    return support;
  }
  *factor = 1.0;
  if (segment + 1 < segments_.size()) {
    *parameter = shared_parameters_[static_cast<std::size_t>(k)];
    return 1;
  }
  const std::vector<int>& own = model_.own_parameters()[position];
  if (k >= static_cast<int>(own.size())) return 0;
  *parameter = own[static_cast<std::size_t>(k)];
  return 1;
}

/// The segment across is no group: few columns.
void PairSums::add_pair(const Pair& pair, Eigen::MatrixXd& matrix) const {
  int row[kMaxBasisSupport], column[kMaxBasisSupport];
  double row_factor[kMaxBasisSupport], column_factor[kMaxBasisSupport];
  for (std::size_t b = 0; b < pair.blocks; ++b) {
    const double* block = sums_.data() + pair.begin + b * block_size(pair);
    if (!any(block, block_size(pair))) continue;
    const std::size_t across_positions = segments_[pair.across].positions;
    const std::size_t p = pair.same_position ? b : b / across_positions;
    const std::size_t r = pair.same_position ? b : b % across_positions;
    for (int k = 0; k < segments_[pair.across].size; ++k, block += segments_[pair.down].stride) {
      if (spread(pair.across, r, k, column, column_factor) == 0) continue;
      for (int i = 0; i < segments_[pair.down].size; ++i) {
        const int rows = spread(pair.down, p, i, row, row_factor);
        for (int j = 0; j < rows; ++j) {
          // A segment with itself holds every product twice.
          if (pair.down == pair.across && row[j] > column[0]) continue;
          matrix(std::min(row[j], column[0]), std::max(row[j], column[0])) += row_factor[j] * block[i];
        }
      }
    }
  }
}

}  // namespace volcal
