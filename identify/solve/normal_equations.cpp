#include "volcal/identify/solve/normal_equations.h"

#include <ceres/loss_function.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <thread>

#include "volcal/identify/solve/dense.h"

namespace volcal {
namespace {

constexpr std::uint32_t kMaxBatch = 96;
constexpr std::size_t kReadingsPerChunk = 16384;
constexpr std::size_t kMaxChunks = 16;

/// One active stretch of coefficients per function group.
std::vector<int> active_cell(const MeasurementModel& model, std::size_t setup, std::size_t row) {
  std::vector<int> cell;
  double values[kMaxSupport];
  const Readings& readings = model.campaign().setups[setup].readings;
  for (const FunctionGroup& group : model.layout().groups) {
    cell.push_back(group.basis->evaluate(readings.position[index_of(group.axis)][row], values));
  }
  return cell;
}

}  // namespace

ReadingIndex::ReadingIndex(const MeasurementModel& model) : model_(model) {
  const auto& setups = model.campaign().setups;
  std::vector<std::uint64_t> key;
  for (std::size_t setup = 0; setup < setups.size(); ++setup) {
    first_.push_back(observations_);
    const std::size_t rows = setups[setup].readings.size();
    observations_ += rows * static_cast<std::size_t>(model.bound(setup).channels());
    for (std::size_t row = 0; row < rows; ++row) {
      std::uint64_t cell_key = 0;
      for (const int start : active_cell(model, setup, row))
        cell_key = cell_key * 1021 + static_cast<std::uint64_t>(start);
      key.push_back(cell_key);
      sorted_.push_back({static_cast<std::uint32_t>(setup), static_cast<std::uint32_t>(row)});
    }
  }
  std::vector<std::uint32_t> order(sorted_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return key[i]; });
  std::vector<Reading> unsorted = std::move(sorted_);
  sorted_.clear();
  sorted_.reserve(unsorted.size());
  for (const std::uint32_t i : order) sorted_.push_back(unsorted[i]);
  std::uint32_t begin = 0;
  for (std::uint32_t i = 1; i <= sorted_.size(); ++i) {
    if (i < sorted_.size() && key[order[i]] == key[order[begin]] && i - begin < kMaxBatch) continue;
    batch_ends_.push_back(i);
    begin = i;
  }
}

/// Working space and sums of one chunk of batches.
struct NormalAccumulator::Chunk {
  explicit Chunk(const ParameterLayout& layout) : layout_(layout) {
    sums.matrix = Eigen::MatrixXd::Zero(layout.size, layout.size);
    sums.gradient = Eigen::VectorXd::Zero(layout.size);
    for (const FunctionGroup& group : layout.groups) active_ += group.count() * group.basis->support();
    tile_.resize(active_, active_);
  }

  void begin_batch() { columns_ = 0; }

  /// Adds one observation: `scale` is the square root of its weight, `error` predicted minus reading.
  void add(const RowJacobian& row, int channel, double scale, double error) {
    if (rows_.cols() <= columns_) rows_.conservativeResize(active_, columns_ + 32);
    double* a = rows_.data() + static_cast<Eigen::Index>(columns_) * active_;
    const double* basis = row.basis_value.data();
    const double* weight = row.weight[channel].data();
    double* out = a;
    for (const FunctionGroup& group : layout_.groups) {
      const int support = group.basis->support();
      const int count = group.count();
      for (int j = 0; j < support; ++j) {
        const double b = scale * basis[j];
        for (int s = 0; s < count; ++s) *out++ = b * weight[s];
      }
      basis += support;
      weight += count;
    }
    const double scaled_error = scale * error;
    const std::vector<double>& tail = row.tail_value[channel];
    for (std::size_t t = 0; t < tail.size(); ++t) {
      const double v = scale * tail[t];
      const int column = row.tail_index[t];
      const double* segment = a;
      for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
        const FunctionGroup& group = layout_.groups[g];
        const int size = group.basis->support() * group.count();
        double* m = &sums.matrix(group.index(row.start[g], 0), column);
        for (int k = 0; k < size; ++k) m[k] += v * segment[k];
        segment += size;
      }
      for (std::size_t other = 0; other < tail.size(); ++other) {
        if (row.tail_index[other] <= column)
          sums.matrix(row.tail_index[other], column) += v * scale * tail[other];
      }
      sums.gradient[column] += v * scaled_error;
    }
    const double* segment = a;
    for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
      const FunctionGroup& group = layout_.groups[g];
      const int size = group.basis->support() * group.count();
      double* gradient = &sums.gradient[group.index(row.start[g], 0)];
      for (int k = 0; k < size; ++k) gradient[k] += scaled_error * segment[k];
      segment += size;
    }
    ++columns_;
  }

  void end_batch(const std::vector<int>& start) {
    if (columns_ == 0 || active_ == 0) return;
    tile_.setZero();
    add_outer_product_upper(rows_.data(), active_, columns_, tile_);
    int column = 0;
    for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
      const int columns = layout_.groups[g].basis->support() * layout_.groups[g].count();
      for (int c = 0; c < columns; ++c, ++column) {
        int row = 0;
        for (std::size_t h = 0; h <= g; ++h) {
          const int rows = h == g ? c + 1 : layout_.groups[h].basis->support() * layout_.groups[h].count();
          double* m =
              &sums.matrix(layout_.groups[h].index(start[h], 0), layout_.groups[g].index(start[g], 0) + c);
          const double* tile = &tile_(row, column);
          for (int k = 0; k < rows; ++k) m[k] += tile[k];
          row += rows;
        }
      }
    }
  }

  NormalEquations sums;

 private:
  const ParameterLayout& layout_;
  int active_ = 0;
  int columns_ = 0;
  Eigen::MatrixXd rows_;  ///< active coefficients x observations of the batch
  Eigen::MatrixXd tile_;
};

NormalAccumulator::NormalAccumulator(const ReadingIndex& index, const std::vector<double>& weight,
                                     const ceres::LossFunction* loss, int threads)
    : index_(index), weight_(weight), loss_(loss), threads_(std::max(1, threads)) {
  use_single_threaded_blas();
  const std::size_t readings = index.sorted().size();
  const std::size_t chunks =
      std::clamp<std::size_t>(readings / kReadingsPerChunk, readings >= 2000 ? 2 : 1, kMaxChunks);
  const auto& ends = index.batch_ends();
  for (std::size_t chunk = 1; chunk <= chunks; ++chunk) {
    const auto end = std::ranges::lower_bound(ends, static_cast<std::uint32_t>(readings * chunk / chunks));
    chunk_ends_.push_back(std::min(ends.size(), static_cast<std::size_t>(end - ends.begin()) + 1));
  }
}

template <class Work>
void NormalAccumulator::for_each_chunk(const Work& work) const {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t chunk = next++; chunk < chunk_ends_.size(); chunk = next++) work(chunk);
  };
  std::vector<std::thread> workers;
  const int extra = std::min<int>(threads_, static_cast<int>(chunk_ends_.size())) - 1;
  for (int i = 0; i < extra; ++i) workers.emplace_back(run);
  run();
  for (std::thread& worker : workers) worker.join();
}

NormalEquations NormalAccumulator::accumulate(const Eigen::VectorXd& parameters,
                                              const std::vector<bool>* include) const {
  const MeasurementModel& model = index_.model();
  const auto& setups = model.campaign().setups;
  std::vector<NormalEquations> sums(chunk_ends_.size());
  for_each_chunk([&](std::size_t chunk) {
    Chunk work(model.layout());
    RowJacobian row;
    double rho[3];
    const std::size_t first_batch = chunk == 0 ? 0 : chunk_ends_[chunk - 1];
    for (std::size_t batch = first_batch; batch < chunk_ends_[chunk]; ++batch) {
      work.begin_batch();
      const std::uint32_t begin = batch == 0 ? 0 : index_.batch_ends()[batch - 1];
      for (std::uint32_t i = begin; i < index_.batch_ends()[batch]; ++i) {
        const auto [setup, reading] = index_.sorted()[i];
        if (include != nullptr && !(*include)[setup]) continue;
        model.linearize(setup, reading, parameters, row);
        const std::size_t observation = index_.first_observation(setup, reading);
        for (int channel = 0; channel < row.channels; ++channel) {
          const double weight = weight_[observation + static_cast<std::size_t>(channel)];
          if (weight == 0.0) continue;
          const double error = row.predicted[channel] -
                               setups[setup].readings.value[static_cast<std::size_t>(channel)][reading];
          const double square = weight * error * error;
          rho[0] = square;
          rho[1] = 1.0;
          if (loss_ != nullptr) loss_->Evaluate(square, rho);
          work.sums.cost += 0.5 * rho[0];
          work.sums.squares += square;
          ++work.sums.observations;
          work.add(row, channel, std::sqrt(weight * rho[1]), error);
        }
      }
      work.end_batch(row.start);
    }
    sums[chunk] = std::move(work.sums);
  });
  NormalEquations total = std::move(sums[0]);
  for (std::size_t chunk = 1; chunk < sums.size(); ++chunk) {
    total.matrix += sums[chunk].matrix;
    total.gradient += sums[chunk].gradient;
    total.cost += sums[chunk].cost;
    total.squares += sums[chunk].squares;
    total.observations += sums[chunk].observations;
  }
  symmetrise_from_upper(total.matrix);
  return total;
}

double NormalAccumulator::cost(const Eigen::VectorXd& parameters) const {
  const MeasurementModel& model = index_.model();
  const auto& setups = model.campaign().setups;
  std::vector<double> sums(chunk_ends_.size(), 0.0);
  for_each_chunk([&](std::size_t chunk) {
    RowJacobian row;
    double rho[3];
    const std::size_t first_batch = chunk == 0 ? 0 : chunk_ends_[chunk - 1];
    const std::uint32_t begin = first_batch == 0 ? 0 : index_.batch_ends()[first_batch - 1];
    for (std::uint32_t i = begin; i < index_.batch_ends()[chunk_ends_[chunk] - 1]; ++i) {
      const auto [setup, reading] = index_.sorted()[i];
      model.linearize(setup, reading, parameters, row);
      const std::size_t observation = index_.first_observation(setup, reading);
      for (int channel = 0; channel < row.channels; ++channel) {
        const double error =
            row.predicted[channel] - setups[setup].readings.value[static_cast<std::size_t>(channel)][reading];
        rho[0] = weight_[observation + static_cast<std::size_t>(channel)] * error * error;
        if (loss_ != nullptr) loss_->Evaluate(rho[0], rho);
        sums[chunk] += 0.5 * rho[0];
      }
    }
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace volcal
