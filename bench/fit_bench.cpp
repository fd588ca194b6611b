// Times the fit of the reference problem and prints the figures as JSON.
//
//   fit_bench NX NY NZ --threads N --repeats N [--solver compressed|per-reading] [--target COST] [--write
//   DIR]
//
// --write stores the problem and its solution for another program: problem.json, readings.f64 (one row of
// x, y, z, length, sigma per reading, m, set-up by set-up).

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "measure.h"
#include "reference_problem.h"
#include "volcal/identify/numeric/blas_core.h"
#include "volcal/identify/solve/normals/minimise.h"
#include "volcal/identify/solve/normals/stated_sigma.h"

namespace volcal::bench {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kSameCost = 1e-11;  // relative
constexpr int kMaxIterations = 50;

struct FitArguments {
  std::array<int, 3> grid{};
  int threads = 1;
  int repeats = 5;
  SolverKind solver = SolverKind::Compressed;
  double target = 0.0;
  std::string folder;
};

FitArguments parse_fit(int count, char** values) {
  if (count < 4) throw std::invalid_argument("fit_bench NX NY NZ [--threads N] [--repeats N] ...");
  FitArguments arguments;
  for (int i = 0; i < 3; ++i) arguments.grid[static_cast<std::size_t>(i)] = std::stoi(values[i + 1]);
  read_options(count, values, 4,
               {{"--threads", into(arguments.threads)},
                {"--repeats", into(arguments.repeats)},
                {"--target", into(arguments.target)},
                {"--write", into(arguments.folder)},
                {"--solver", [&](const std::string& value) {
                   arguments.solver =
                       value == "per-reading" ? SolverKind::PerReading : SolverKind::Compressed;
                 }}});
  return arguments;
}

/// What a fit needs besides the campaign; its making is the benchmark's "set-up".
struct Problem {
  explicit Problem(const ReferenceProblem& problem)
      : model(problem.campaign, problem.model),
        index(model),
        start(model.initial_parameters()),
        datum(model.layout(), problem.campaign.machine, start),
        prior(GaussianPrior::none(datum.size())),
        sigma(stated_sigma(index, start)) {
    weight.reserve(sigma.size());
    for (const double s : sigma) weight.push_back(1.0 / (s * s));
  }

  MinimiseSummary fit(const MinimiseOptions& options, Eigen::VectorXd& z) const {
    z = datum.reduced(start);
    return minimise(index, weight, datum, prior, options, z);
  }

  MeasurementModel model;
  ReadingIndex index;
  Eigen::VectorXd start;
  DatumSpace datum;
  GaussianPrior prior;
  std::vector<double> sigma;
  std::vector<double> weight;
};

MinimiseOptions options_for(const FitArguments& arguments) {
  MinimiseOptions options;
  options.solver = arguments.solver;
  options.threads = arguments.threads;
  return options;
}

/// Fewest iterations that reach the target, as a user would stop them: by count.
int iterations_to(double target, const Problem& problem, MinimiseOptions options) {
  options.function_tolerance = 0.0;
  for (options.max_iterations = 1; options.max_iterations < kMaxIterations; ++options.max_iterations) {
    Eigen::VectorXd z;
    if (problem.fit(options, z).final_cost <= target * (1.0 + kSameCost)) return options.max_iterations;
  }
  throw std::runtime_error("the target cost was not reached");
}

std::vector<double> to_vector(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

Json axis_json(const Machine& machine, const ModelSpec& model, const Joint& joint) {
  const Axis& axis = machine.axis(joint.axis);
  const FunctionSpec& function = model.function({kAllComponents[0], joint.axis});
  return {{"name", std::string(1, letter_of(joint.axis))},
          {"workpiece_side", joint.workpiece_side},
          {"reference_point", to_vector(axis.reference_point)},
          {"degree", function.degree},
          {"breakpoints", function.breakpoints}};
}

void write_problem(const ReferenceProblem& source, const Problem& problem, const Eigen::VectorXd& solution,
                   double cost, const std::string& folder) {
  const Machine& machine = source.campaign.machine;
  Json json{{"start", to_vector(problem.datum.reduced(problem.start))},
            {"solution", to_vector(solution)},
            {"cost", cost}};
  for (const Joint& joint : machine.structure.joints) {
    json["joints"].push_back(axis_json(machine, source.model, joint));
  }
  for (const auto& function : problem.datum.functions()) {
    Json columns = Json::array();
    for (int k = 0; k < function.size(); ++k) columns.push_back(to_vector(function.basis.col(k)));
    json["functions"].push_back({{"axis", std::string(1, letter_of(function.symbol.axis))},
                                 {"component", index_of(function.symbol.component)},
                                 {"offset", function.offset},
                                 {"basis_columns", columns}});
  }
  for (const auto& block : problem.datum.blocks()) {
    const ParameterBlock& parameters = problem.model.layout().blocks[block.block];
    Json entry{{"name", parameters.name}, {"offset", block.offset}, {"size", block.size}};
    if (parameters.location) {
      entry["axis"] = std::string(1, letter_of(parameters.location->axis));
      entry["component"] = index_of(parameters.location->component);
    }
    json["blocks"].push_back(entry);
  }
  std::filesystem::create_directories(folder);
  std::ofstream readings(folder + "/readings.f64", std::ios::binary);
  std::size_t observation = 0;
  for (const Setup& setup : source.campaign.setups) {
    json["setups"].push_back({{"name", setup.name},
                              {"rows", setup.readings.size()},
                              {"tool", to_vector(machine.tools[setup.tool].offset)}});
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      const double values[] = {setup.readings.position[0][row], setup.readings.position[1][row],
                               setup.readings.position[2][row], setup.readings.value[0][row],
                               problem.sigma[observation++]};
      readings.write(reinterpret_cast<const char*>(values), sizeof values);
    }
  }
  std::ofstream(folder + "/problem.json") << json.dump(1) << '\n';
}

Json run_fit(const FitArguments& arguments) {
  const ReferenceProblem source = reference_problem(arguments.grid);
  std::vector<double> setup_s, fit_s, converged_s;
  for (int i = 1; i < arguments.repeats; ++i)
    setup_s.push_back(seconds([&] { const Problem unused(source); }));
  const auto begin = std::chrono::steady_clock::now();
  const Problem problem(source);
  setup_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());

  const MinimiseOptions defaults = options_for(arguments);
  Eigen::VectorXd z;
  MinimiseSummary summary;
  double target = arguments.target;
  if (target == 0.0) {
    MinimiseOptions exact = defaults;
    exact.function_tolerance = 1e-15;
    target = problem.fit(exact, z).final_cost;
  }
  MinimiseOptions to_target = defaults;
  to_target.function_tolerance = 0.0;
  to_target.max_iterations = iterations_to(target, problem, defaults);
  for (int i = 0; i < arguments.repeats; ++i) {
    converged_s.push_back(seconds([&] { summary = problem.fit(defaults, z); }));
    fit_s.push_back(seconds([&] { static_cast<void>(problem.fit(to_target, z)); }));
  }
  if (!arguments.folder.empty()) write_problem(source, problem, z, target, arguments.folder);
  return {{"readings", problem.index.observations()},
          {"parameters", problem.datum.size()},
          {"threads", arguments.threads},
          {"blas", blas_core()},
          {"target", target},
          {"setup_s", setup_s},
          {"fit_s", fit_s},
          {"iterations", to_target.max_iterations},
          {"converged_s", converged_s},
          {"converged_iterations", summary.iterations},
          {"peak_bytes", peak_memory()}};
}

}  // namespace
}  // namespace volcal::bench

int main(int count, char** values) {
  return volcal::bench::run_program("fit_bench", [&] {
    std::cout << volcal::bench::run_fit(volcal::bench::parse_fit(count, values)).dump(1) << '\n';
  });
}
