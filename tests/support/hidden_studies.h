#pragma once
/// Small simulated campaigns with effects hidden in them.

#include <Eigen/Core>
#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/criticism/scans/generic_scan.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal::testing_support {

/// The error functions of hiding() are polynomials of degree 7. A model of these has a quarter of the
/// parameters of the default one and leaves none of a function to an effect.
inline ModelSpec polynomials() {
  ModelSpec model;
  model.default_function.basis = "legendre";
  model.default_function.degree = 7;
  return model;
}

inline sim::Study hiding(std::vector<sim::HiddenEffect> hidden, const Eigen::Vector3i& grid = {6, 5, 5}) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 31;
  study.truth.random.wave_scale = 0.0;
  study.environment.channels = {
      {.name = "column", .start = 20.0, .drift = 0.6 / 3600.0, .amplitude = 0.2, .period = 9000.0}};
  study.hidden = std::move(hidden);
  sim::Tracking tracking;
  tracking.grid = grid;
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 10;
  return study;
}

inline sim::HiddenEffect reversal(const std::string& symbol, double rms) {
  sim::HiddenEffect effect{.kind = "reversal", .options = {}, .rms = rms};
  effect.options.set("symbol", symbol);
  return effect;
}

/// A study simulated, fitted and linearised.
struct FittedStudy {
  explicit FittedStudy(const sim::Study& study, const ModelSpec& spec = polynomials())
      : simulated(sim::simulate(study)),
        result(fit(simulated.campaign, spec)),
        model(simulated.campaign, result) {}

  sim::SimulatedCampaign simulated;
  FitResult result;
  LinearModel model;
};

inline std::vector<Variable> variables_named(const std::vector<std::string>& names) {
  std::vector<Variable> variables;
  for (const std::string& name : names) variables.push_back(Variable::parse(name).value());
  return variables;
}

/// A campaign with nothing hidden, and its recorded variables; made once per program.
inline const LinearModel& model_of_nothing_hidden() {
  static const FittedStudy fitted(hiding({}, {5, 4, 3}));
  return fitted.model;
}
inline const std::vector<ScanVariable>& variables_of_nothing_hidden() {
  static const std::vector<ScanVariable> all = scan_variables(model_of_nothing_hidden());
  return all;
}
inline const Eigen::VectorXd& value_of_variable(const std::string& name) {
  return std::ranges::find(variables_of_nothing_hidden(), name, &ScanVariable::name)->value;
}

/// Families of a kind; `target` empty = all.
inline std::vector<Family> families_of(const LinearModel& model, const std::string& kind,
                                       const std::string& target = "") {
  std::vector<Family> chosen;
  for (Family& family : families(model)) {
    const EffectName name = family.name();
    if (name.kind == kind && (target.empty() || name.target.name() == target))
      chosen.push_back(std::move(family));
  }
  return chosen;
}

/// Projector for other residuals of the same campaign, white noise of the stated sigma.
inline Projector white_projector(const LinearModel& model, const Eigen::VectorXd& residual) {
  NoiseProblem problem = model.problem();
  problem.residual = residual;
  problem.prior_mean.setZero();
  const std::vector<NoiseParameters> white(model.noise_groups().size());
  return {problem, problem.data, white, 1, model.parts()};
}

/// White residuals of the stated sigma.
inline Eigen::VectorXd white_residual(const LinearModel& model, std::mt19937_64& random) {
  Eigen::VectorXd residual(static_cast<Eigen::Index>(model.size()));
  std::normal_distribution<double> normal;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    residual[i] = model.problem().data.sigma[static_cast<std::size_t>(i)] * normal(random);
  }
  return residual;
}

}  // namespace volcal::testing_support
