#include "volcal/identify/solve/normals/normal_equations.h"

#include <ceres/loss_function.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/solve/normals/normal_tile.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::size_t kReadingsPerChunk = 16384;
constexpr std::size_t kMaxChunks = 16;
constexpr std::size_t kMostNumbersOfChunks = std::size_t{1} << 27U;  // of all their matrices: 1 GiB

/// Number of the stretch of coefficients that is active, over all function groups.
std::uint64_t active_cell(const MeasurementModel& model, std::size_t setup, std::size_t row) {
  std::uint64_t cell = 0;
  for (std::size_t g = 0; g < model.layout().groups.size(); ++g) {
    const std::size_t axis = index_of(model.layout().groups[g].axis);
    const int start = model.tables().start(g, model.tables().entries(setup, axis)[row]);
    cell = cell * 1021 + static_cast<std::uint64_t>(start);
  }
  return cell;
}

}  // namespace

ReadingIndex::ReadingIndex(const MeasurementModel& model) : model_(model), blocks_(model) {
  const auto& setups = model.campaign().setups;
  for (std::size_t setup = 0; setup < setups.size(); ++setup) {
    first_.push_back(observations_);
    observations_ += setups[setup].readings.size() * static_cast<std::size_t>(model.bound(setup).channels());
  }
}

const std::vector<ReadingIndex::Reading>& ReadingIndex::sorted() const {
  std::call_once(is_sorted_, [this] {
    std::vector<std::pair<std::uint64_t, Reading>> keyed;
    const auto& setups = model_.campaign().setups;
    for (std::uint32_t setup = 0; setup < setups.size(); ++setup) {
      for (std::uint32_t row = 0; row < setups[setup].readings.size(); ++row)
        keyed.push_back({active_cell(model_, setup, row), {setup, row}});
    }
    std::ranges::stable_sort(keyed, {}, &std::pair<std::uint64_t, Reading>::first);
    sorted_.reserve(keyed.size());
    for (const auto& [cell, reading] : keyed) sorted_.push_back(reading);
  });
  return sorted_;
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

namespace {

/// A dense matrix of so many parameters still fits into memory, and its factors into a day.
void require_adjustable(const MeasurementModel& model) {
  constexpr int kMostParameters = 30000;
  const int size = model.layout().size;
  if (size <= kMostParameters) return;
  throw InputError(
      {model.campaign().file, 0},
      "the campaign has " + std::to_string(size) + " unknown parameters, at most " +
          std::to_string(kMostParameters) + " are adjusted together",
      "put lines of one instrument into one setup, name shared stations alike, or fit parts of it");
}

}  // namespace

NormalAccumulator::NormalAccumulator(const ReadingIndex& index, const std::vector<double>& weight,
                                     const ceres::LossFunction* loss, int threads, std::size_t share)
    : index_(index),
      weight_(weight),
      loss_(loss),
      threads_(std::max(1, threads)),
      share_(std::max<std::size_t>(1, share)),
      by_pairs_(PairSums::pay(index.blocks())),
      chunks_(make_chunks()) {
  use_single_threaded_blas();
  require_adjustable(index.model());
}

std::vector<NormalAccumulator::Chunk> NormalAccumulator::make_chunks() const {
  const std::size_t observations = in_share(index_.observations());
  const auto size = static_cast<std::size_t>(index_.model().layout().size);
  const std::size_t room = kMostNumbersOfChunks / std::max<std::size_t>(size * size, 1);
  const std::size_t count =
      std::clamp<std::size_t>(observations / kReadingsPerChunk, observations >= 2000 ? 2 : 1, kMaxChunks);
  return std::vector<Chunk>(std::clamp<std::size_t>(room, 1, count));
}

/// Number of the item, out of `count`, that stands for its share; scattered, so that no grid keeps step.
std::size_t NormalAccumulator::item(std::size_t of_share, std::size_t count) const {
  if (share_ == 1) return of_share;
  constexpr std::uint32_t kScatter = 2654435761U;  // 2^32 / golden ratio
  const std::uint32_t scattered = (static_cast<std::uint32_t>(of_share) * kScatter) >> 8U;
  return std::min(of_share * share_ + scattered % share_, count - 1);
}

const NormalEquations& NormalAccumulator::accumulate(const Eigen::VectorXd& parameters,
                                                     const std::vector<bool>* include, Sums what) {
  const TabulatedFunctions tabulated = index_.model().tabulate(parameters);
  run_parallel(chunks_.size(), threads_, [&](std::size_t chunk) {
    if (what == Sums::All && !by_pairs_) {
      add_by_cell(chunk, parameters, tabulated, include, chunks_[chunk].sums);
    } else {
      add_blocks(chunk, parameters, tabulated, include, what, chunks_[chunk]);
    }
  });
  collect(what);
  return chunks_.front().sums;
}

/// Total of the chunks, in their order.
void NormalAccumulator::collect(Sums what) {
  const bool by_cell = what == Sums::All && !by_pairs_;
  Chunk& total = chunks_.front();
  std::vector<const PairSums*> others;
  for (std::size_t i = 1; i < chunks_.size(); ++i) {
    const Chunk& chunk = chunks_[i];
    total.sums.cost += chunk.sums.cost;
    total.sums.squares += chunk.sums.squares;
    total.sums.observations += chunk.sums.observations;
    if (by_cell) {
      total.sums.matrix += chunk.sums.matrix;
      total.sums.gradient += chunk.sums.gradient;
    } else {
      total.gradient->add(*chunk.gradient);
      if (what == Sums::All) others.push_back(&*chunk.pairs);
    }
  }
  if (!by_cell) total.sums.gradient = total.gradient->gradient();
  if (what != Sums::All) return;
  if (by_pairs_) {
    const int size = index_.model().layout().size;
    total.sums.matrix.setZero(size, size);
    total.pairs->add(others, threads_);
    total.pairs->add_to(total.sums.matrix, threads_);
  }
  symmetrise_from_upper(total.sums.matrix);
}

/// Counts an observation; returns its weight, that of the loss included.
double NormalAccumulator::observe(std::size_t observation, double error, NormalEquations& sums) const {
  const double weight = weight_[observation];
  if (weight == 0.0) return 0.0;
  const double square = weight * error * error;
  double rho[3] = {square, 1.0, 0.0};
  if (loss_ != nullptr) loss_->Evaluate(square, rho);
  sums.cost += 0.5 * rho[0];
  sums.squares += square;
  ++sums.observations;
  return weight * rho[1];
}

void NormalAccumulator::add_blocks(std::size_t chunk, const Eigen::VectorXd& parameters,
                                   const TabulatedFunctions& tabulated, const std::vector<bool>* include,
                                   Sums what, Chunk& out) const {
  const BlockModel& model = index_.blocks();
  if (!out.gradient) {
    out.gradient.emplace(model.model());
    out.levers = model.make_levers();
  }
  out.gradient->set_zero();
  if (what == Sums::All) {
    if (!out.pairs) {
      out.pairs.emplace(model);
      out.rows.resize(std::ptrdiff_t{kLanes} * model.row_width());
    }
    out.pairs->set_zero();
  }
  out.sums.cost = out.sums.squares = 0.0;
  out.sums.observations = 0;
  const std::size_t blocks = model.blocks().size(), end = begin_of(chunk + 1, blocks);
  for (std::size_t i = begin_of(chunk, blocks); i < end; ++i) {
    const ReadingBlock& block = model.blocks()[item(i, blocks)];
    if (include != nullptr && !(*include)[block.setup]) continue;
    model.linearize(block, parameters, tabulated, out.levers, out.linearized);
    add_block(block, what, out);
  }
}

void NormalAccumulator::add_block(const ReadingBlock& block, Sums what, Chunk& out) const {
  const BlockModel& model = index_.blocks();
  const LinearizationLanes& reading = out.linearized.reading;
  const auto channels = static_cast<std::size_t>(reading.channels());
  const auto& value = index_.model().campaign().setups[block.setup].readings.value;
  const std::size_t first = index_.first_observation(block.setup, block.first_row);
  Lanes weighted_error[kMaxChannels] = {};
  for (std::size_t channel = 0; channel < channels; ++channel) {
    const Lanes& predicted = reading.predicted(static_cast<int>(channel));
    Lanes root = {};
    for (int i = 0; i < block.size; ++i) {
      const auto row = static_cast<std::size_t>(i);
      const double error = predicted[i] - value[channel][block.first_row + row];
      const double weight = observe(first + row * channels + channel, error, out.sums);
      weighted_error[channel][i] = weight * error;
      root[i] = std::sqrt(weight);
    }
    if (what != Sums::All) continue;
    model.make_rows(block, out.linearized, static_cast<int>(channel), root, out.levers, out.rows.data());
    out.pairs->add(block, out.rows.data());
  }
  model.add_work(block, out.linearized, weighted_error, out.levers, *out.gradient);
}

void NormalAccumulator::add_by_cell(std::size_t chunk, const Eigen::VectorXd& parameters,
                                    const TabulatedFunctions& tabulated, const std::vector<bool>* include,
                                    NormalEquations& sums) const {
  const MeasurementModel& model = index_.model();
  const auto& setups = model.campaign().setups;
  const int size = model.layout().size;
  sums.cost = sums.squares = 0.0;
  sums.observations = 0;
  sums.gradient.setZero(size);
  sums.matrix.setZero(size, size);
  NormalTile tile(model.layout(), model.shared_tail_size(), sums.matrix, sums.gradient);
  RowJacobian row;
  const auto& sorted = index_.sorted();
  const std::size_t end = begin_of(chunk + 1, sorted.size());
  for (std::size_t i = begin_of(chunk, sorted.size()); i < end; ++i) {
    const auto [setup, reading] = sorted[item(i, sorted.size())];
    if (include != nullptr && !(*include)[setup]) continue;
    model.linearize(setup, reading, parameters, row, &tabulated);
    const std::size_t observation = index_.first_observation(setup, reading);
    for (int channel = 0; channel < row.channels; ++channel) {
      const auto c = static_cast<std::size_t>(channel);
      const double error = row.predicted[channel] - setups[setup].readings.value[c][reading];
      const double weight = observe(observation + c, error, sums);
      if (weight > 0.0) tile.add(row, channel, std::sqrt(weight), error);
    }
  }
  tile.flush();
}

}  // namespace volcal
