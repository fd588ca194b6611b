#include "volcal/identify/solve/smoothing.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "volcal/identify/solve/dense.h"

namespace volcal {
namespace {

constexpr double kStartAmplitude = 20e-6;    // m or rad
constexpr double kSmallestAmplitude = 1e-9;  // straight to 1 nm: no need to know it better
constexpr double kLargestAmplitude = 1e-2;
constexpr double kMinimumRedundancy = 5.0;  // fewer excess readings say nothing about a standard deviation
constexpr double kStep = 0.7;               // of log lambda per sweep: functions are updated side by side
constexpr double kNegligibleParameters = 0.05;
constexpr double kShapeChange = 1.0;  // counts as a change that is not small

struct Posterior {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd mean;
};

Posterior posterior(const std::vector<InstrumentEquations>& equations, const Eigen::VectorXd& z0,
                    const GaussianPrior& prior, const std::vector<double>& scale,
                    const std::vector<SmoothingTerm>& terms) {
  GaussianPrior total = prior;
  add_smoothing(terms, total);
  Eigen::VectorXd right_side = prior.precision * prior.mean;
  for (std::size_t g = 0; g < equations.size(); ++g) {
    const double weight = 1.0 / (scale[g] * scale[g]);
    total.precision += weight * equations[g].matrix;
    right_side += weight * (equations[g].matrix * z0 - equations[g].gradient);
  }
  const auto factor = cholesky_lower(total.precision);
  if (!factor)
    throw std::runtime_error("maximise_evidence: the posterior precision is not positive definite");
  Posterior result{inverse_from_cholesky(*factor), {}};
  result.mean = result.covariance * right_side;
  return result;
}

/// Takes the term's own prior out of its block of the posterior.
FunctionEvidence evidence_without(const SmoothingTerm& term, const Posterior& posterior) {
  const Eigen::Index n = term.precision().rows();
  const Eigen::LLT<Eigen::MatrixXd> block(posterior.covariance.block(term.offset, term.offset, n, n));
  const Eigen::MatrixXd total = block.solve(Eigen::MatrixXd::Identity(n, n));
  return {total - term.lambda * term.precision(), total * posterior.mean.segment(term.offset, n)};
}

double effective_parameters(const SmoothingTerm& term, const Posterior& posterior) {
  const Eigen::Index n = term.precision().rows();
  return static_cast<double>(n) -
         term.lambda *
             posterior.covariance.block(term.offset, term.offset, n, n).cwiseProduct(term.precision()).sum();
}

/// The functions of an axis ride on one guideway: they share the kind and the correlation length, by the sum
/// of their evidence; a few readings say too little about each alone. Returns the largest change of log
/// lambda.
double update_terms(const Posterior& posterior, std::vector<SmoothingTerm>& terms) {
  std::vector<std::vector<ShapeChoice>> choices(terms.size());
  std::map<AxisName, std::vector<double>> evidence_of_axis;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    if (!terms[t].estimate) continue;
    choices[t] = best_amplitudes(*terms[t].shapes, evidence_without(terms[t], posterior), kSmallestAmplitude,
                                 kLargestAmplitude);
    std::vector<double>& sum = evidence_of_axis[terms[t].symbol.axis];
    sum.resize(choices[t].size(), 0.0);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += choices[t][i].log_evidence;
  }
  double change = 0.0;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    SmoothingTerm& term = terms[t];
    if (!term.estimate) continue;
    const std::vector<double>& sum = evidence_of_axis.at(term.symbol.axis);
    const auto shape = static_cast<std::size_t>(std::ranges::max_element(sum) - sum.begin());
    const double step = kStep * std::log(choices[t][shape].lambda / term.lambda);
    const bool matters = effective_parameters(term, posterior) > kNegligibleParameters;
    if (matters) change = std::max({change, std::abs(step), shape == term.shape ? 0.0 : kShapeChange});
    term.shape = shape;
    term.lambda *= std::exp(step);
  }
  return change;
}

/// Largest relative change of a variance component.
double update_scales(const std::vector<InstrumentEquations>& equations, const Eigen::VectorXd& z0,
                     const Posterior& posterior, std::vector<double>& scale) {
  double change = 0.0;
  const Eigen::VectorXd step = posterior.mean - z0;
  for (std::size_t g = 0; g < equations.size(); ++g) {
    const InstrumentEquations& instrument = equations[g];
    const double hat = posterior.covariance.cwiseProduct(instrument.matrix).sum() / (scale[g] * scale[g]);
    const double redundancy = instrument.observations - hat;
    if (redundancy < kMinimumRedundancy) continue;
    const double squares =
        instrument.squares + 2.0 * instrument.gradient.dot(step) + step.dot(instrument.matrix * step);
    if (!(squares > 0.0)) continue;
    const double updated = std::sqrt(squares / redundancy);
    change = std::max(change, std::abs(std::log(updated / scale[g])));
    scale[g] = updated;
  }
  return change;
}

}  // namespace

std::vector<SmoothingTerm> smoothing_terms(const MeasurementModel& model, const DatumSpace& datum) {
  std::vector<SmoothingTerm> terms;
  std::map<std::pair<int, bool>, std::shared_ptr<const std::vector<PriorShape>>> shapes_of;
  for (const auto& function : datum.functions()) {
    const FunctionSpec& spec = model.spec().function(function.symbol);
    const int group = model.layout().find(function.symbol)->group;
    const Basis& basis = *model.layout().groups[static_cast<std::size_t>(group)].basis;
    if (spec.knots != KnotChoice::Automatic || basis.roughness_order() == 0 || function.size() == 0) continue;
    auto& shapes = shapes_of[{group, function.symbol.is_straightness()}];
    if (!shapes) {
      const Axis& axis = model.campaign().machine.axis(function.symbol.axis);
      shapes = std::make_shared<const std::vector<PriorShape>>(prior_shapes(basis, axis, function.basis));
    }
    SmoothingTerm term{function.symbol, function.offset, shapes, shapes->size() / 4, 0.0, true};
    term.lambda = 1.0 / (kStartAmplitude * kStartAmplitude);
    terms.push_back(std::move(term));
  }
  return terms;
}

void add_smoothing(const std::vector<SmoothingTerm>& terms, GaussianPrior& prior) {
  for (const SmoothingTerm& term : terms) {
    const Eigen::Index n = term.precision().rows();
    prior.precision.block(term.offset, term.offset, n, n) += term.lambda * term.precision();
  }
}

EvidenceState maximise_evidence(const std::vector<InstrumentEquations>& equations, const Eigen::VectorXd& z0,
                                const GaussianPrior& prior, const EvidenceOptions& options,
                                std::vector<double> scale, std::vector<SmoothingTerm>& terms) {
  EvidenceState state;
  for (state.sweeps = 1; state.sweeps <= options.max_sweeps; ++state.sweeps) {
    const Posterior now = posterior(equations, z0, prior, scale, terms);
    double change = update_terms(now, terms);
    if (options.variance_components)
      change = std::max(change, 10.0 * update_scales(equations, z0, now, scale));
    if (change < options.tolerance) break;
  }
  state.scale = std::move(scale);
  return state;
}

}  // namespace volcal
