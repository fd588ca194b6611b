// Times draws of a Monte Carlo study on the reference problem, by path: linear draws beside the matrix
// product alone, nonlinear ones beside full refits of the same draws. Rounds are
// interleaved. Prints the rates of every round as JSON.
//
//   montecarlo_bench [--threads N] [--rounds N]

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "measure.h"
#include "reference_problem.h"
#include "volcal/identify/montecarlo/draw_projection.h"
#include "volcal/identify/montecarlo/path_solvers.h"
#include "volcal/identify/numeric/blas_core.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/solve/fit.h"

namespace volcal::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr Eigen::Index kLinearBatch = 250;  // draws, as in a study
constexpr int kLinearBatches = 80;
constexpr int kChordBatches = 20;
constexpr Eigen::Index kChordBatch = 32;
constexpr Eigen::Index kRefits = 4;  // of one thread

/// Draws per second of each row, by round.
struct Rates {
  std::vector<double> linear, product, chord, refit;
};

class Bench {
 public:
  explicit Bench(int threads)
      : threads_(thread_count(threads)),
        problem_(reference_problem({11, 9, 8})),
        result_(fit(problem_.campaign, problem_.model, white_noise())),
        repeated_(problem_.campaign, result_, {}),
        set_(quantities_of(result_, 3)),
        projection_(repeated_, set_),
        solvers_(repeated_),
        left_(Eigen::MatrixXd::Random(repeated_.linear_root().cols(), kLinearBatch)),
        right_(Eigen::MatrixXd::Random(repeated_.linear_root().cols(), columns())) {}

  void round(Rates& rates) {
    rates.linear.push_back(rate(kLinearBatches, kLinearBatch, [&](std::size_t batch) {
      projection_.of_linear_draws(1, batch * kLinearBatch, kLinearBatch);
    }));
    rates.product.push_back(rate(kLinearBatches, kLinearBatch, [&](std::size_t) {
      Eigen::MatrixXd product = Eigen::MatrixXd::Zero(kLinearBatch, columns());
      add_transposed_product(left_, right_, product);
    }));
    rates.chord.push_back(rate(kChordBatches, kChordBatch, [&](std::size_t batch) {
      SolverTally tally;
      projection_.of(solvers_.by_chord(draws(batch * kChordBatch, kChordBatch), tally));
      if (tally.refitted + tally.not_converged > 0)
        throw std::runtime_error("a draw was not solved by steps");
    }));
    rates.refit.push_back(rate(static_cast<std::size_t>(threads_), kRefits, [&](std::size_t batch) {
      SolverTally tally;
      projection_.of(solvers_.by_refit(draws(batch * kRefits, kRefits), tally));
    }));
  }

  Json json(const Rates& rates) const {
    return {{"readings", repeated_.observations()},
            {"parameters", repeated_.parameters()},
            {"quantities", projection_.quantities()},
            {"components", columns() - projection_.quantities()},
            {"threads", threads_},
            {"blas", blas_core()},
            {"linear_per_s", rates.linear},
            {"product_per_s", rates.product},
            {"chord_per_s", rates.chord},
            {"refit_per_s", rates.refit},
            {"peak_bytes", peak_memory()}};
  }

 private:
  static FitOptions white_noise() {
    FitOptions options;
    options.noise = NoisePolicy::White;
    return options;
  }
  Eigen::Index columns() const {
    Eigen::Index count = set_.rows.rows();
    for (const QuantitySet::Volume& volume : set_.volumes) count += volume.rows.rows();
    return count;
  }
  std::vector<CampaignDraw> draws(std::uint64_t first, Eigen::Index count) const {
    std::vector<CampaignDraw> made;
    for (Eigen::Index k = 0; k < count; ++k)
      made.push_back(repeated_.draw(1, first + static_cast<std::uint64_t>(k)));
    return made;
  }
  template <class Work>
  double rate(std::size_t batches, Eigen::Index batch, const Work& work) const {
    const double time = seconds([&] { run_parallel(batches, threads_, work); });
    return static_cast<double>(batches) * static_cast<double>(batch) / time;
  }

  int threads_;
  ReferenceProblem problem_;
  FitResult result_;
  RepeatedCampaign repeated_;
  QuantitySet set_;
  DrawProjection projection_;
  PathSolvers solvers_;
  Eigen::MatrixXd left_, right_;
};

void run_montecarlo(int count, char** values) {
  int threads = 0, rounds = 5;
  read_options(count, values, 1, {{"--threads", into(threads)}, {"--rounds", into(rounds)}});
  Bench bench(threads);
  Rates rates;
  for (int i = 0; i < std::max(1, rounds); ++i) bench.round(rates);
  std::cout << bench.json(rates) << '\n';
}

}  // namespace
}  // namespace volcal::bench

int main(int count, char** values) {
  return volcal::bench::run_program("montecarlo_bench",
                                    [&] { volcal::bench::run_montecarlo(count, values); });
}
