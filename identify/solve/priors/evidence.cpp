#include "volcal/identify/solve/priors/evidence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/solve/priors/axis_evidence.h"

namespace volcal {
namespace {

constexpr double kMinimumRedundancy = 5.0;  // fewer excess readings say nothing about a standard deviation
constexpr int kSettlingSteps = 30;
constexpr int kSweeps = 10;
constexpr double kSettled = 0.02;  // of log evidence in one step
// Readings that were computed scatter by their last digit alone. Below, wide priors are lost beside their
// weights in numbers of 16 digits.
constexpr double kLeastScale = 1e-3;

// Coefficients of a function that readings must settle; below, its amplitude is widened.
constexpr double kDetermined = 1.0;
constexpr int kWideningSweeps = 2;

// Of coefficients: what is expected of the spectrum of all linear axes counts little beside their eighteen
// functions; what follows for one axis, beside its six, counts more.
constexpr double kWorthOfShape = 1.0;
constexpr double kWorthOfCommonSpectrum = 3.0;

/// What the evidence decides.
struct Hyperparameters {
  std::vector<std::size_t> shape;  ///< per term
  std::vector<Prior> prior;        ///< per term, about the shape
  std::vector<double> lambda;      ///< per term
  std::vector<double> scale;       ///< per instrument
};

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

  Posterior posterior_at(const Quadratic& readings, const Hyperparameters& at) const {
    return posterior(readings, z0_, stretches_, at.prior, at.lambda);
  }

  enum class Spectra { Held, Corrected };

  /// All amplitudes and variance components, and the spectra where they are corrected, to their common fixed
  /// point.
  double settle(Hyperparameters& at, Spectra spectra = Spectra::Held) const {
    Quadratic readings = readings_and_priors(at.scale);
    Posterior now = posterior_at(readings, at);
    for (int step = 0; step < kSettlingSteps; ++step) {
      const double before = now.log_evidence;
      const Hyperparameters from = at;
      for (std::size_t t = 0; t < stretches_.size(); ++t)
        at.lambda[t] = updated_lambda(stretches_[t], *from.prior[t], from.lambda[t], now);
      for (std::size_t g = 0; options_.variance_components && g < equations_.size(); ++g)
        at.scale[g] = updated_scale(g, from.scale[g], now);
      if (spectra == Spectra::Corrected) correct_spectra(now, from, at);
      if (at.scale != from.scale) readings = readings_and_priors(at.scale);
      now = posterior_at(readings, at);
      if (std::abs(now.log_evidence - before) < kSettled) break;
    }
    return now.log_evidence;
  }

  /// Functions of which the readings settle less than a coefficient.
  std::vector<std::size_t> undetermined(const Hyperparameters& at) const {
    const Posterior now = posterior_at(readings_and_priors(at.scale), at);
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