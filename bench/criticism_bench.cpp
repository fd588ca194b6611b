// Times the projection of candidate effects on the reference campaign (8 runs of 756 laser-tracer readings,
// or of a coarser grid) and prints the figures as JSON.
//
//   criticism_bench --threads N --repeats N [--grid NX,NY,NZ] [--write DIR]
//
// --write stores what another program needs for the same step: problem.json and little-endian doubles,
// matrices column by column.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "measure.h"
#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/scans/generic_scan.h"
#include "volcal/identify/noise/noise_estimate.h"
#include "volcal/identify/numeric/blas_core.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal::bench {
namespace {

using Json = nlohmann::ordered_json;
constexpr Eigen::Index kBlockColumns = 512;

struct CriticismArguments {
  int threads = 1;
  int repeats = 5;
  Eigen::Vector3i grid = sim::Tracking{}.grid;
  std::string folder;
};

Eigen::Vector3i grid_from(const std::string& text) {
  Eigen::Vector3i grid;
  char comma = 0;
  std::istringstream stream(text);
  if (!(stream >> grid[0] >> comma >> grid[1] >> comma >> grid[2]))
    throw std::invalid_argument("--grid " + text + " is not NX,NY,NZ");
  return grid;
}

CriticismArguments parse_criticism(int count, char** values) {
  CriticismArguments arguments;
  read_options(count, values, 1,
               {{"--threads", into(arguments.threads)},
                {"--repeats", into(arguments.repeats)},
                {"--grid", [&](const std::string& value) { arguments.grid = grid_from(value); }},
                {"--write", into(arguments.folder)}});
  return arguments;
}

Campaign reference_campaign(const Eigen::Vector3i& grid) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 31;
  study.environment.channels = {
      {.name = "column", .start = 20.0, .drift = 0.6 / 3600.0, .amplitude = 0.2, .period = 9000.0}};
  sim::Tracking tracking;
  tracking.grid = grid;
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 10;
  return sim::simulate(study).campaign;
}

/// Columns of every family at every shape, and what they are projected with.
struct Step {
  explicit Step(const Campaign& campaign)
      : result(fit(campaign, ModelSpec{})), model(campaign, result), all(families(model)) {
    noise = {NoiseParameters{.white = 1.0, .drift = 0.3e-6, .tau = 600.0, .line = 0.3e-6, .per_metre = 0.0}};
    for (const Family& family : all) {
      for (std::size_t i = 0; i < family.scan.size(); ++i) widths.push_back(family.amplitudes());
    }
    columns.resize(static_cast<Eigen::Index>(model.size()),
                   std::accumulate(widths.begin(), widths.end(), 0L));
    Eigen::Index at = 0;
    for (const Family& family : all) {
      for (const Eigen::VectorXd& shape : family.scan) {
        columns.middleCols(at, family.amplitudes()) = family_columns(model, family, shape);
        at += family.amplitudes();
      }
    }
  }

  /// LM of every family at every shape.
  std::vector<double> run(const Projector& projector, int threads) const {
    std::vector<double> lm(widths.size());
    std::vector<std::pair<std::size_t, Eigen::Index>> blocks;  // first shape, first column
    Eigen::Index at = 0, first = -kBlockColumns;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      if (at + widths[i] > first + kBlockColumns) blocks.emplace_back(i, first = at);
      at += widths[i];
    }
    run_parallel(blocks.size(), threads, [&](std::size_t block) {
      const std::size_t end = block + 1 < blocks.size() ? blocks[block + 1].first : widths.size();
      const auto [begin, column] = blocks[block];
      CandidateColumns candidates;
      candidates.groups.assign(widths.begin() + static_cast<std::ptrdiff_t>(begin),
                               widths.begin() + static_cast<std::ptrdiff_t>(end));
      candidates.count = std::accumulate(candidates.groups.begin(), candidates.groups.end(), 0L);
      const auto& parts = model.parts();
      const Eigen::Index left = column;
      candidates.fill = [&, left](std::size_t part, Eigen::Ref<Eigen::MatrixXd> rows) {
        rows = columns.block(parts[part], left, rows.rows(), rows.cols());
      };
      const ProjectedColumns projected = projector.project(candidates);
      for (std::size_t i = begin; i < end; ++i)
        lm[i] = score_test(projected, projected.first[i - begin], widths[i]).lm;
    });
    return lm;
  }

  FitResult result;
  LinearModel model;
  std::vector<Family> all;
  std::vector<NoiseParameters> noise;
  std::vector<Eigen::Index> widths;
  Eigen::MatrixXd columns;
};

void write_matrix(const std::string& file, const Eigen::MatrixXd& matrix) {
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(matrix.data()),
             static_cast<std::streamsize>(sizeof(double)) * matrix.size());
}

void write_step(const Step& step, const std::vector<double>& lm, const std::string& folder) {
  const NoiseProblem& problem = step.model.problem();
  std::filesystem::create_directories(folder);
  Json json{{"observations", problem.jacobian.rows()},
            {"parameters", problem.jacobian.cols()},
            {"widths", step.widths},
            {"lm", lm},
            {"sigma", problem.data.sigma}};
  const NoiseParameters& noise = step.noise.front();
  json["noise"] = {{"white", noise.white}, {"wander", noise.drift}, {"tau", noise.tau}, {"line", noise.line}};
  for (const NoiseSequence& sequence : problem.data.sequences) {
    json["sequences"].push_back(
        {{"observation", sequence.observation}, {"time", sequence.time}, {"line", sequence.line}});
  }
  std::ofstream(folder + "/problem.json") << json.dump() << '\n';
  write_matrix(folder + "/jacobian.f64", problem.jacobian.whole());
  write_matrix(folder + "/residual.f64", problem.residual);
  write_matrix(folder + "/precision.f64", problem.prior_precision);
  write_matrix(folder + "/mean.f64", problem.prior_mean);
  write_matrix(folder + "/columns.f64", step.columns);
}

Json run_criticism(const CriticismArguments& arguments) {
  const Campaign campaign = reference_campaign(arguments.grid);
  const Step step(campaign);
  std::vector<double> setup_s, step_s, families_s, generic_s;
  std::vector<double> lm;
  const auto variables = scan_variables(step.model);
  for (int i = 0; i < arguments.repeats; ++i) {
    const auto make = [&] {
      return Projector(step.model.problem(), step.model.problem().data, step.noise, arguments.threads,
                       step.model.parts());
    };
    setup_s.push_back(seconds([&] { static_cast<void>(make()); }));
    const Projector projector = make();
    step_s.push_back(seconds([&] { lm = step.run(projector, arguments.threads); }));
    families_s.push_back(seconds(
        [&] { static_cast<void>(test_families(step.model, step.all, projector, arguments.threads)); }));
    generic_s.push_back(seconds(
        [&] { static_cast<void>(generic_scan(step.model, variables, projector, arguments.threads)); }));
  }
  if (!arguments.folder.empty()) write_step(step, lm, arguments.folder);
  return {{"readings", step.model.size()},
          {"parameters", step.model.problem().jacobian.cols()},
          {"families", step.all.size()},
          {"shapes", step.widths.size()},
          {"columns", step.columns.cols()},
          {"threads", arguments.threads},
          {"blas", blas_core()},
          {"peak_bytes", peak_memory()},
          {"setup_s", setup_s},
          {"projection_s", step_s},
          {"families_s", families_s},
          {"generic_s", generic_s}};
}

}  // namespace
}  // namespace volcal::bench

int main(int count, char** values) {
  return volcal::bench::run_program("criticism_bench", [&] {
    std::cout << volcal::bench::run_criticism(volcal::bench::parse_criticism(count, values)).dump(1) << '\n';
  });
}
