#include "volcal/identify/noise/noise_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "volcal/identify/noise/filter_rows.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/tile_array.h"

namespace volcal {
namespace {

constexpr std::size_t kTile = 64;          // steps of them that stay in the cache
constexpr std::size_t kGramTile = 384;     // steps per matrix product
constexpr std::size_t kGramParts = 8;      // fixed: sums do not depend on the number of threads
constexpr std::size_t kFactorsPerLog = 8;  // variances multiplied before a logarithm is taken

void require(bool condition, const char* problem) {
  if (!condition) throw std::invalid_argument(std::string("noise model: ") + problem);
}

void check(const NoiseData& data) {
  const std::size_t n = data.sigma.size();
  require(data.length.empty() || data.length.size() == n, "one length per observation, or none");
  require(std::ranges::all_of(data.sigma, [](double sigma) { return sigma > 0.0; }),
          "every sigma must be positive (infinite = left out)");
  std::vector<int> visits(n, 0);
  for (const NoiseSequence& sequence : data.sequences) {
    const std::size_t size = sequence.observation.size();
    require(sequence.time.empty() || sequence.time.size() == size, "one time per observation, or none");
    require(sequence.line.empty() || sequence.line.size() == size, "one line per observation, or none");
    require(std::ranges::all_of(sequence.time, [](double t) { return std::isfinite(t); }),
            "times must be finite");
    for (const std::size_t i : sequence.observation) {
      require(i < n, "a sequence names an observation that does not exist");
      ++visits[i];
    }
  }
  require(std::ranges::all_of(visits, [](int count) { return count == 1; }),
          "every observation must be in exactly one sequence");
}

void check(const NoiseParameters& noise) {
  const auto valid = [](double value) { return value >= 0.0 && std::isfinite(value); };
  require(valid(noise.white) && valid(noise.drift) && valid(noise.line) && valid(noise.per_metre),
          "parameters must be finite and not negative");
  require(noise.drift == 0.0 || noise.tau > 0.0, "tau must be positive");
}

}  // namespace

Whitener::Whitener(const NoiseData& data, std::span<const NoiseParameters> parameters)
    : rows_(data.sigma.size()) {
  check(data);
  for (std::size_t i = 0; i < rows_; ++i) {
    if (!std::isfinite(data.sigma[i])) missing_.push_back(i);
  }
  observations_ = rows_ - missing_.size();
  for (const NoiseSequence& sequence : data.sequences) {
    tracks_.push_back(make_track(data, sequence));
    groups_ = std::max(groups_, sequence.group + 1);
  }
  set_parameters(parameters);
}

Whitener::Track Whitener::make_track(const NoiseData& data, const NoiseSequence& sequence) {
  Track track;
  track.group = sequence.group;
  track.timed = !sequence.time.empty();
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < sequence.observation.size(); ++k) {
    if (std::isfinite(data.sigma[sequence.observation[k]])) order.push_back(k);
  }
  if (track.timed) {
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return sequence.time[k]; });
  } else if (!sequence.line.empty()) {
    std::ranges::stable_sort(order, {}, [&](std::size_t k) { return sequence.line[k]; });
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t observation = sequence.observation[order[i]];
    Step step{observation, std::numeric_limits<double>::infinity(), 0, false, data.sigma[observation], 0.0};
    if (track.timed && i > 0) step.gap = sequence.time[order[i]] - sequence.time[order[i - 1]];
    if (!data.length.empty()) step.length = data.length[observation];
    track.steps.push_back(step);
    track.first = std::min(track.first, observation);
    track.last = std::max(track.last, observation);
  }
  if (!sequence.line.empty()) assign_slots(sequence, order, track);
  const std::size_t steps = track.steps.size();
  track.decay.resize(steps);
  track.scale.resize(steps);
  track.gain.resize(steps * static_cast<std::size_t>(track.states));
  return track;
}

void Whitener::assign_slots(const NoiseSequence& sequence, const std::vector<std::size_t>& order,
                            Track& track) {
  std::unordered_map<std::int32_t, std::size_t> last;
  for (std::size_t i = 0; i < order.size(); ++i) last[sequence.line[order[i]]] = i;
  std::unordered_map<std::int32_t, int> open;
  std::vector<int> free;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::int32_t line = sequence.line[order[i]];
    Step& step = track.steps[i];
    const auto found = open.find(line);
    step.opens = found == open.end();
    if (!step.opens) {
      step.slot = found->second;
    } else if (!free.empty()) {
      step.slot = free.back();
      free.pop_back();
    } else {
      step.slot = track.states++;
    }
    open[line] = step.slot;
    if (last[line] == i) {
      open.erase(line);
      free.push_back(step.slot);
    }
  }
}

void Whitener::set_parameters(std::span<const NoiseParameters> parameters) {
  require(parameters.size() >= groups_, "parameters for every group");
  for (const NoiseParameters& noise : parameters) check(noise);
  log_determinant_ = 0.0;
  for (Track& track : tracks_) {
    NoiseParameters noise = parameters[track.group];
    if (!track.timed) noise.drift = 0.0;
    track.independent = noise.drift == 0.0 && (noise.line == 0.0 || track.states == 1);
    log_determinant_ +=
        track.states == 2 ? compute_gains<2>(noise, track) : compute_gains<Eigen::Dynamic>(noise, track);
  }
}

template <int kStates>
double Whitener::compute_gains(const NoiseParameters& noise, Track& track) {
  using Matrix = Eigen::Matrix<double, kStates, kStates>;
  using Vector = Eigen::Matrix<double, kStates, 1>;
  const double drift2 = noise.drift * noise.drift;
  Matrix covariance = Matrix::Zero(track.states, track.states);
  Vector towards(track.states);  // covariance of the states with the observation
  double log_determinant = 0.0, product = 1.0, gap = -1.0, decay = 0.0;
  for (std::size_t i = 0; i < track.steps.size(); ++i) {
    const Step& step = track.steps[i];
    if (step.gap != gap) {
      gap = step.gap;
      decay = drift2 > 0.0 ? std::exp(-gap / noise.tau) : 0.0;
    }
    track.decay[i] = decay;
    covariance.row(0) *= decay;
    covariance.col(0) *= decay;
    covariance(0, 0) += (1.0 - decay * decay) * drift2;
    towards = covariance.col(0);
    if (step.slot > 0) {
      if (step.opens) {
        covariance.row(step.slot).setZero();
        covariance.col(step.slot).setZero();
        covariance(step.slot, step.slot) = noise.line * noise.line;
        towards(step.slot) = 0.0;
      }
      towards += covariance.col(step.slot);
    }
    const double white = noise.white * step.sigma, proportional = noise.per_metre * step.length;
    const double variance =
        white * white + proportional * proportional + towards(0) + (step.slot > 0 ? towards(step.slot) : 0.0);
    if (!(variance > 0.0)) throw std::invalid_argument("noise model: an observation without any noise");
    Eigen::Map<Vector> gain(track.gain.data() + i * static_cast<std::size_t>(track.states), track.states);
    gain = towards / variance;
    covariance.noalias() -= gain * towards.transpose();
    track.scale[i] = 1.0 / std::sqrt(variance);
    product *= variance;
    if ((i + 1) % kFactorsPerLog == 0) {
      log_determinant += std::log(product);
      product = 1.0;
    }
  }
  return log_determinant + std::log(product);
}

FilterStep Whitener::filter_step(const Track& track, std::size_t i) {
  const double* const gain = track.gain.data() + i * static_cast<std::size_t>(track.states);
  return {track.decay[i], track.scale[i], gain[0], gain[track.steps[i].slot]};
}

template <class Visit>
void Whitener::visit_held_offsets(const Track& track, std::size_t i, const Visit& visit) {
  const double* const gain = track.gain.data() + i * static_cast<std::size_t>(track.states);
  for (int other = 1; other < track.states; ++other) {
    if (other != track.steps[i].slot && gain[other] != 0.0) visit(other, gain[other] / track.scale[i]);
  }
}

void Whitener::filter(const Track& track, std::size_t begin, std::size_t end, Eigen::Index width,
                      double* tile, double* state) {
  for (std::size_t i = begin; i < end; ++i, tile += width) {
    if (track.independent) {
      scale_row(track.scale[i], width, tile);
      continue;
    }
    const Step& step = track.steps[i];
    if (step.slot == 0) {
      filter_row(filter_step(track, i), width, tile, state);
    } else {
      double* const offset = state + step.slot * width;
      if (step.opens) std::fill(offset, offset + width, 0.0);
      filter_row(filter_step(track, i), width, tile, state, offset);
    }
    visit_held_offsets(
        track, i, [&](int other, double factor) { add_row(factor, width, tile, state + other * width); });
  }
}

void Whitener::filter_adjoint(const Track& track, Eigen::Index width, double* rows) {
  std::vector<double> state(static_cast<std::size_t>(track.states * width), 0.0);
  for (std::size_t i = track.steps.size(); i-- > 0;) {
    double* const values = rows + static_cast<Eigen::Index>(i) * width;
    if (track.independent) {
      scale_row(track.scale[i], width, values);
      continue;
    }
    visit_held_offsets(track, i, [&](int other, double factor) {
      add_row(factor, width, state.data() + other * width, values);
    });
    const Step& step = track.steps[i];
    if (step.slot == 0) {
      filter_row_adjoint(filter_step(track, i), width, values, state.data());
      continue;
    }
    double* const offset = state.data() + step.slot * width;
    filter_row_adjoint(filter_step(track, i), width, values, state.data(), offset);
    if (step.opens) std::fill(offset, offset + width, 0.0);
  }
}

void Whitener::scale_block(const Track& track, Eigen::Index width, const Place& place) {
  for (Eigen::Index c = 0; c < width; ++c) {
    const double* const in = place.in + c * place.in_stride;
    double* const out = place.out + c * place.out_stride;
    for (std::size_t i = 0; i < track.steps.size(); ++i) {
      const std::size_t row = track.steps[i].observation - place.origin;
      out[place.packed ? i : row] = in[row] * track.scale[i];
    }
  }
}

void Whitener::whiten_block(const Track& track, Eigen::Index width, const Place& place) {
  if (track.independent && place.rows == nullptr) {
    scale_block(track, width, place);
    return;
  }
  const Eigen::Index stride = place.rows == nullptr ? width : whole_lines(width);
  std::vector<double> state(static_cast<std::size_t>(track.states * stride), 0.0);
  std::vector<double> buffer(place.rows == nullptr ? static_cast<std::size_t>(stride) * kTile : 0);
  const auto wide = static_cast<std::size_t>(stride);
  for (std::size_t begin = 0; begin < track.steps.size(); begin += kTile) {
    const std::size_t end = std::min(begin + kTile, track.steps.size());
    double* const tile = place.rows == nullptr ? buffer.data() : place.rows + begin * wide;
    for (std::size_t c = 0; c < static_cast<std::size_t>(width); ++c) {
      const double* const in = place.in + static_cast<Eigen::Index>(c) * place.in_stride;
      for (std::size_t i = begin; i < end; ++i)
        tile[(i - begin) * wide + c] = in[track.steps[i].observation - place.origin];
    }
    filter(track, begin, end, stride, tile, state.data());
    for (std::size_t c = 0; c < static_cast<std::size_t>(width); ++c) {
      double* const out = place.out + static_cast<Eigen::Index>(c) * place.out_stride;
      for (std::size_t i = begin; i < end; ++i)
        out[place.packed ? i : track.steps[i].observation - place.origin] = tile[(i - begin) * wide + c];
    }
  }
}

void Whitener::whiten(const Eigen::MatrixXd& columns, Eigen::MatrixXd& whitened, int threads) const {
  require(columns.rows() == static_cast<Eigen::Index>(rows_), "one row per observation");
  if (&columns != &whitened) whitened.resize(columns.rows(), columns.cols());
  const auto blocks = static_cast<std::size_t>((columns.cols() + kColumnBlock - 1) / kColumnBlock);
  run_parallel(blocks * tracks_.size(), threads, [&](std::size_t item) {
    const auto first = static_cast<Eigen::Index>(item / tracks_.size()) * kColumnBlock;
    whiten_block(tracks_[item % tracks_.size()], std::min(kColumnBlock, columns.cols() - first),
                 {columns.col(first).data(), columns.rows(), whitened.col(first).data(), whitened.rows(),
                  nullptr, 0, false});
  });
  for (const std::size_t i : missing_) whitened.row(static_cast<Eigen::Index>(i)).setZero();
}

std::vector<const Whitener::Track*> Whitener::tracks_of_part(std::size_t first, Eigen::Index rows) const {
  const std::size_t end = first + static_cast<std::size_t>(rows);
  std::vector<const Track*> inside;
  for (const Track& track : tracks_) {
    if (track.last < first || track.first >= end) continue;
    require(track.first >= first && track.last < end, "a part holds whole sequences");
    inside.push_back(&track);
  }
  return inside;
}

std::vector<std::size_t> Whitener::order_of_part(std::size_t first, Eigen::Index rows) const {
  std::vector<std::size_t> order;
  for (const Track* const track : tracks_of_part(first, rows)) {
    for (const Step& step : track->steps) order.push_back(step.observation);
  }
  return order;
}

Eigen::MatrixXd Whitener::whiten_part(std::size_t first,
                                      const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  std::size_t rows = 0;
  for (const Track* const track : tracks_of_part(first, columns.rows())) rows += track->steps.size();
  Eigen::MatrixXd whitened(static_cast<Eigen::Index>(rows), columns.cols());
  whiten_part(first, columns, whitened);
  return whitened;
}

void Whitener::whiten_part(std::size_t first, const Eigen::Ref<const Eigen::MatrixXd>& columns,
                           Eigen::Ref<Eigen::MatrixXd> whitened) const {
  double* out = whitened.data();
  for (const Track* const track : tracks_of_part(first, columns.rows())) {
    for (Eigen::Index column = 0; column < columns.cols(); column += kColumnBlock) {
      whiten_block(*track, std::min(kColumnBlock, columns.cols() - column),
                   {columns.data() + column * columns.outerStride(), columns.outerStride(),
                    out + column * whitened.outerStride(), whitened.outerStride(), nullptr, first, true});
    }
    out += track->steps.size();
  }
}

void Whitener::weigh_part(std::size_t first, const Eigen::Ref<const Eigen::MatrixXd>& columns,
                          Eigen::Ref<Eigen::MatrixXd> whitened, Eigen::MatrixXd& weighed) const {
  require(columns.cols() <= kColumnBlock, "at most kColumnBlock columns");
  const Eigen::Index stride = whole_lines(columns.cols());
  weighed.setZero(stride, whitened.rows());
  Eigen::Index at = 0;
  for (const Track* const track : tracks_of_part(first, columns.rows())) {
    double* const rows = weighed.data() + at * stride;
    whiten_block(*track, columns.cols(),
                 {columns.data(), columns.outerStride(), whitened.data() + at, whitened.outerStride(), rows,
                  first, true});
    filter_adjoint(*track, stride, rows);
    at += static_cast<Eigen::Index>(track->steps.size());
  }
}

Eigen::VectorXd Whitener::whiten(const Eigen::VectorXd& column) const {
  Eigen::MatrixXd whitened = column;
  whiten(whitened, whitened, 1);
  return whitened;
}

Eigen::VectorXd Whitener::weigh(const Eigen::VectorXd& column) const {
  return whiten_transposed(whiten(column));
}

Eigen::VectorXd Whitener::whiten_transposed(Eigen::VectorXd column) const {
  Eigen::VectorXd values;
  for (const Track& track : tracks_) {
    values.resize(static_cast<Eigen::Index>(track.steps.size()));
    const auto place = [&](Eigen::Index i) {
      return static_cast<Eigen::Index>(track.steps[static_cast<std::size_t>(i)].observation);
    };
    if (track.independent) {
      for (Eigen::Index i = 0; i < values.size(); ++i)
        column[place(i)] *= track.scale[static_cast<std::size_t>(i)];
      continue;
    }
    for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = column[place(i)];
    filter_adjoint(track, 1, values.data());
    for (Eigen::Index i = 0; i < values.size(); ++i) column[place(i)] = values[i];
  }
  return column;
}

template <class Fill>
void Whitener::add_gram(const Track& track, Eigen::Index width, const Fill& fill, Eigen::MatrixXd& sum) {
  std::vector<double> state(static_cast<std::size_t>(track.states * width), 0.0);
  Eigen::MatrixXd tile(width, static_cast<Eigen::Index>(kGramTile));
  for (std::size_t begin = 0; begin < track.steps.size(); begin += kGramTile) {
    const std::size_t end = std::min(begin + kGramTile, track.steps.size());
    fill(track, begin, end, tile);
    filter(track, begin, end, width, tile.data(), state.data());
    add_outer_product_upper(tile.data(), static_cast<int>(width), static_cast<int>(end - begin), sum);
  }
}

template <class Fill>
Eigen::MatrixXd Whitener::sum_of_grams(const std::vector<const Track*>& tracks, Eigen::Index width,
                                       const Fill& fill, int threads) {
  use_single_threaded_blas();
  std::size_t observations = 0, in_part = 0;
  for (const Track* const track : tracks) observations += track->steps.size();
  std::vector<std::vector<const Track*>> parts;
  for (const Track* const track : tracks) {
    if (parts.empty() || in_part * kGramParts >= observations) {
      parts.emplace_back();
      in_part = 0;
    }
    parts.back().push_back(track);
    in_part += track->steps.size();
  }
  std::vector<Eigen::MatrixXd> sums(parts.size(), Eigen::MatrixXd::Zero(width, width));
  run_parallel(parts.size(), threads, [&](std::size_t part) {
    for (const Track* const track : parts[part]) add_gram(*track, width, fill, sums[part]);
  });
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(width, width);
  for (const Eigen::MatrixXd& sum : sums) total += sum;
  symmetrise_from_upper(total);
  return total;
}

Eigen::MatrixXd Whitener::gram(const Eigen::Ref<const Eigen::MatrixXd>& rows, int threads) const {
  require(rows.cols() == static_cast<Eigen::Index>(rows_), "one column per observation");
  std::vector<const Track*> tracks;
  for (const Track& track : tracks_) tracks.push_back(&track);
  const auto copy = [&](const Track& track, std::size_t begin, std::size_t end, Eigen::MatrixXd& tile) {
    for (std::size_t i = begin; i < end; ++i) {
      tile.col(static_cast<Eigen::Index>(i - begin)) =
          rows.col(static_cast<Eigen::Index>(track.steps[i].observation));
    }
  };
  return sum_of_grams(tracks, rows.rows(), copy, threads);
}

Whitener::GroupGram Whitener::gram_of_group(std::size_t group, Eigen::Index width, const MakeColumns& make,
                                            int threads) const {
  GroupGram result;
  std::vector<const Track*> tracks;
  for (const Track& track : tracks_) {
    if (track.group != group) continue;
    tracks.push_back(&track);
    result.observations += track.steps.size();
  }
  const auto fill = [&](const Track& track, std::size_t begin, std::size_t end, Eigen::MatrixXd& tile) {
    std::vector<std::size_t> observations;
    for (std::size_t i = begin; i < end; ++i) observations.push_back(track.steps[i].observation);
    make(observations, tile.leftCols(static_cast<Eigen::Index>(end - begin)));
  };
  result.gram = sum_of_grams(tracks, width, fill, threads);
  return result;
}

}  // namespace volcal
