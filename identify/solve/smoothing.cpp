#include "volcal/identify/solve/smoothing.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volcal/identify/solve/dense.h"

namespace volcal {
namespace {

constexpr double kStartAmplitude = 20e-6;    // m or rad: root mean square of L^k f^(k) assumed at the start
constexpr double kSmallestAmplitude = 1e-9;  // a function is straight to 1 nm: no need to know it better
constexpr double kLargestAmplitude = 1.0;
constexpr double kMinimumRedundancy = 5.0;  // fewer excess readings say nothing about a standard deviation

double lambda_of(double amplitude) { return 1.0 / (amplitude * amplitude); }

}  // namespace

std::vector<SmoothingTerm> smoothing_terms(const MeasurementModel& model, const DatumSpace& datum) {
  std::vector<SmoothingTerm> terms;
  for (const auto& function : datum.functions()) {
    const FunctionSpec& spec = model.spec().function(function.symbol);
    const auto place = model.layout().find(function.symbol);
    const Basis& basis = *model.layout().groups[static_cast<std::size_t>(place->group)].basis;
    const int order = basis.roughness_order();
    if (spec.knots != KnotChoice::Automatic || order == 0 || function.size() == 0) continue;
    const double travel = model.campaign().machine.axis(function.symbol.axis).travel();
    SmoothingTerm term;
    term.symbol = function.symbol;
    term.offset = function.offset;
    term.penalty =
        std::pow(travel, 2 * order - 1) * (function.basis.transpose() * gram(basis, order) * function.basis);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(term.penalty, Eigen::EigenvaluesOnly);
    const double floor = 1e-10 * eigen.eigenvalues().maxCoeff();
    term.rank = static_cast<double>((eigen.eigenvalues().array() > floor).count());
    if (term.rank == 0.0) continue;
    term.lambda = term.rank * lambda_of(kStartAmplitude * 10.0);
    terms.push_back(std::move(term));
  }
  return terms;
}

void add_smoothing(const std::vector<SmoothingTerm>& terms, GaussianPrior& prior) {
  for (const SmoothingTerm& term : terms) {
    const Eigen::Index n = term.penalty.rows();
    prior.precision.block(term.offset, term.offset, n, n) += term.lambda * term.penalty;
  }
}

EvidenceState maximise_evidence(const std::vector<InstrumentEquations>& equations, const Eigen::VectorXd& z0,
                                const GaussianPrior& prior, const EvidenceOptions& options,
                                std::vector<double> scale, std::vector<SmoothingTerm>& terms) {
  EvidenceState state;
  state.redundancy.assign(equations.size(), 0.0);
  std::vector<double> last_step(terms.size(), 0.0);
  for (state.iterations = 0; state.iterations < options.max_iterations; ++state.iterations) {
    GaussianPrior total = prior;
    add_smoothing(terms, total);
    Eigen::MatrixXd precision = total.precision;
    Eigen::VectorXd right_side = total.precision * total.mean;
    for (std::size_t g = 0; g < equations.size(); ++g) {
      const double weight = 1.0 / (scale[g] * scale[g]);
      precision += weight * equations[g].matrix;
      right_side += weight * (equations[g].matrix * z0 - equations[g].gradient);
    }
    const auto factor = cholesky_lower(precision);
    if (!factor)
      throw std::runtime_error("maximise_evidence: the posterior precision is not positive definite");
    const Eigen::MatrixXd covariance = inverse_from_cholesky(*factor);
    const Eigen::VectorXd z = covariance * right_side;
    const Eigen::VectorXd step = z - z0;

    double change = 0.0;
    for (std::size_t t = 0; t < terms.size(); ++t) {
      SmoothingTerm& term = terms[t];
      if (!term.estimate) continue;
      const Eigen::Index n = term.penalty.rows();
      const auto z_f = z.segment(term.offset, n);
      const double trace = covariance.block(term.offset, term.offset, n, n).cwiseProduct(term.penalty).sum();
      const double effective = std::max(term.rank - term.lambda * trace, 1e-6);
      const double target = effective / std::max(z_f.dot(term.penalty * z_f), 1e-30);
      double log_step = std::clamp(std::log(target / term.lambda), -3.0, 3.0);
      if (log_step * last_step[t] > 0.0) log_step *= 1.5;  // the fixed point is approached from one side
      last_step[t] = log_step;
      const double lambda = std::clamp(term.lambda * std::exp(log_step), lambda_of(kLargestAmplitude),
                                       lambda_of(kSmallestAmplitude));
      // A term without effective parameters has no say: its lambda may grow without changing anything.
      if (effective > 0.05) change = std::max(change, std::abs(std::log(lambda / term.lambda)));
      term.lambda = lambda;
    }
    for (std::size_t g = 0; g < equations.size(); ++g) {
      const InstrumentEquations& instrument = equations[g];
      const double hat = covariance.cwiseProduct(instrument.matrix).sum() / (scale[g] * scale[g]);
      state.redundancy[g] = instrument.observations - hat;
      if (!options.variance_components || state.redundancy[g] < kMinimumRedundancy) continue;
      const double squares = std::max(
          instrument.squares + 2.0 * instrument.gradient.dot(step) + step.dot(instrument.matrix * step),
          1e-300);
      const double updated = std::sqrt(squares / state.redundancy[g]);
      change = std::max(change, 5.0 * std::abs(std::log(updated / scale[g])));
      scale[g] = updated;
    }
    if (change < options.tolerance) break;
  }
  state.scale = std::move(scale);
  return state;
}

}  // namespace volcal
