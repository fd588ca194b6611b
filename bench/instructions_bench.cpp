// Runs one short workload, the same work in every run, for a tool that counts the instructions of
// run_counted().
//
//   instructions_bench WORKLOAD
//
// WORKLOAD: fit, draws, grid, csv, projection; each on one thread.

#include <fmt/format.h>

#include <functional>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>

#include "measure.h"
#include "reference_problem.h"
#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/identify/errors/error_grid.h"
#include "volcal/identify/io/campaign/readings_reader.h"
#include "volcal/identify/montecarlo/draw_projection.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/instruments/registry.h"

namespace {
volatile bool has_run = false;
}

/// Outside all namespaces, so that the tool finds it by its name; it ends behind the work, not by a jump to
/// it.
extern "C" void run_counted(const std::function<void()>& work);
extern "C" [[gnu::noinline]] void run_counted(const std::function<void()>& work) {
  work();
  has_run = true;
}

namespace volcal::bench {
namespace {

constexpr std::array<int, 3> kCountedGrid = {9, 7, 6};
constexpr std::array<int, 3> kVisibleGrid = {11, 9, 8};  // the readings determine every error
constexpr int kCountedNodes = 21;
constexpr Eigen::Index kCountedDraws = 250;
constexpr int kCountedRows = 20'000;
constexpr Eigen::Index kCountedColumns = 64;

FitResult counted_fit(const ReferenceProblem& problem) {
  FitOptions options;
  options.noise = NoisePolicy::White;
  options.threads = 1;
  return fit(problem.campaign, problem.model, options);
}

void count_fit() {
  const ReferenceProblem problem = reference_problem(kCountedGrid);
  run_counted([&] { counted_fit(problem); });
}

void count_draws() {
  const ReferenceProblem problem = reference_problem(kVisibleGrid);
  const FitResult result = counted_fit(problem);
  const RepeatedCampaign repeated(problem.campaign, result, {});
  const DrawProjection projection(repeated, quantities_of(result, 3));
  run_counted([&] { projection.of_linear_draws(1, 0, kCountedDraws); });
}

void count_grid() {
  const ReferenceProblem problem = reference_problem(kCountedGrid);
  const FitResult result = counted_fit(problem);
  const AxisGrid grid = axis_grid(result.machine, kCountedNodes);
  run_counted([&] {
    const ErrorGrid errors(result, result.machine.tools[0], grid);
    errors.displacement_covariances();
    sum_planes(errors.displacements());
  });
}

void count_csv() {
  const ReferenceProblem problem = reference_problem(kCountedGrid);
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "x_mm,y_mm,z_mm,length_mm\n");
  for (int i = 0; i < kCountedRows; ++i) {
    fmt::format_to(std::back_inserter(text), "{:.3f},{:.3f},{:.3f},{:.7f}\n", i % 1000 + 0.125,
                   i % 600 + 0.25, i % 500 + 0.5, 100.0 + 0.0653217 * i);
  }
  run_counted([&] {
    const CsvTable table = CsvTable::parse(fmt::to_string(text), "readings.csv", {});
    read_readings(table, {}, problem.campaign.machine, find_instrument("laser-tracer")->schema());
  });
}

void count_projection() {
  const ReferenceProblem problem = reference_problem(kCountedGrid);
  const FitResult result = counted_fit(problem);
  const LinearModel model(problem.campaign, result);
  const std::vector<NoiseParameters> noise(1, NoiseParameters{.white = 1.0});
  const Projector projector(model.problem(), model.problem().data, noise, 1, model.parts());
  const Eigen::MatrixXd columns = Eigen::MatrixXd::NullaryExpr(
      static_cast<Eigen::Index>(model.size()), kCountedColumns, [](Eigen::Index row, Eigen::Index column) {
        return static_cast<double>((7 * row + 13 * column) % 101) - 50.0;
      });
  run_counted([&] { projector.project(columns); });
}

void run_instructions(int count, char** values) {
  const std::map<std::string, void (*)()> workloads = {{"fit", count_fit},
                                                       {"draws", count_draws},
                                                       {"grid", count_grid},
                                                       {"csv", count_csv},
                                                       {"projection", count_projection}};
  const auto found = count == 2 ? workloads.find(values[1]) : workloads.end();
  if (found == workloads.end())
    throw std::invalid_argument("give one workload: fit, draws, grid, csv, projection");
  use_single_threaded_blas();
  found->second();
}

}  // namespace
}  // namespace volcal::bench

int main(int count, char** values) {
  return volcal::bench::run_program("instructions_bench",
                                    [&] { volcal::bench::run_instructions(count, values); });
}
