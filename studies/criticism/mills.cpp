#include "volcal/studies/criticism/mills.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/study.h"
#include "volcal/studies/criticism/yardstick.h"
#include "volcal/studies/files/finished_campaigns.h"

namespace volcal::studies {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(DiagnosedMill, seed, hidden, found, other_functions, wrong_effects,
                                   given_um, offered_um, without, seconds)

namespace {

constexpr const char* kRack = "rack";
constexpr int kTilts = 9;  // positions of B
constexpr int kTurns = 8;  // positions of C
constexpr double kNoise = 8e-6;
constexpr double kDisplacement = 40e-6;  // RMS of an error function over what it moves through, m
constexpr double kRotation = 70e-6;      // rad
constexpr double kMoved = 0.45;          // m: linear axes follow the head by so much to either side
constexpr double kLeastSize = 0.5;       // of an error function, as a share of these
constexpr double kLargestSize = 1.5;
constexpr int kDegrees = 4;
constexpr int kRotaryHarmonics = 2;
constexpr int kFewestFunctions = 6;
constexpr int kMostFunctions = 8;

Machine mill() {
  Machine machine;
  machine.name = "mill with B/C head";
  machine.structure = Structure::parse("w b Y X Z C B t");
  const std::map<AxisName, double> travel = {{AxisName::X, 3.3},
                                             {AxisName::Y, 1.7},
                                             {AxisName::Z, 1.2},
                                             {AxisName::C, 2.0 * std::numbers::pi},
                                             {AxisName::B, 10.0 / 9.0 * std::numbers::pi}};
  for (const Joint& joint : machine.structure.joints) {
    Axis axis;
    axis.name = joint.axis;
    axis.travel_max = 0.5 * travel.at(joint.axis);
    axis.travel_min = -axis.travel_max;
    if (joint.axis == AxisName::B) axis.centre = {0.0, 0.0, -0.27};
    machine.axes.push_back(axis);
  }
  machine.tools = {{"T1", {0.0, -0.02, -0.68}, 0.0}};
  return machine;
}

/// Of a degree, between -1 and 1 over what the axis moves through.
double legendre(int degree, double x) { return std::legendre(static_cast<unsigned>(degree), x); }

/// Polynomials to the fourth degree, of a rotary axis two harmonics, with a given RMS; zero at home.
sim::ErrorFunction function_of(ErrorSymbol symbol, sim::RandomStream& random) {
  const bool turns = is_rotary(symbol.axis);
  std::vector<double> coefficients;
  double square = 0.0;
  for (int k = 1; k <= (turns ? 2 * kRotaryHarmonics : kDegrees); ++k) {
    const int order = turns ? (k + 1) / 2 : k;
    coefficients.push_back(random.normal() / order);
    square += std::pow(coefficients.back(), 2) * (turns ? 0.5 : 1.0 / (2 * order + 1));
  }
  const double size = (is_rotation(symbol.component) ? kRotation : kDisplacement) *
                      random.uniform(kLeastSize, kLargestSize) / std::sqrt(square);
  return [=](double q) {
    double value = 0.0;
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      const int k = static_cast<int>(i) + 1, harmonic = (k + 1) / 2;
      value += coefficients[i] * (!turns       ? legendre(k, q / kMoved) - legendre(k, 0.0)
                                  : k % 2 == 1 ? std::cos(harmonic * q) - 1.0
                                               : std::sin(harmonic * q));
    }
    return size * value;
  };
}

std::vector<ErrorSymbol> all_functions(const Machine& machine) {
  std::vector<ErrorSymbol> symbols;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) symbols.push_back({component, axis.name});
  }
  return symbols;
}

/// Six to eight of them.
std::set<ErrorSymbol> drawn_functions(const Machine& machine, sim::RandomStream& random) {
  const std::vector<ErrorSymbol> all = all_functions(machine);
  const auto count = static_cast<std::size_t>(random.uniform(kFewestFunctions, kMostFunctions + 1));
  std::set<ErrorSymbol> chosen;
  while (chosen.size() < count)
    chosen.insert(all[static_cast<std::size_t>(random.uniform() * static_cast<double>(all.size()))]);
  return chosen;
}

sim::Measurement measurement(bool by_probe) {
  sim::RotaryPoses poses;
  poses.spheres = {{"S", {0.0, 0.0, -0.68}}};
  poses.grid.points = {{AxisName::B, kTilts}, {AxisName::C, kTurns}};
  poses.grid.range = {{AxisName::B, {-0.5 * std::numbers::pi, 0.5 * std::numbers::pi}}};
  const sim::NoiseLevel noise{.constant = kNoise};
  sim::Measurement measurement;
  if (by_probe) {
    sim::ProbedSphere probed;
    probed.poses = poses;
    probed.contacts = true;
    probed.noise = noise;
    measurement.settings = probed;
  } else {
    sim::RTest read;
    read.poses = poses;
    read.noise = noise;
    measurement.settings = read;
  }
  return measurement;
}

struct SimulatedMill {
  sim::Study study;
  std::vector<std::string> hidden;
};

SimulatedMill simulated_mill(std::uint64_t seed) {
  SimulatedMill mill_of;
  sim::Study& study = mill_of.study;
  study.machine = mill();
  study.seed = seed;
  study.unseen = true;
  study.truth.perfect = true;
  sim::RandomStream random(seed, "errors of the mill");
  std::map<ErrorSymbol, sim::ErrorFunction> functions;
  for (const ErrorSymbol symbol : drawn_functions(study.machine, random)) {
    functions[symbol] = function_of(symbol, random);
    mill_of.hidden.push_back(symbol.name());
  }
  study.truth.alter = [functions](sim::TruthMachine& truth) {
    for (const auto& [symbol, function] : functions) truth.set_error(symbol, function);
  };
  if (seed % 2 == 0) {
    sim::HiddenEffect& rack = study.hidden.emplace_back();
    rack.kind = "screw-lead";
    rack.options.set("symbol", std::string("EXX"));
    rack.options.set("period", random.uniform(0.08, 0.2));
    rack.options.set("phase", random.uniform(0.0, 2.0 * std::numbers::pi));
    rack.amplitude = random.uniform(20e-6, 50e-6);
    mill_of.hidden.emplace_back(kRack);
  }
  study.measurements.push_back(measurement(seed / 2 % 2 == 0));
  return mill_of;
}

ModelSpec location_errors_alone(const Machine& machine) {
  ModelSpec model;
  for (const ErrorSymbol symbol : all_functions(machine)) model.functions[symbol].basis = "zero";
  model.locations_off = squareness_errors(machine);
  return model;
}

std::vector<std::string> names_of(const std::set<SearchRule>& rules) {
  std::vector<std::string> names;
  for (const SearchRule rule : rules) names.emplace_back(name_of(rule));
  return names;
}

void judge(const std::vector<EffectFinding>& accepted, const std::vector<std::string>& hidden,
           DiagnosedMill& record) {
  const auto is_hidden = [&](const std::string& name) {
    return std::ranges::find(hidden, name) != hidden.end();
  };
  for (const EffectFinding& effect : accepted) {
    if (effect.name.kind == "rack-error" && effect.name.target.name() == "EXX" && is_hidden(kRack)) {
      record.found.emplace_back(kRack);
    } else if (effect.name.kind != kLeftOut) {
      record.wrong_effects.push_back(effect.label);
    } else {
      for (const MachineError& error : errors_given_back(effect.spec)) {
        if (error.location()) continue;
        const std::string symbol = error.name();
        (is_hidden(symbol) ? record.found : record.other_functions).push_back(symbol);
      }
    }
  }
}

double offered_error(const sim::SimulatedCampaign& simulated, const ModelSpec& offered) {
  try {
    return std::sqrt(unseen_square(simulated, fitted(simulated.campaign, offered)));
  } catch (const InputError&) {
    return 0.0;  // more errors than the readings tell apart
  }
}

DiagnosedMill diagnosed_mill(std::uint64_t seed, const std::set<SearchRule>& without) {
  const auto [study, hidden] = simulated_mill(seed);
  const sim::SimulatedCampaign simulated = sim::simulate(study);
  const ModelSpec model = location_errors_alone(study.machine);
  const FitResult given = fitted(simulated.campaign, model);
  DiagnoseOptions options;
  options.compare = false;
  options.figures = false;
  options.threads = 1;
  options.climb = true;
  options.rules.off = without;
  const auto start = std::chrono::steady_clock::now();
  const Diagnosis diagnosis = diagnose(simulated.campaign, given, options);
  DiagnosedMill record;
  record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  record.seed = seed;
  record.hidden = hidden;
  record.without = names_of(without);
  const std::vector<EffectFinding> accepted = accepted_effects(diagnosis);
  judge(accepted, hidden, record);
  record.given_um = std::sqrt(unseen_square(simulated, given));
  record.offered_um = offered_error(simulated, extended_model(model, simulated.campaign, accepted));
  return record;
}

}  // namespace

std::vector<DiagnosedMill> mill_study(const MillStudyOptions& options) {
  std::map<std::uint64_t, DiagnosedMill> known;
  const std::uint64_t end = options.seed + static_cast<std::uint64_t>(options.campaigns);
  FinishedCampaigns finished(
      options.output, "mills.jsonl", options.resume,
      [&](const nlohmann::json& json, const SourcePlace& place) {
        auto record = json.get<DiagnosedMill>();
        if (record.seed < options.seed || record.seed >= end || record.without != names_of(options.without))
          throw InputError(place, "it holds campaigns of another seed or other rules",
                           "give the same, or choose another folder");
        known[record.seed] = std::move(record);
      });
  const auto seed_of = [&](std::size_t i) { return options.seed + static_cast<std::uint64_t>(i); };
  return all_campaigns<DiagnosedMill>(
      static_cast<std::size_t>(options.campaigns), options.threads, options.progress,
      [&](std::size_t i) { return finished_before(known, seed_of(i)); },
      [&](std::size_t i) { return diagnosed_mill(seed_of(i), options.without); },
      [&](std::size_t, const DiagnosedMill& record) { finished.append(record); });
}

}  // namespace volcal::studies
