// Times what an identified machine is evaluated with, part by part, and prints the figures as JSON.
//
//   evaluation_bench PART --folder DIR [--threads N] [--repeats N]
//
// PART: covariance, volume, field, points, effect, transforms_3, transforms_5, csv, grid_file. `volume` and
// `csv` leave in DIR what the peer reads: covariance.f64, rows.f64 (three per node), covariances.f64 (six
// numbers per node); readings.csv.

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "ceres_covariance.h"
#include "chains.h"
#include "measure.h"
#include "reference_problem.h"
#include "tests/support/error_oracles.h"
#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/error_grid.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/linear_axis_errors.h"
#include "volcal/identify/io/campaign/readings_reader.h"
#include "volcal/identify/numeric/blas_core.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/text/plain_number.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/sim/machine/random.h"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace volcal::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<int, 3> kGrid = {11, 9, 8};
constexpr int kCovarianceNodes = 21;      // per axis
constexpr int kFieldNodes = 300;          // per axis
constexpr std::size_t kPoints = 200'000;  // at random
constexpr int kFileNodes = 215;           // per axis of a grid of 10^7 points
constexpr int kSmallFileNodes = 60;       // per axis
constexpr std::size_t kPoses = 16384;
constexpr std::size_t kReadings = 1'000'000;
constexpr std::uint64_t kSeedOfEvaluation = 5;

struct EvaluationArguments {
  std::string part;
  std::string folder = ".";
  int threads = 1;
  int repeats = 7;
};

EvaluationArguments parse_evaluation(int count, char** values) {
  if (count < 2)
    throw std::invalid_argument("evaluation_bench PART [--folder DIR] [--threads N] [--repeats N]");
  EvaluationArguments arguments;
  arguments.part = values[1];
  read_options(count, values, 2,
               {{"--folder", into(arguments.folder)},
                {"--threads", into(arguments.threads)},
                {"--repeats", into(arguments.repeats)}});
  return arguments;
}

/// Times of each kind of work, in rounds of all of them.
class Rounds {
 public:
  void add(const std::string& name, std::function<void()> work) {
    works_.emplace_back(name, std::move(work));
  }

  Json json(int repeats) const {
    for (const auto& [name, work] : works_) work();
    std::map<std::string, std::vector<double>> times;
    for (int i = 0; i < repeats; ++i) {
      for (const auto& [name, work] : works_) times[name + "_s"].push_back(seconds(work));
    }
    return times;
  }

 private:
  std::vector<std::pair<std::string, std::function<void()>>> works_;
};

/// The reference problem, identified.
struct Identified {
  explicit Identified(int threads, std::vector<EffectSpec> effects = {}) : problem(reference_problem(kGrid)) {
    problem.model.effects = std::move(effects);
    FitOptions options;
    options.noise = NoisePolicy::White;
    options.threads = threads;
    result = fit(problem.campaign, problem.model, options);
  }
  const Tool& tool() const { return result.machine.tools[1]; }

  ReferenceProblem problem;
  FitResult result;
};

void write_numbers(const std::string& path, const double* numbers, std::size_t count) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(numbers), static_cast<std::streamsize>(count * sizeof(double)));
}

Json covariance_part(const EvaluationArguments& arguments) {
  const CovariancePeers peers(reference_problem(kGrid), arguments.threads);
  Eigen::MatrixXd own, of_ceres;
  Rounds rounds;
  rounds.add("own", [&] { own = peers.from_normal_equations(); });
  rounds.add("ceres", [&] { of_ceres = peers.by_ceres(); });
  Json json = rounds.json(arguments.repeats);
  const Eigen::VectorXd u = of_ceres.diagonal().cwiseSqrt();
  json["difference"] = (own - of_ceres).cwiseQuotient(u * u.transpose()).cwiseAbs().maxCoeff();
  json["parameters"] = own.rows();
  json["readings"] = peers.readings();
  return json;
}

/// Three rows per node.
Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> error_rows(const Identified& machine,
                                                                                  const AxisGrid& grid) {
  const std::vector<AxisPosition> positions = grid.positions();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows(3 * positions.size(),
                                                                              machine.result.layout.size);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    rows.middleRows<3>(3 * static_cast<Eigen::Index>(i)) =
        ErrorField(machine.result, machine.tool()).rows(positions[i]).topRows<3>();
  }
  return rows;
}

Json volume_part(const EvaluationArguments& arguments) {
  const Identified machine(arguments.threads);
  const AxisGrid grid = axis_grid(machine.result.machine, kCovarianceNodes);
  std::vector<Covariance3> covariances;
  Rounds rounds;
  rounds.add("own", [&] {
    covariances = ErrorGrid(machine.result, machine.tool(), grid).displacement_covariances();
  });
  Json json = rounds.json(arguments.repeats);
  json["nodes"] = covariances.size();
  json["parameters"] = machine.result.layout.size;
  const Eigen::MatrixXd& covariance = machine.result.covariance;
  const auto rows = error_rows(machine, grid);
  write_numbers(arguments.folder + "/covariance.f64", covariance.data(),
                static_cast<std::size_t>(covariance.size()));
  write_numbers(arguments.folder + "/rows.f64", rows.data(), static_cast<std::size_t>(rows.size()));
  write_numbers(arguments.folder + "/covariances.f64", &covariances[0].xx, 6 * covariances.size());
  return json;
}

/// write(begin, end) of numbers, in as many parts as threads.
template <class Write>
void write_in_parts(std::vector<Eigen::Vector3d>& field, int threads, const Write& write) {
  double* const begin = field[0].data();
  const std::size_t count = 3 * field.size() / 16 * 16;
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) {
    const auto at = [&](int part) {
      return begin + count * static_cast<std::size_t>(part) / threads / 16 * 16;
    };
    others.emplace_back(write, at(i), at(i + 1));
  }
  write(begin, begin + count / static_cast<std::size_t>(threads) / 16 * 16);
  for (std::thread& other : others) other.join();
}

void write_ordinary(double* begin, const double* end) { std::fill_n(begin, end - begin, 1.5); }

void write_streaming(double* begin, const double* end) {
#if defined(__SSE2__)
  const __m128d number = _mm_set1_pd(1.5);
  while (reinterpret_cast<std::uintptr_t>(begin) % 16 != 0) *begin++ = 1.5;
  for (; begin + 2 <= end; begin += 2) _mm_stream_pd(begin, number);
  _mm_sfence();
#else
  write_ordinary(begin, end);
#endif
}

Json field_part(const EvaluationArguments& arguments) {
  const Identified machine(arguments.threads);
  const AxisGrid grid = axis_grid(machine.result.machine, kFieldNodes);
  const auto [a, b, c] = grid.counts();
  std::vector<Eigen::Vector3d> field(a * b * c);
  Rounds rounds;
  rounds.add("own", [&] {
    sum_planes(ErrorGrid(machine.result, machine.tool(), grid).displacements(), arguments.threads, field);
  });
  rounds.add("ordinary", [&] { write_in_parts(field, arguments.threads, write_ordinary); });
  rounds.add("streaming", [&] { write_in_parts(field, arguments.threads, write_streaming); });
  Json json = rounds.json(arguments.repeats);
  json["points"] = field.size();
  return json;
}

double largest_difference(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).cwiseAbs().maxCoeff());
  return largest;
}

std::vector<AxisPosition> random_positions(const Machine& machine) {
  sim::RandomStream random(kSeedOfEvaluation, "points");
  std::vector<AxisPosition> positions(kPoints);
  for (AxisPosition& position : positions) {
    for (const Axis& axis : machine.axes)
      position[index_of(axis.name)] = random.uniform(axis.travel_min, axis.travel_max);
  }
  return positions;
}

Json points_part(const EvaluationArguments& arguments) {
  const Identified machine(arguments.threads);
  const std::vector<AxisPosition> positions = random_positions(machine.result.machine);
  const Conditions conditions = default_conditions(machine.result);
  const auto many = LinearAxisErrors::make(machine.result, machine.tool().offset,
                                           MachineEffects(machine.result, machine.tool(), conditions));
  const DisplacementField one = displacement_field(machine.result, machine.tool(), conditions);
  const DisplacementField plain =
      testing::plain_displacement_field(machine.result, machine.tool(), conditions);
  const ApproachDirection mean{};
  std::vector<Eigen::Vector3d> errors(kPoints), same(kPoints);
  const auto one_by_one = [&](const DisplacementField& field) {
    for (std::size_t i = 0; i < kPoints; ++i) same[i] = field(positions[i], mean);
  };
  Rounds rounds;
  rounds.add("own", [&] { many->at(positions, {&mean, 1}, errors); });
  rounds.add("one_by_one", [&] { one_by_one(one); });
  rounds.add("plain", [&] { one_by_one(plain); });
  Json json = rounds.json(arguments.repeats);
  json["largest_difference_m"] = largest_difference(errors, same);
  json["points"] = kPoints;
  return json;
}

/// What one effect costs: the same work on the machine identified without and with it.
Json effect_part(const EvaluationArguments& arguments) {
  const Identified rigid(arguments.threads), extended(arguments.threads, {coupling()});
  const std::vector<AxisPosition> positions = random_positions(rigid.result.machine);
  Rounds rounds;
  std::vector<Eigen::Vector3d> errors(kPoints);
  std::size_t bytes = 0;
  for (const auto& [machine, name] : {std::pair(&rigid, ""), std::pair(&extended, "_effect")}) {
    const FitResult& result = machine->result;
    const Tool& tool = machine->tool();
    const std::string suffix = name;
    rounds.add("covariances" + suffix, [&result, &tool] {
      ErrorGrid(result, tool, axis_grid(result.machine, kCovarianceNodes)).displacement_covariances();
    });
    rounds.add("grid_file" + suffix, [&result, &bytes] {
      const TableFile grid = spatial_grid_file("volumetric_grid.csv", result, kSmallFileNodes,
                                               default_conditions(result), TableContent::Errors);
      bytes = 0;
      grid.further([&bytes](std::string_view text) { bytes += text.size(); });
    });
    const DisplacementField field = displacement_field(result, tool, default_conditions(result));
    rounds.add("points" + suffix, [&positions, &errors, field] {
      for (std::size_t i = 0; i < kPoints; ++i) errors[i] = field(positions[i], kTowardsPlus);
    });
  }
  Json json = rounds.json(arguments.repeats);
  json["nodes"] = kCovarianceNodes * kCovarianceNodes * kCovarianceNodes;
  json["file_points"] = kSmallFileNodes * kSmallFileNodes * kSmallFileNodes;
  json["file_bytes"] = bytes;
  json["points"] = kPoints;
  return json;
}

Json transforms_of(const std::string& structure, const EvaluationArguments& arguments) {
  const Poses poses = random_poses(structure, kPoses);
  std::vector<Eigen::Vector3d> exact, small, twists, lanes;
  Rounds rounds;
  rounds.add("exact", [&] { volumetric_errors(poses, Transforms::Exact, exact); });
  rounds.add("small", [&] { volumetric_errors(poses, Transforms::SmallAngles, small); });
  rounds.add("twists", [&] { volumetric_errors(poses, Transforms::Twists, twists); });
  rounds.add("lanes", [&] { volumetric_errors(poses, Transforms::TwistsInLanes, lanes); });
  Json json = rounds.json(arguments.repeats);
  json["points"] = exact.size();
  json["largest_difference_m"] =
      std::max({largest_difference(exact, small), largest_difference(exact, twists),
                largest_difference(exact, lanes)});
  return json;
}

Json transforms_3_part(const EvaluationArguments& arguments) {
  return transforms_of("w X' b Y Z t", arguments);
}

Json transforms_5_part(const EvaluationArguments& arguments) {
  return transforms_of("w C' A' X' b Y Z t", arguments);
}

void write_readings(const std::string& path) {
  sim::RandomStream random(kSeedOfEvaluation, "readings");
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "x_mm,y_mm,z_mm,length_mm\n");
  for (std::size_t i = 0; i < kReadings; ++i) {
    fmt::format_to(out, "{:.3f},{:.3f},{:.3f},{:.7f}\n", random.uniform(0.0, 1000.0),
                   random.uniform(0.0, 600.0), random.uniform(0.0, 500.0), random.uniform(100.0, 1500.0));
  }
  std::ofstream(path, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
}

/// Sum of all numbers of a text, which holds nothing else but separators of one character.
double sum_of_numbers(const std::string& text) {
  const char* at = text.data() + text.find('\n') + 1;
  const char* const end = text.data() + text.size();
  double sum = 0.0;
  while (at < end) {
    double value = 0.0;
    const char* next = read_plain_number(at, end, '.', value);
    if (next == nullptr) next = fast_float::from_chars(at, end, value).ptr;
    at = next + 1;
    sum += value;
  }
  return sum;
}

Json csv_part(const EvaluationArguments& arguments) {
  const std::string path = arguments.folder + "/readings.csv";
  write_readings(path);
  const ReferenceProblem problem = reference_problem({2, 2, 2});
  const std::string text = read_text_file(path, {});
  Readings readings;
  double sum = 0.0;
  Rounds rounds;
  rounds.add("reader", [&] {
    readings = read_readings(CsvTable::read(path, {}), {}, problem.campaign.machine,
                             find_instrument("laser-tracer")->schema());
  });
  rounds.add("parser", [&] { sum = sum_of_numbers(text); });
  Json json = rounds.json(arguments.repeats);
  json["readings"] = readings.size();
  json["bytes"] = text.size();
  json["sum"] = sum;
  return json;
}

/// Writes text again and again, `bytes` in all.
void write_bytes(const std::string& path, std::size_t bytes) {
  const std::string text(std::size_t{1} << 20U, '7');
  std::ofstream file(path, std::ios::binary);
  for (std::size_t done = 0; done < bytes; done += text.size())
    file.write(text.data(), static_cast<std::streamsize>(std::min(text.size(), bytes - done)));
}

Json grid_file_part(const EvaluationArguments& arguments) {
  const Identified machine(arguments.threads);
  const std::string path = arguments.folder + "/volumetric_grid.csv";
  const TableFile grid = spatial_grid_file("volumetric_grid.csv", machine.result, kFileNodes,
                                           default_conditions(machine.result), TableContent::Errors);
  std::size_t bytes = 0;
  Rounds rounds;
  rounds.add("own", [&] {
    std::ofstream file(path, std::ios::binary);
    file << grid.content;
    grid.further([&file](std::string_view text) { file << text; });
    bytes = static_cast<std::size_t>(file.tellp());
  });
  rounds.add("write", [&] { write_bytes(path, bytes); });
  Json json = rounds.json(1);  // gigabytes
  std::remove(path.c_str());
  json["points"] = kFileNodes * kFileNodes * kFileNodes;
  json["tools"] = machine.result.machine.tools.size();
  json["bytes"] = bytes;
  return json;
}

Json run_evaluation(const EvaluationArguments& arguments) {
  const std::map<std::string, Json (*)(const EvaluationArguments&)> parts = {
      {"covariance", covariance_part},
      {"volume", volume_part},
      {"field", field_part},
      {"points", points_part},
      {"effect", effect_part},
      {"transforms_3", transforms_3_part},
      {"transforms_5", transforms_5_part},
      {"csv", csv_part},
      {"grid_file", grid_file_part}};
  const auto found = parts.find(arguments.part);
  if (found == parts.end()) throw std::invalid_argument("there is no part " + arguments.part);
  use_single_threaded_blas();
  Json json = found->second(arguments);
  json["threads"] = arguments.threads;
  json["blas"] = blas_core();
  json["peak_bytes"] = peak_memory();
  return json;
}

}  // namespace
}  // namespace volcal::bench

int main(int count, char** values) {
  return volcal::bench::run_program("evaluation_bench", [&] {
    std::cout << volcal::bench::run_evaluation(volcal::bench::parse_evaluation(count, values)) << '\n';
  });
}
