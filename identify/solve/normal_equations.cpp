#include "volcal/identify/solve/normal_equations.h"

#include <ceres/loss_function.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <thread>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/normal_tile.h"

namespace volcal {
namespace {

constexpr std::size_t kReadingsPerChunk = 16384;
constexpr std::size_t kMaxChunks = 16;

/// One active stretch of coefficients per function group.
std::vector<int> active_cell(const MeasurementModel& model, std::size_t setup, std::size_t row) {
  std::vector<int> cell;
  double values[kMaxBasisSupport];
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
}

std::vector<std::size_t> ReadingIndex::left_out() const {
  std::vector<std::size_t> observations;
  const auto& setups = model_.campaign().setups;
  for (std::size_t setup = 0; setup < setups.size(); ++setup) {
    for (const LeftOutReading& reading : setups[setup].left_out) {
      observations.push_back(first_observation(setup, reading.row) + reading.channel);
    }
  }
  return observations;
}

NormalAccumulator::NormalAccumulator(const ReadingIndex& index, const std::vector<double>& weight,
                                     const ceres::LossFunction* loss, int threads)
    : index_(index), weight_(weight), loss_(loss), threads_(std::max(1, threads)) {
  use_single_threaded_blas();
  const std::size_t readings = index.sorted().size();
  const std::size_t chunks =
      std::clamp<std::size_t>(readings / kReadingsPerChunk, readings >= 2000 ? 2 : 1, kMaxChunks);
  for (std::size_t chunk = 1; chunk <= chunks; ++chunk) chunk_ends_.push_back(readings * chunk / chunks);
}

template <class Work>
void NormalAccumulator::for_each_chunk(const Work& work) const {
  std::atomic<std::size_t> next{0};
  const auto run = [&] {
    for (std::size_t chunk = next++; chunk < chunk_ends_.size(); chunk = next++) work(chunk);
  };
  std::vector<std::thread> workers;
  const int extra = std::min<int>(threads_, static_cast<int>(chunk_ends_.size())) - 1;
  workers.reserve(chunk_ends_.size());
  for (int i = 0; i < extra; ++i) workers.emplace_back(run);
  run();
  for (std::thread& worker : workers) worker.join();
}

const NormalEquations& NormalAccumulator::accumulate(const Eigen::VectorXd& parameters,
                                                     const std::vector<bool>* include, Sums what) {
  const TabulatedFunctions tabulated = index_.model().tabulate(parameters);
  sums_.resize(chunk_ends_.size());
  for_each_chunk([&](std::size_t chunk) {
    accumulate_chunk(chunk, parameters, tabulated, include, what, sums_[chunk]);
  });
  NormalEquations& total = sums_[0];
  for (std::size_t chunk = 1; chunk < sums_.size(); ++chunk) {
    if (what == Sums::All) total.matrix += sums_[chunk].matrix;
    total.gradient += sums_[chunk].gradient;
    total.cost += sums_[chunk].cost;
    total.squares += sums_[chunk].squares;
    total.observations += sums_[chunk].observations;
  }
  if (what == Sums::All) symmetrise_from_upper(total.matrix);
  return total;
}

void NormalAccumulator::accumulate_chunk(std::size_t chunk, const Eigen::VectorXd& parameters,
                                         const TabulatedFunctions& tabulated,
                                         const std::vector<bool>* include, Sums what,
                                         NormalEquations& sums) const {
  const ParameterLayout& layout = index_.model().layout();
  sums.gradient.setZero(layout.size);
  if (what == Sums::AllButMatrix) {
    visit_chunk(chunk, parameters, tabulated, include, sums,
                [&](const RowJacobian& row, int channel, double weight, double error) {
                  const double weighted = weight * error;
                  for_each_derivative(layout, row, channel, [&](int parameter, double derivative) {
                    sums.gradient[parameter] += weighted * derivative;
                  });
                });
    return;
  }
  sums.matrix.setZero(layout.size, layout.size);
  NormalTile tile(layout, index_.model().shared_tail_size(), sums.matrix, sums.gradient);
  visit_chunk(chunk, parameters, tabulated, include, sums,
              [&](const RowJacobian& row, int channel, double weight, double error) {
                tile.add(row, channel, std::sqrt(weight), error);
              });
  tile.flush();
}

/// Cost, squares and count; `add` gets every observation's row, weight (of the loss, too) and error.
template <class Add>
void NormalAccumulator::visit_chunk(std::size_t chunk, const Eigen::VectorXd& parameters,
                                    const TabulatedFunctions& tabulated, const std::vector<bool>* include,
                                    NormalEquations& sums, const Add& add) const {
  const MeasurementModel& model = index_.model();
  const auto& setups = model.campaign().setups;
  sums.cost = sums.squares = 0.0;
  sums.observations = 0;
  RowJacobian row;
  double rho[3] = {0.0, 1.0, 0.0};
  const std::size_t begin = chunk == 0 ? 0 : chunk_ends_[chunk - 1];
  for (std::size_t i = begin; i < chunk_ends_[chunk]; ++i) {
    const auto [setup, reading] = index_.sorted()[i];
    if (include != nullptr && !(*include)[setup]) continue;
    model.linearize(setup, reading, parameters, row, &tabulated);
    const std::size_t observation = index_.first_observation(setup, reading);
    for (int channel = 0; channel < row.channels; ++channel) {
      const double weight = weight_[observation + static_cast<std::size_t>(channel)];
      if (weight == 0.0) continue;
      const double error =
          row.predicted[channel] - setups[setup].readings.value[static_cast<std::size_t>(channel)][reading];
      const double square = weight * error * error;
      rho[0] = square;
      if (loss_ != nullptr) loss_->Evaluate(square, rho);
      sums.cost += 0.5 * rho[0];
      sums.squares += square;
      ++sums.observations;
      add(row, channel, weight * rho[1], error);
    }
  }
}

}  // namespace volcal
