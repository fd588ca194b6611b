// Times draws of a Monte Carlo study on the reference problem, or on a campaign, by path: linear draws beside
// the matrix product alone, nonlinear ones beside full refits of the same draws. Rounds are
// interleaved. Prints the rates of every round as JSON, nonlinear draws by the clock and by processor time,
// and the gradients that they take.
//
//   montecarlo_bench [--threads N] [--rounds N] [--campaign CAMPAIGN.toml --model MODEL.toml] [--refits N]

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "measure.h"
#include "reference_problem.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
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

/// Draws per second of each row, by round.
struct Rates {
  std::vector<double> linear, product, chord, chord_of_processor, refit;
  double gradients = 0.0;  ///< of a nonlinear draw
};

struct Settings {
  int threads = 0;
  int rounds = 5;
  int refits = 4;  ///< of one thread
  std::string campaign;
  std::string model;
};

/// The reference problem with white noise; a campaign with what its fit finds.
ReferenceProblem problem_of(const Settings& settings) {
  if (settings.campaign.empty()) return reference_problem({11, 9, 8});
  Campaign campaign = read_campaign(settings.campaign);
  ModelSpec model = settings.model.empty() ? ModelSpec{} : read_model(settings.model, campaign.machine);
  return {std::move(campaign), std::move(model)};
}

FitOptions fit_options(const Settings& settings) {
  FitOptions options;
  if (settings.campaign.empty()) options.noise = NoisePolicy::White;
  return options;
}

class Bench {
 public:
  explicit Bench(const Settings& settings)
      : threads_(thread_count(settings.threads)),
        refits_(settings.refits),
        problem_(problem_of(settings)),
        result_(fit(problem_.campaign, problem_.model, fit_options(settings))),
        repeated_(problem_.campaign, result_, {}),
        set_(quantities_of(result_, 3)),
        projection_(repeated_, set_),
        solvers_(repeated_),
        left_(Eigen::MatrixXd::Random(repeated_.linear_root().cols(), kLinearBatch)),
        right_(Eigen::MatrixXd::Random(repeated_.linear_root().cols(), projection_.quantities())) {}

  void round(Rates& rates) {
    rates.linear.push_back(rate(kLinearBatches, kLinearBatch, [&](std::size_t batch) {
      projection_.of_linear_draws(1, batch * kLinearBatch, kLinearBatch);
    }));
    rates.product.push_back(rate(kLinearBatches, kLinearBatch, [&](std::size_t) {
      Eigen::MatrixXd product = Eigen::MatrixXd::Zero(kLinearBatch, projection_.quantities());
      add_transposed_product(left_, right_, product);
    }));
    std::vector<SolverTally> tallies(kChordBatches);
    const double before = processor_seconds();
    rates.chord.push_back(rate(kChordBatches, kChordBatch, [&](std::size_t batch) {
      SolverTally& tally = tallies[batch];
      projection_.of(solvers_.by_chord(repeated_.draws(1, batch * kChordBatch, kChordBatch), tally));
      if (tally.refitted + tally.not_converged > 0)
        throw std::runtime_error("a draw was not solved by steps");
    }));
    constexpr double kDraws = static_cast<double>(kChordBatches) * kChordBatch;
    rates.chord_of_processor.push_back(kDraws / (processor_seconds() - before));
    SolverTally sum;
    for (const SolverTally& tally : tallies) sum.add(tally);
    rates.gradients = static_cast<double>(sum.steps) / kDraws;
    rates.refit.push_back(rate(static_cast<std::size_t>(threads_), refits_, [&](std::size_t batch) {
      SolverTally tally;
      projection_.of(
          solvers_.by_refit(repeated_.draws(1, batch * static_cast<std::size_t>(refits_), refits_), tally));
    }));
  }

  Json json(const Rates& rates) const {
    return {{"readings", repeated_.observations()},
            {"parameters", repeated_.parameters()},
            {"quantities", projection_.quantities()},
            {"threads", threads_},
            {"blas", blas_core()},
            {"linear_per_s", rates.linear},
            {"product_per_s", rates.product},
            {"chord_per_s", rates.chord},
            {"chord_per_processor_s", rates.chord_of_processor},
            {"gradients_per_draw", rates.gradients},
            {"refit_per_s", rates.refit},
            {"peak_bytes", peak_memory()}};
  }

 private:
  template <class Work>
  double rate(std::size_t batches, Eigen::Index batch, const Work& work) const {
    const double time = seconds([&] { run_parallel(batches, threads_, work); });
    return static_cast<double>(batches) * static_cast<double>(batch) / time;
  }

  int threads_;
  Eigen::Index refits_;
  ReferenceProblem problem_;
  FitResult result_;
  RepeatedCampaign repeated_;
  QuantitySet set_;
  DrawProjection projection_;
  PathSolvers solvers_;
  Eigen::MatrixXd left_, right_;
};

void run_montecarlo(int count, char** values) {
  Settings settings;
  read_options(count, values, 1,
               {{"--threads", into(settings.threads)},
                {"--rounds", into(settings.rounds)},
                {"--refits", into(settings.refits)},
                {"--campaign", into(settings.campaign)},
                {"--model", into(settings.model)}});
  Bench bench(settings);
  Rates rates;
  for (int i = 0; i < std::max(1, settings.rounds); ++i) bench.round(rates);
  std::cout << bench.json(rates) << '\n';
}

}  // namespace
}  // namespace volcal::bench

int main(int count, char** values) {
  return volcal::bench::run_program("montecarlo_bench",
                                    [&] { volcal::bench::run_montecarlo(count, values); });
}
