#include "volcal/identify/solve/priors/evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {
namespace {

constexpr double kSmallestAmplitude = 1e-9;  // straight to 1 nm: no need to know it better
constexpr double kLargestAmplitude = 1e-2;
constexpr double kMinimumRedundancy = 5.0;  // fewer excess readings say nothing about a standard deviation
constexpr int kSettlingSteps = 30;
constexpr int kAmplitudeSteps = 4;
constexpr int kSweeps = 10;
constexpr double kRounding = 1e-10;  // of a precision that holds what a surface may not imitate at zero
constexpr double kMostRounding = 1e-6;
constexpr double kLeastLeft = 1e-14;  // of a precision, when others are integrated out: below is rounding
constexpr double kSettled = 0.02;     // of log evidence in one step
// Of log evidence, for an axis to have another shape than the others: very strong evidence (Kass and Raftery
// 1995, JASA 90, 773).
constexpr double kWorthADeparture = 5.0;
// Readings that were computed scatter by their last digit alone. Below, wide priors are lost beside their
// weights in numbers of 16 digits.
constexpr double kLeastScale = 1e-3;

// Coefficients of a function that readings must settle; below, its amplitude is widened.
constexpr double kDetermined = 1.0;
constexpr int kAmplitudesInADecade = 4;
constexpr int kWideningSweeps = 2;

// Of coefficients: what is expected of the spectrum of all linear axes counts little beside their eighteen
// functions; what follows for one axis, beside its six, counts more.
constexpr double kWorthOfShape = 1.0;
constexpr double kWorthOfCommonSpectrum = 3.0;

using Prior = std::shared_ptr<const PriorShape>;

/// What the evidence decides.
struct Hyperparameters {
  std::vector<std::size_t> shape;  ///< per term
  std::vector<Prior> prior;        ///< per term, about the shape
  std::vector<double> lambda;      ///< per term
  std::vector<double> scale;       ///< per instrument
};

/// Posterior of all parameters, or of some with the others integrated out.
struct Posterior {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd mean;
  double log_evidence = 0.0;
};

/// A quadratic cost about z0 whose smoothing is still missing.
struct Quadratic {
  Eigen::MatrixXd precision;
  Eigen::VectorXd gradient;
  double constant = 0.0;
};

/// A function within a Quadratic's coordinates.
struct Stretch {
  const SmoothingTerm* term;
  int offset;
};

Posterior posterior(const Quadratic& cost, const Eigen::VectorXd& z0, const std::vector<Stretch>& stretches,
                    const std::vector<Prior>& priors, const std::vector<double>& lambda) {
  Eigen::MatrixXd precision = cost.precision;
  Eigen::VectorXd gradient = cost.gradient;
  double minus_log = cost.constant;
  for (std::size_t t = 0; t < stretches.size(); ++t) {
    const PriorShape& shape = *priors[t];
    const Eigen::Index n = shape.precision.rows();
    const auto z = z0.segment(stretches[t].offset, n);
    const Eigen::VectorXd pull = lambda[t] * (shape.precision * z);
    precision.block(stretches[t].offset, stretches[t].offset, n, n) += lambda[t] * shape.precision;
    gradient.segment(stretches[t].offset, n) += pull;
    minus_log += 0.5 * (z.dot(pull) - shape.log_determinant - shape.rank * std::log(lambda[t]));
  }
  PrecisionInverse inverse = invert_precision(precision);
  Posterior result{std::move(inverse.covariance), {}, 0.0};
  const Eigen::VectorXd step = -(result.covariance * gradient);
  result.mean = z0 + step;
  result.log_evidence = -(minus_log + 0.5 * gradient.dot(step) + 0.5 * inverse.log_determinant);
  return result;
}

/// How many of a function's coefficients the readings settle beside its prior.
double settled_by_readings(const Stretch& stretch, const PriorShape& shape, double lambda,
                           const Posterior& now) {
  const Eigen::Index n = shape.precision.rows();
  const auto covariance = now.covariance.block(stretch.offset, stretch.offset, n, n);
  return shape.rank - lambda * covariance.cwiseProduct(shape.precision).sum();
}

double updated_lambda(const Stretch& stretch, const PriorShape& shape, double lambda, const Posterior& now) {
  const Eigen::Index n = shape.precision.rows();
  const Eigen::VectorXd z = now.mean.segment(stretch.offset, n);
  const double used = settled_by_readings(stretch, shape, lambda, now);
  return std::clamp(std::max(used, 1e-6) / z.dot(shape.precision * z),
                    1.0 / (kLargestAmplitude * kLargestAmplitude),
                    1.0 / (kSmallestAmplitude * kSmallestAmplitude));
}

/// The functions of one axis, all other parameters integrated out with their hyperparameters held.
class AxisEvidence {
 public:
  struct Choice {
    std::size_t shape = 0;
    std::vector<double> lambda;
    double log_evidence = 0.0;
  };

  /// `all`: everything but the smoothing of these functions; `stretches` within `all`.
  AxisEvidence(const Quadratic& all, const Eigen::VectorXd& z0, const std::vector<Stretch>& stretches) {
    std::vector<bool> is_mine(static_cast<std::size_t>(z0.size()), false);
    std::vector<int> mine;
    for (const Stretch& stretch : stretches) {
      stretches_.push_back({stretch.term, static_cast<int>(mine.size())});
      const int n = static_cast<int>(stretch.term->precision().rows());
      for (int i = stretch.offset; i < stretch.offset + n; ++i) {
        mine.push_back(i);
        is_mine[static_cast<std::size_t>(i)] = true;
      }
    }
    std::vector<int> others;
    for (int i = 0; i < z0.size(); ++i) {
      if (!is_mine[static_cast<std::size_t>(i)]) others.push_back(i);
    }
    z0_ = z0(mine);
    cost_.precision = all.precision(mine, mine);
    cost_.gradient = all.gradient(mine);
    if (others.empty()) return;
    const Eigen::MatrixXd across = all.precision(others, mine);
    Eigen::MatrixXd precision = all.precision(others, others);
    auto factor = cholesky_lower(precision);
    for (double rounding = kRounding; !factor && rounding <= kMostRounding; rounding *= 100.0) {
      precision.diagonal() *= 1.0 + rounding;
      factor = cholesky_lower(precision);
    }
    if (!factor)
      throw std::runtime_error("maximise_evidence: the posterior precision is not positive definite");
    const Eigen::MatrixXd half = factor->triangularView<Eigen::Lower>().solve(across);
    const Eigen::VectorXd half_gradient =
        factor->triangularView<Eigen::Lower>().solve(Eigen::VectorXd(all.gradient(others)));
    const Eigen::VectorXd before = cost_.precision.diagonal();
    cost_.precision -= half.transpose() * half;
    cost_.precision.diagonal() = cost_.precision.diagonal().cwiseMax(kLeastLeft * before);
    cost_.gradient -= half.transpose() * half_gradient;
  }

  const Quadratic& cost() const { return cost_; }
  const Eigen::VectorXd& z0() const { return z0_; }
  const std::vector<Stretch>& stretches() const { return stretches_; }

  /// Of the one function that it is about.
  double log_evidence(const Prior& prior, double lambda) const {
    return posterior(cost_, z0_, stretches_, {prior}, {lambda}).log_evidence;
  }

  /// A shape with its amplitudes, from those given.
  Choice with_shape(std::size_t shape, std::vector<double> lambda) const {
    std::vector<Prior> priors;
    for (const Stretch& stretch : stretches_) priors.push_back(stretch.term->shapes()[shape]);
    Posterior now = posterior(cost_, z0_, stretches_, priors, lambda);
    for (int step = 0; step < kAmplitudeSteps; ++step) {
      for (std::size_t t = 0; t < lambda.size(); ++t)
        lambda[t] = updated_lambda(stretches_[t], *priors[t], lambda[t], now);
      now = posterior(cost_, z0_, stretches_, priors, lambda);
    }
    return {shape, std::move(lambda), now.log_evidence};
  }

 private:
  std::vector<Stretch> stretches_;
  Eigen::VectorXd z0_;
  Quadratic cost_;
};

/// Amplitude at which evidence and a prior on it, a exp(-a / kUsualAmplitude), are highest together; lambda.
double widened_lambda(const AxisEvidence& evidence, const Prior& prior) {
  const auto height = [&](double log_amplitude) {
    const double amplitude = std::pow(10.0, log_amplitude);
    return evidence.log_evidence(prior, 1.0 / (amplitude * amplitude)) + std::log(amplitude) -
           amplitude / kUsualAmplitude;
  };
  const double from = std::log10(kSmallestAmplitude), to = std::log10(kLargestAmplitude);
  const int steps = static_cast<int>(std::lround((to - from) * kAmplitudesInADecade));
  double best = from, highest = -std::numeric_limits<double>::infinity();
  const auto take_if_higher = [&](double log_amplitude) {
    const double at = height(log_amplitude);
    if (at <= highest) return;
    highest = at;
    best = log_amplitude;
  };
  for (int i = 0; i <= steps; ++i) take_if_higher(from + static_cast<double>(i) / kAmplitudesInADecade);
  for (double step = 0.5 / kAmplitudesInADecade; step > 0.01; step *= 0.5) {
    const double middle = best;
    take_if_higher(middle - step);
    take_if_higher(middle + step);
  }
  return std::pow(10.0, -2.0 * best);
}

/// Shapes tried for one axis: around the best length of every kind, and those asked for.
class AxisShapes {
 public:
  AxisShapes(AxisEvidence evidence, std::size_t shape, const std::vector<double>& lambda)
      : evidence_(std::move(evidence)), best_(evidence_.with_shape(shape, lambda)) {
    tried_.emplace(shape, best_);
    for (int kind = 0; kind < kRoughnessKinds; ++kind) climb(kind, static_cast<int>(shape % kPriorLengths));
  }

  const AxisEvidence::Choice& best() const { return best_; }
  const std::map<std::size_t, AxisEvidence::Choice>& tried() const { return tried_; }

  /// Amplitudes start from those of the best shape so far.
  const AxisEvidence::Choice& with(std::size_t shape) {
    const auto found = tried_.find(shape);
    if (found != tried_.end()) return found->second;
    const auto& choice = tried_.emplace(shape, evidence_.with_shape(shape, best_.lambda)).first->second;
    if (choice.log_evidence > best_.log_evidence) best_ = choice;
    return choice;
  }

 private:
  double log_evidence(int kind, int place) {
    const int shape = kind * kPriorLengths + place;
    return with(static_cast<std::size_t>(shape)).log_evidence;
  }

  /// From a place to the nearest length that is better than its neighbours.
  void climb(int kind, int place) {
    for (const int step : {-1, 1}) {
      while (place + step >= 0 && place + step < kPriorLengths &&
             log_evidence(kind, place + step) > log_evidence(kind, place))
        place += step;
    }
  }

  AxisEvidence evidence_;
  AxisEvidence::Choice best_;
  std::map<std::size_t, AxisEvidence::Choice> tried_;
};

/// The shape that most becomes all axes when each may depart from it at the price of kWorthADeparture.
std::size_t common_shape(std::vector<AxisShapes>& axes, int threads) {
  std::set<std::size_t> candidates;
  for (const AxisShapes& axis : axes) {
    for (const auto& [shape, choice] : axis.tried()) candidates.insert(shape);
  }
  run_parallel(axes.size(), threads, [&](std::size_t axis) {
    for (const std::size_t shape : candidates) axes[axis].with(shape);
  });
  std::size_t common = 0;
  double highest = -std::numeric_limits<double>::infinity();
  for (const std::size_t shape : candidates) {
    double sum = 0.0;
    for (AxisShapes& axis : axes) {
      const double shared = axis.with(shape).log_evidence;
      sum += std::max(shared, axis.best().log_evidence - kWorthADeparture);
    }
    if (sum <= highest) continue;
    highest = sum;
    common = shape;
  }
  return common;
}

/// Squares of Legendre coefficients expected of some functions, in units of their amplitudes.
struct CoefficientSquares {
  Eigen::VectorXd sum;
  double functions = 0.0;

  void add(const Eigen::VectorXd& squares) {
    if (functions == 0.0) sum = Eigen::VectorXd::Zero(squares.size());
    sum += squares;
    functions += 1.0;
  }

  /// 1 / posterior mean of the variances' inverses, when `expected` is worth so many functions.
  Eigen::VectorXd variances(const Eigen::VectorXd& expected, double worth) const {
    return (worth * expected + sum) / (worth + functions);
  }
};

/// Functions of an axis that share a shape: their series are of one kind.
struct AxisFunctions {
  AxisName axis = AxisName::X;
  bool periodic = false;

  friend auto operator<=>(const AxisFunctions&, const AxisFunctions&) = default;
};

AxisFunctions functions_of(const SmoothingTerm& term) { return {term.symbol.axis, term.prior->periodic}; }

class EvidenceSearch {
 public:
  EvidenceSearch(const std::vector<NoiseGroupEquations>& equations, const Eigen::VectorXd& z0,
                 const GaussianPrior& prior, const EvidenceOptions& options,
                 const std::vector<SmoothingTerm>& terms)
      : equations_(equations), z0_(z0), prior_(prior), options_(options) {
    for (std::size_t t = 0; t < terms.size(); ++t) {
      stretches_.push_back({&terms[t], terms[t].offset});
      if (terms[t].is_function()) {
        axes_[functions_of(terms[t])].push_back(t);
      } else {
        surfaces_.push_back(t);
      }
    }
    for (const auto& [functions, own] : axes_) {
      const bool alone = is_rotary(functions.axis);
      groups_[alone ? functions : AxisFunctions{}].push_back(functions);
    }
  }

  /// Returns log evidence.
  double run(Hyperparameters& at) const {
    Hyperparameters corrected = at;
    use_shapes(at);
    double log_evidence = settle(at);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      if (!choose_shapes(at)) break;
      log_evidence = settle(at);
    }
    if (corrected.shape != at.shape) corrected = at;
    const double with_correction = settle(corrected, Spectra::Corrected);
    if (with_correction > log_evidence) {
      at = corrected;
      log_evidence = with_correction;
    }
    widen_undetermined(at);
    return log_evidence;
  }

 private:
  /// Readings at their scales and priors, without smoothing.
  Quadratic readings_and_priors(const std::vector<double>& scale) const {
    Quadratic total{prior_.precision, prior_.gradient(z0_), prior_.cost(z0_)};
    for (std::size_t g = 0; g < equations_.size(); ++g) {
      const double weight = 1.0 / (scale[g] * scale[g]);
      total.precision += weight * equations_[g].matrix;
      total.gradient += weight * equations_[g].gradient;
      total.constant +=
          0.5 * weight * equations_[g].squares + equations_[g].observations * std::log(scale[g]);
    }
    return total;
  }

  double updated_scale(std::size_t g, double scale, const Posterior& now) const {
    const NoiseGroupEquations& instrument = equations_[g];
    const double hat = now.covariance.cwiseProduct(instrument.matrix).sum() / (scale * scale);
    const double redundancy = instrument.observations - hat;
    if (redundancy < kMinimumRedundancy) return scale;
    const Eigen::VectorXd step = now.mean - z0_;
    const double squares =
        instrument.squares + 2.0 * instrument.gradient.dot(step) + step.dot(instrument.matrix * step);
    return squares > 0.0 ? std::max(kLeastScale, std::sqrt(squares / redundancy)) : scale;
  }

  enum class Spectra { Held, Corrected };

  /// All amplitudes and variance components, and the spectra where they are corrected, to their common fixed
  /// point.
  double settle(Hyperparameters& at, Spectra spectra = Spectra::Held) const {
    Quadratic readings = readings_and_priors(at.scale);
    Posterior now = posterior(readings, z0_, stretches_, at.prior, at.lambda);
    for (int step = 0; step < kSettlingSteps; ++step) {
      const double before = now.log_evidence;
      const Hyperparameters from = at;
      for (std::size_t t = 0; t < stretches_.size(); ++t)
        at.lambda[t] = updated_lambda(stretches_[t], *from.prior[t], from.lambda[t], now);
      for (std::size_t g = 0; options_.variance_components && g < equations_.size(); ++g)
        at.scale[g] = updated_scale(g, from.scale[g], now);
      if (spectra == Spectra::Corrected) correct_spectra(now, from, at);
      if (at.scale != from.scale) readings = readings_and_priors(at.scale);
      now = posterior(readings, z0_, stretches_, at.prior, at.lambda);
      if (std::abs(now.log_evidence - before) < kSettled) break;
    }
    return now.log_evidence;
  }

  /// Functions of which the readings settle less than a coefficient.
  std::vector<std::size_t> undetermined(const Hyperparameters& at) const {
    const Posterior now = posterior(readings_and_priors(at.scale), z0_, stretches_, at.prior, at.lambda);
    std::vector<std::size_t> terms;
    for (std::size_t t = 0; t < stretches_.size(); ++t) {
      if (stretches_[t].term->is_function() &&
          settled_by_readings(stretches_[t], *at.prior[t], at.lambda[t], now) < kDetermined)
        terms.push_back(t);
    }
    return terms;
  }

  /// Their evidence is often highest at no amplitude at all, and their intervals would be those of functions
  /// that are known to be straight.
  void widen_undetermined(Hyperparameters& at) const {
    const std::vector<std::size_t> terms = undetermined(at);
    if (terms.empty()) return;
    const AxisEvidence together = axis_evidence(terms, at);
    for (int sweep = 0; sweep < kWideningSweeps; ++sweep) {
      for (std::size_t i = 0; i < terms.size(); ++i)
        at.lambda[terms[i]] = widened_lambda(one_of(together, terms, i, at), at.prior[terms[i]]);
    }
  }

  /// Of one of the functions of `together`, the others smoothed as they are.
  AxisEvidence one_of(const AxisEvidence& together, const std::vector<std::size_t>& terms, std::size_t one,
                      const Hyperparameters& at) const {
    Quadratic all = together.cost();
    for (std::size_t i = 0; i < terms.size(); ++i) {
      if (i == one) continue;
      add_smoothing_of(at, terms[i], together.stretches()[i].offset, together.z0(), all);
    }
    return {all, together.z0(), {together.stretches()[one]}};
  }

  static void add_smoothing_of(const Hyperparameters& at, std::size_t term, int offset,
                               const Eigen::VectorXd& z0, Quadratic& all) {
    const Eigen::MatrixXd smoothing = at.lambda[term] * at.prior[term]->precision;
    const Eigen::Index n = smoothing.rows();
    all.precision.block(offset, offset, n, n) += smoothing;
    all.gradient.segment(offset, n) += smoothing * z0.segment(offset, n);
  }

  void use_shapes(Hyperparameters& at) const {
    for (std::size_t t = 0; t < stretches_.size(); ++t)
      at.prior[t] = stretches_[t].term->shapes()[at.shape[t]];
  }

  /// True when other shapes are better. Linear axes share one unless they depart; rotary axes do not.
  bool choose_shapes(Hyperparameters& at) const {
    const Hyperparameters before = at;
    for (const auto& [first, group] : groups_) choose_shapes(group, before, at);
    for (const std::size_t surface : surfaces_) choose_lengths(surface, before, at);
    use_shapes(at);
    return at.shape != before.shape;
  }

  void choose_shapes(const std::vector<AxisFunctions>& group, const Hyperparameters& before,
                     Hyperparameters& at) const {
    std::vector<std::optional<AxisShapes>> made(group.size());
    run_parallel(group.size(), options_.threads, [&](std::size_t a) {
      const std::vector<std::size_t>& terms = axes_.at(group[a]);
      std::vector<double> lambda(terms.size());
      std::ranges::transform(terms, lambda.begin(), [&](std::size_t t) { return before.lambda[t]; });
      made[a].emplace(axis_evidence(terms, before), before.shape[terms.front()], lambda);
    });
    std::vector<AxisShapes> axes;
    for (std::optional<AxisShapes>& axis : made) axes.push_back(*std::move(axis));
    const std::size_t common = common_shape(axes, options_.threads);
    for (std::size_t a = 0; a < group.size(); ++a) {
      const AxisEvidence::Choice& shared = axes[a].with(common);
      const bool departs = axes[a].best().log_evidence > shared.log_evidence + kWorthADeparture;
      const AxisEvidence::Choice& choice = departs ? axes[a].best() : shared;
      const std::vector<std::size_t>& terms = axes_.at(group[a]);
      for (std::size_t i = 0; i < terms.size(); ++i) {
        at.shape[terms[i]] = choice.shape;
        at.lambda[terms[i]] = choice.lambda[i];
      }
    }
  }

  /// Of a surface: from its lengths to the nearest that are better than their neighbours.
  void choose_lengths(std::size_t surface, const Hyperparameters& before, Hyperparameters& at) const {
    const AxisEvidence evidence = axis_evidence({surface}, before);
    const SurfacePriors& priors = *stretches_[surface].term->surface;
    AxisEvidence::Choice best = evidence.with_shape(before.shape[surface], {before.lambda[surface]});
    std::set<std::size_t> tried = {best.shape};
    for (bool climbs = true; climbs;) {
      climbs = false;
      for (const std::size_t shape : priors.neighbours(best.shape)) {
        if (!tried.insert(shape).second) continue;
        AxisEvidence::Choice choice = evidence.with_shape(shape, best.lambda);
        if (choice.log_evidence <= best.log_evidence) continue;
        best = std::move(choice);
        climbs = true;
        break;
      }
    }
    at.shape[surface] = best.shape;
    at.lambda[surface] = best.lambda.front();
  }

  void correct_spectra(const Posterior& now, const Hyperparameters& from, Hyperparameters& at) const {
    for (const auto& [first, group] : groups_) {
      std::map<AxisFunctions, CoefficientSquares> of_axis;
      CoefficientSquares common, of_shapes;
      for (const AxisFunctions& axis : group) {
        for (const std::size_t t : axes_.at(axis)) {
          const Eigen::VectorXd squares = expected_squares(t, now, from);
          of_axis[axis].add(squares);
          common.add(squares);
          of_shapes.add(stretches_[t].term->family->shapes()[at.shape[t]]->spectrum);
        }
      }
      const Eigen::VectorXd expected = common.variances(of_shapes.sum / of_shapes.functions, kWorthOfShape);
      for (const AxisFunctions& axis : group)
        set_spectrum(axis, of_axis.at(axis).variances(expected, kWorthOfCommonSpectrum), at);
    }
  }

  Eigen::VectorXd expected_squares(std::size_t t, const Posterior& now, const Hyperparameters& from) const {
    const auto& [term, offset] = stretches_[t];
    const Eigen::Index n = from.prior[t]->precision.rows();
    return term->family->expected_squares(*from.prior[t], from.lambda[t], now.mean.segment(offset, n),
                                          now.covariance.block(offset, offset, n, n));
  }

  void set_spectrum(const AxisFunctions& axis, const Eigen::VectorXd& variances, Hyperparameters& at) const {
    std::map<const FunctionPriors*, Prior> made;
    for (const std::size_t t : axes_.at(axis)) {
      const auto& family = stretches_[t].term->family;
      Prior& prior = made[family.get()];
      if (!prior) prior = std::make_shared<const PriorShape>(family->with_spectrum(*at.prior[t], variances));
      at.prior[t] = prior;
    }
  }

  /// These functions with the other axes' smoothing held.
  AxisEvidence axis_evidence(const std::vector<std::size_t>& terms, const Hyperparameters& at) const {
    Quadratic all = readings_and_priors(at.scale);
    std::vector<Stretch> mine(terms.size());
    std::ranges::transform(terms, mine.begin(), [&](std::size_t t) { return stretches_[t]; });
    for (std::size_t t = 0; t < stretches_.size(); ++t) {
      if (std::ranges::find(terms, t) != terms.end()) continue;
      add_smoothing_of(at, t, stretches_[t].offset, z0_, all);
    }
    return {all, z0_, mine};
  }

  const std::vector<NoiseGroupEquations>& equations_;
  const Eigen::VectorXd& z0_;
  const GaussianPrior& prior_;
  const EvidenceOptions& options_;
  std::vector<Stretch> stretches_;  ///< one per term
  std::vector<std::size_t> surfaces_;
  std::map<AxisFunctions, std::vector<std::size_t>> axes_;
  std::map<AxisFunctions, std::vector<AxisFunctions>> groups_;  ///< linear axes under X, rotary ones each
};

}  // namespace

EvidenceState maximise_evidence(const std::vector<NoiseGroupEquations>& equations, const Eigen::VectorXd& z0,
                                const GaussianPrior& prior, const EvidenceOptions& options,
                                std::vector<double> scale, std::vector<SmoothingTerm>& terms) {
  Hyperparameters at{{}, {}, {}, std::move(scale)};
  for (const SmoothingTerm& term : terms) {
    at.shape.push_back(term.shape);
    at.prior.push_back(term.prior);
    at.lambda.push_back(term.lambda);
  }
  const double log_evidence = EvidenceSearch(equations, z0, prior, options, terms).run(at);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    terms[t].shape = at.shape[t];
    terms[t].prior = at.prior[t];
    terms[t].lambda = at.lambda[t];
  }
  return {std::move(at.scale), log_evidence};
}

}  // namespace volcal
