#include "volcal/identify/solve/smoothing.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <stdexcept>
#include <utility>

#include "volcal/identify/solve/dense.h"

namespace volcal {
namespace {

constexpr double kStartAmplitude = 5e-6;     // m or rad
constexpr double kSmallestAmplitude = 1e-9;  // straight to 1 nm: no need to know it better
constexpr double kLargestAmplitude = 1e-2;
constexpr double kMinimumRedundancy = 5.0;  // fewer excess readings say nothing about a standard deviation
constexpr double kSpreadOfLogLambda = 3.0;  // before any reading
constexpr int kStartPlace = 6;
constexpr int kSettlingSteps = 30;
constexpr int kStepsPerCandidate = 2;
constexpr int kClimbs = 24;
constexpr int kKindRounds = 3;
constexpr double kSettled = 0.02;     // of log evidence in one step
constexpr double kWorthAStep = 0.02;  // of log evidence, to change a length
constexpr double kWorthAKind = 0.5;   // of log evidence, to change the kind

/// What the evidence decides.
struct Hyperparameters {
  std::vector<std::size_t> shape;  ///< per term
  std::vector<double> lambda;      ///< per term
  std::vector<double> scale;       ///< per instrument
};

struct Posterior {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd mean;
  double log_evidence = 0.0;
};

struct Candidate {
  Hyperparameters hyperparameters;
  Posterior posterior;
};

class EvidenceSearch {
 public:
  EvidenceSearch(const std::vector<InstrumentEquations>& equations, const Eigen::VectorXd& z0,
                 const GaussianPrior& prior, const EvidenceOptions& options,
                 const std::vector<SmoothingTerm>& terms)
      : equations_(equations), z0_(z0), prior_(prior), options_(options), terms_(terms) {
    for (std::size_t t = 0; t < terms.size(); ++t) {
      if (terms[t].estimate) axes_[terms[t].symbol.axis].push_back(t);
    }
  }

  Candidate run(Hyperparameters start) {
    Candidate best = settle(std::move(start));
    for (int round = 0; round < kKindRounds; ++round) {
      climb_lengths(best);
      best = settle(std::move(best.hyperparameters));
      if (!try_kinds(best)) break;
    }
    return best;
  }

  int evaluations() const { return evaluations_; }

 private:
  Posterior posterior(const Hyperparameters& at) const {
    GaussianPrior total = prior_;
    double log_evidence = 0.0;
    for (std::size_t t = 0; t < terms_.size(); ++t) {
      const PriorShape& shape = (*terms_[t].shapes)[at.shape[t]];
      const Eigen::Index n = shape.precision.rows();
      total.precision.block(terms_[t].offset, terms_[t].offset, n, n) += at.lambda[t] * shape.precision;
      log_evidence += 0.5 * (shape.log_determinant + shape.rank * std::log(at.lambda[t]));
    }
    Eigen::MatrixXd precision = total.precision;
    Eigen::VectorXd gradient = total.gradient(z0_);
    double cost = total.cost(z0_);
    for (std::size_t g = 0; g < equations_.size(); ++g) {
      const double weight = 1.0 / (at.scale[g] * at.scale[g]);
      precision += weight * equations_[g].matrix;
      gradient += weight * equations_[g].gradient;
      cost += 0.5 * weight * equations_[g].squares;
      log_evidence -= equations_[g].observations * std::log(at.scale[g]);
    }
    const auto factor = cholesky_lower(precision);
    if (!factor)
      throw std::runtime_error("maximise_evidence: the posterior precision is not positive definite");
    Posterior result{inverse_from_cholesky(*factor), {}, 0.0};
    const Eigen::VectorXd step = -(result.covariance * gradient);
    result.mean = z0_ + step;
    result.log_evidence = log_evidence - 0.5 * log_determinant(*factor) - (cost + 0.5 * gradient.dot(step));
    return result;
  }

  double updated_lambda(std::size_t t, const Candidate& now) const {
    const SmoothingTerm& term = terms_[t];
    const PriorShape& shape = (*term.shapes)[now.hyperparameters.shape[t]];
    const Eigen::Index n = shape.precision.rows();
    const auto covariance = now.posterior.covariance.block(term.offset, term.offset, n, n);
    const Eigen::VectorXd z = now.posterior.mean.segment(term.offset, n);
    const double used =
        shape.rank - now.hyperparameters.lambda[t] * covariance.cwiseProduct(shape.precision).sum();
    return std::clamp(std::max(used, 1e-6) / z.dot(shape.precision * z),
                      1.0 / (kLargestAmplitude * kLargestAmplitude),
                      1.0 / (kSmallestAmplitude * kSmallestAmplitude));
  }

  double updated_scale(std::size_t g, const Candidate& now) const {
    const InstrumentEquations& instrument = equations_[g];
    const double scale = now.hyperparameters.scale[g];
    const double hat = now.posterior.covariance.cwiseProduct(instrument.matrix).sum() / (scale * scale);
    const double redundancy = instrument.observations - hat;
    if (redundancy < kMinimumRedundancy) return scale;
    const Eigen::VectorXd step = now.posterior.mean - z0_;
    const double squares =
        instrument.squares + 2.0 * instrument.gradient.dot(step) + step.dot(instrument.matrix * step);
    return squares > 0.0 ? std::sqrt(squares / redundancy) : scale;
  }

  /// All amplitudes and variance components to their common fixed point.
  Candidate settle(Hyperparameters start) {
    Candidate now{std::move(start), {}};
    now.posterior = posterior(now.hyperparameters);
    ++evaluations_;
    for (int step = 0; step < kSettlingSteps; ++step) {
      Candidate next = now;
      for (const auto& [axis, terms] : axes_) {
        for (const std::size_t t : terms) next.hyperparameters.lambda[t] = updated_lambda(t, now);
      }
      for (std::size_t g = 0; options_.variance_components && g < equations_.size(); ++g)
        next.hyperparameters.scale[g] = updated_scale(g, now);
      next.posterior = posterior(next.hyperparameters);
      ++evaluations_;
      const double gain = next.posterior.log_evidence - now.posterior.log_evidence;
      now = std::move(next);
      if (std::abs(gain) < kSettled) break;
    }
    return now;
  }

  /// The functions of one axis with another shape, their amplitudes adapted to it.
  Candidate with_shape(const Candidate& now, const std::vector<std::size_t>& terms, std::size_t shape) const {
    Candidate candidate{now.hyperparameters, {}};
    for (const std::size_t t : terms) candidate.hyperparameters.shape[t] = shape;
    candidate.posterior = posterior(candidate.hyperparameters);
    for (int step = 0; step < kStepsPerCandidate; ++step) {
      Hyperparameters next = candidate.hyperparameters;
      for (const std::size_t t : terms) next.lambda[t] = updated_lambda(t, candidate);
      candidate = {next, posterior(next)};
    }
    return candidate;
  }

  /// Replaces `best` by the best of the shapes if it is worth it.
  bool improve(Candidate& best, const std::vector<std::size_t>& terms, const std::vector<std::size_t>& shapes,
               double worth) {
    const auto policy = options_.threads > 1 ? std::launch::async : std::launch::deferred;
    std::vector<std::future<Candidate>> futures;
    for (const std::size_t shape : shapes) {
      futures.push_back(
          std::async(policy, [this, &best, &terms, shape] { return with_shape(best, terms, shape); }));
    }
    std::vector<Candidate> candidates;
    for (auto& future : futures) candidates.push_back(future.get());
    evaluations_ += static_cast<int>(candidates.size()) * (kStepsPerCandidate + 1);
    const auto winner = std::ranges::max_element(
        candidates, {}, [](const Candidate& candidate) { return candidate.posterior.log_evidence; });
    if (winner == candidates.end() || winner->posterior.log_evidence < best.posterior.log_evidence + worth)
      return false;
    best = std::move(*winner);
    return true;
  }

  void climb_lengths(Candidate& best) {
    for (int climb = 0; climb < kClimbs; ++climb) {
      bool moved = false;
      for (const auto& [axis, terms] : axes_) {
        const std::size_t shape = best.hyperparameters.shape[terms.front()];
        const std::size_t place = shape % kPriorLengths;
        std::vector<std::size_t> neighbours;
        if (place > 0) neighbours.push_back(shape - 1);
        if (place + 1 < kPriorLengths) neighbours.push_back(shape + 1);
        moved |= improve(best, terms, neighbours, kWorthAStep);
      }
      if (!moved) return;
    }
  }

  bool try_kinds(Candidate& best) {
    bool moved = false;
    for (const auto& [axis, terms] : axes_) {
      const std::size_t shape = best.hyperparameters.shape[terms.front()];
      std::vector<std::size_t> others;
      for (std::size_t kind = 0; kind < kRoughnessKinds; ++kind) {
        if (kind != shape / kPriorLengths) others.push_back(kind * kPriorLengths + shape % kPriorLengths);
      }
      moved |= improve(best, terms, others, kWorthAKind);
    }
    return moved;
  }

  const std::vector<InstrumentEquations>& equations_;
  const Eigen::VectorXd& z0_;
  const GaussianPrior& prior_;
  const EvidenceOptions& options_;
  const std::vector<SmoothingTerm>& terms_;
  std::map<AxisName, std::vector<std::size_t>> axes_;
  int evaluations_ = 0;
};

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
    if (shapes->empty()) continue;
    SmoothingTerm term{function.symbol, function.offset, shapes, kStartPlace, 0.0, true};
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
  Hyperparameters start{{}, {}, std::move(scale)};
  for (const SmoothingTerm& term : terms) {
    start.shape.push_back(term.shape);
    start.lambda.push_back(term.lambda);
  }
  EvidenceSearch search(equations, z0, prior, options, terms);
  const Candidate best = search.run(std::move(start));
  for (std::size_t t = 0; t < terms.size(); ++t) {
    terms[t].shape = best.hyperparameters.shape[t];
    terms[t].lambda = best.hyperparameters.lambda[t];
  }
  return {best.hyperparameters.scale, best.posterior.log_evidence, search.evaluations()};
}

Eigen::MatrixXd amplitude_covariance(const std::vector<SmoothingTerm>& terms,
                                     const Eigen::MatrixXd& covariance, const Eigen::VectorXd& z) {
  std::vector<const SmoothingTerm*> free;
  for (const SmoothingTerm& term : terms) {
    if (term.estimate) free.push_back(&term);
  }
  const auto count = static_cast<Eigen::Index>(free.size());
  if (count == 0) return Eigen::MatrixXd::Zero(z.size(), z.size());
  Eigen::MatrixXd pull = Eigen::MatrixXd::Zero(z.size(), count);  // lambda S z
  for (Eigen::Index i = 0; i < count; ++i) {
    const SmoothingTerm& term = *free[static_cast<std::size_t>(i)];
    const Eigen::Index n = term.precision().rows();
    pull.col(i).segment(term.offset, n) = term.lambda * (term.precision() * z.segment(term.offset, n));
  }
  const Eigen::MatrixXd change = -covariance * pull;  // dz / dlog lambda
  Eigen::MatrixXd hessian = pull.transpose() * change;
  for (Eigen::Index i = 0; i < count; ++i) {
    const SmoothingTerm& a = *free[static_cast<std::size_t>(i)];
    const Eigen::Index rows = a.precision().rows();
    for (Eigen::Index j = 0; j < count; ++j) {
      const SmoothingTerm& b = *free[static_cast<std::size_t>(j)];
      const Eigen::MatrixXd cross = covariance.block(a.offset, b.offset, rows, b.precision().rows());
      hessian(i, j) -=
          0.5 * a.lambda * b.lambda * (a.precision() * cross).cwiseProduct(cross * b.precision()).sum();
    }
    const auto own = covariance.block(a.offset, a.offset, rows, rows);
    hessian(i, i) += 0.5 * (a.lambda * own.cwiseProduct(a.precision()).sum() +
                            z.segment(a.offset, rows).dot(pull.col(i).segment(a.offset, rows)));
  }
  // Where the evidence is flat or its highest point lies at a limit, the spread before any reading holds.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(hessian);
  const Eigen::ArrayXd information =
      eigen.eigenvalues().array().max(0.0) + 1.0 / (kSpreadOfLogLambda * kSpreadOfLogLambda);
  const Eigen::MatrixXd directions = change * eigen.eigenvectors();
  return directions * information.inverse().matrix().asDiagonal() * directions.transpose();
}

}  // namespace volcal
