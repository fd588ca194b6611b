#include "volcal/identify/noise/noise_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "volcal/identify/noise/reading_order.h"
#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr Eigen::Index kWhite = 0, kDrift = 1, kTau = 2, kLine = 3, kPerMetre = 4, kParameters = 5;

constexpr double kLeastSpreadOfLength = 1.05;
constexpr double kBendOfScale = 0.1;  // of the residuals' standard deviation: where log1p turns from linear
constexpr double kLargestShare = 30.0;
constexpr double kWhiteDown = 1e-2, kWhiteUp = 10.0;  // of the factor that explains the residuals alone
constexpr double kTauDown = 2.0, kTauUp = 3.0;        // of the usual gap, of the longest sequence
constexpr int kTauStarts = 6;
constexpr std::size_t kRefinedStarts = 3;
constexpr double kSlopeStep = 0.01;
constexpr double kBendStep = 0.05;
constexpr double kFirstReach = 1.5;  // logarithm, how far the surrogate is trusted
constexpr double kLeastReach = 0.02;
constexpr double kCurvedInformation = 0.5;  // error of its linear model that asks for a new slope
constexpr double kSettled = 0.01;           // of -2 l
constexpr int kRefinements = 6;
constexpr double kHopeless = 30.0;     // above the better model: not refined
constexpr double kAddedShare = 0.2;    // of the residuals' standard deviation: a term that may come
constexpr double kReducedDrift = 0.3;  // of the drift: where another begins beside the end of a search
constexpr double kDoubtful = 0.5;      // of the threshold: a term may have to come
constexpr double kOverwhelming = 5.0;  // of the threshold: evidence that one effect more does not undo
constexpr double kChanged = 0.02;      // of the residuals' standard deviation: another maximum may be higher
constexpr double kSurrogateTolerance = 1e-3;
constexpr double kSpread = 3.0;  // of a logarithm before any reading: where the likelihood is flat

constexpr Eigen::Index parameter_of(int term) { return term == 0 ? kDrift : term == 1 ? kLine : kPerMetre; }

}  // namespace

NoiseSearch::NoiseSearch(RestrictedLikelihood& likelihood, std::size_t group, const NoiseOptions& options,
                         Eigen::MatrixXd rest, const Eigen::VectorXd& solution, double white, double taken)
    : likelihood_(likelihood), group_(group), options_(options), rest_(std::move(rest)) {
  white_.residual = likelihood.residual(group, solution);
  set_limits(white, white_.residual);
  set_moments(white_.residual);
  white_.at = lower_;
  white_.at(kWhite) = std::log(white);
  white_.at(kTau) = 0.5 * (lower_(kTau) + upper_(kTau));
  white_.slope = Eigen::VectorXd::Zero(kParameters);
  white_.slope(kWhite) = -2.0 * taken;
}

void NoiseSearch::set_limits(double white, const Eigen::VectorXd& residual) {
  const NoiseData& data = likelihood_.group_data(group_);
  const auto n = static_cast<double>(data.sigma.size());
  total_ = std::sqrt(residual.squaredNorm() / n);
  const TimeScale time = time_scale(data);
  double shortest = 0.0, longest = 0.0, squares = 0.0;
  if (!data.length.empty()) {
    const auto [low, high] = std::ranges::minmax(data.length);
    shortest = std::abs(low);
    longest = std::abs(high);
    for (const double length : data.length) squares += length * length;
  }
  mean_length_ = std::sqrt(squares / n);
  const bool enough = data.sigma.size() >= kLeastObservations;
  possible_[0] = options_.drift && enough && time.longest > 2.0 * time.usual_gap;
  possible_[1] = options_.line && enough && has_lines(data);
  possible_[2] = options_.per_metre && enough && longest > kLeastSpreadOfLength * shortest;

  lower_.resize(kParameters);
  upper_.resize(kParameters);
  const double large = coordinate(kLargestShare * total_);
  lower_ << std::log(kWhiteDown * white), 0.0, 0.0, 0.0, 0.0;
  upper_ << std::log(kWhiteUp * white), large, 0.0, large, large;
  if (possible_[0]) {
    lower_(kTau) = std::log(kTauDown * time.usual_gap);
    upper_(kTau) = std::log(kTauUp * time.longest);
  }
}

void NoiseSearch::set_moments(const Eigen::VectorXd& residual) {
  const double independent =
      half_squared_difference(likelihood_.group_data(group_), likelihood_.group_points(group_), residual);
  correlated_ = std::clamp(1.0 - independent / (total_ * total_), 0.05, 0.95);
}

double NoiseSearch::coordinate(double deviation, double scale) {
  return std::log1p(std::pow(deviation / (kBendOfScale * scale), 2));
}

double NoiseSearch::deviation(double coordinate) const {
  return kBendOfScale * total_ * std::sqrt(std::expm1(coordinate));
}

NoiseParameters NoiseSearch::parameters(const Eigen::VectorXd& at, const Active& active) const {
  NoiseParameters noise;
  noise.white = std::exp(at(kWhite));
  if (active[0]) {
    noise.drift = deviation(at(kDrift));
    noise.tau = std::exp(at(kTau));
  }
  if (active[1]) noise.line = deviation(at(kLine));
  if (active[2]) noise.per_metre = deviation(at(kPerMetre)) / mean_length_;
  return noise;
}

Box NoiseSearch::box(const Active& active) const {
  Box limits{lower_, upper_};
  for (int term = 0; term < kTerms; ++term) {
    if (!active[static_cast<std::size_t>(term)])
      limits.upper(parameter_of(term)) = lower_(parameter_of(term));
  }
  if (!active[0]) limits.upper(kTau) = lower_(kTau);
  return limits;
}

void NoiseSearch::hold(const NoiseStart& held) {
  if (held.at.size() > 0) held_ = held;
}

/// Of the model that is held, up to a constant.
double NoiseSearch::held_information(const Eigen::VectorXd& at, const Active& active) const {
  if (!held_) return 0.0;
  const NoiseParameters noise = parameters(at, active);
  double value = held_->slope(kWhite) * (at(kWhite) - held_->at(kWhite));
  const auto add = [&](int term, double deviation) {
    const Eigen::Index i = parameter_of(term);
    if (held_->active[static_cast<std::size_t>(term)])
      value += held_->slope(i) * (coordinate(deviation, held_->scale) - held_->at(i));
  };
  add(0, noise.drift);
  add(1, noise.line);
  add(2, noise.per_metre * mean_length_);
  if (active[0] && held_->active[0]) value += held_->slope(kTau) * (at(kTau) - held_->at(kTau));
  return value;
}

/// The derivative of held_information() at a point.
Eigen::VectorXd NoiseSearch::held_slope(const Point& point) const {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(kParameters);
  if (!held_) return slope;
  slope(kWhite) = held_->slope(kWhite);
  for (int term = 0; term < kTerms; ++term) {
    const auto place = static_cast<std::size_t>(term);
    if (!point.active[place] || !held_->active[place]) continue;
    const Eigen::Index i = parameter_of(term);
    const double ratio = std::pow(total_ / held_->scale, 2);  // of the squares that the coordinates hold
    const double here = std::expm1(point.at(i));
    slope(i) = held_->slope(i) * ratio * (1.0 + here) / (1.0 + ratio * here);
  }
  if (point.active[0] && held_->active[0]) slope(kTau) = held_->slope(kTau);
  return slope;
}

void NoiseSearch::evaluate(Point& point) {
  const auto share = likelihood_.share(group_, parameters(point.at, point.active));
  const auto solution = RestrictedLikelihood::solve(rest_ + share.gram);
  ++evaluations_;
  point.value = share.log_determinant + solution.log_information + solution.quadratic +
                held_information(point.at, point.active);
  point.log_information = solution.log_information;
  point.residual = likelihood_.residual(group_, solution.at);
}

void NoiseSearch::find_slope(Point& point) {
  const Box limits = box(point.active);
  point.slope.setZero(kParameters);
  for (Eigen::Index i = 0; i < kParameters; ++i) {
    if (limits.lower(i) >= limits.upper(i)) continue;
    Point moved;
    moved.at = point.at;
    moved.at(i) += kSlopeStep;
    const auto share = likelihood_.share(group_, parameters(moved.at, point.active));
    const double log_information = RestrictedLikelihood::solve(rest_ + share.gram).log_information;
    ++evaluations_;
    point.slope(i) = (log_information - point.log_information) / kSlopeStep;
  }
}

/// -2 l up to a constant, with the solution of `from` held and its log information linear.
std::vector<double> NoiseSearch::surrogates(const Point& from, const std::vector<Eigen::VectorXd>& places,
                                            const Active& active) {
  std::vector<NoiseParameters> noises;
  for (const Eigen::VectorXd& at : places) noises.push_back(parameters(at, active));
  std::vector<double> values = likelihood_.misfits(group_, noises, from.residual);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const Eigen::VectorXd& at = places[k];
    values[k] += held_information(at, active) + from.slope(kWhite) * (at(kWhite) - from.at(kWhite));
    for (int term = 0; term < kTerms; ++term) {
      const Eigen::Index i = parameter_of(term);
      if (active[static_cast<std::size_t>(term)]) values[k] += from.slope(i) * (at(i) - from.at(i));
    }
    if (active[0]) values[k] += from.slope(kTau) * (at(kTau) - from.at(kTau));
  }
  return values;
}

ValuesAt NoiseSearch::surrogate(const Point& from, const Active& active) {
  return [this, &from, &active](const std::vector<Eigen::VectorXd>& places) {
    return surrogates(from, places, active);
  };
}

std::vector<Eigen::VectorXd> NoiseSearch::starts(const Active& active) const {
  std::vector<Eigen::VectorXd> result;
  const int taus = active[0] ? kTauStarts : 1;
  const std::vector<double> shares = active[0] && active[1]
                                         ? std::vector<double>{0.1, 0.5, 0.9}
                                         : std::vector<double>{1.0};  // of the correlated drift
  for (const double correlated : {correlated_, 0.2 * correlated_}) {
    for (const double share : shares) {
      for (int k = 0; k < taus; ++k) {
        Eigen::VectorXd at = white_.at;
        const double independent = active[2] ? 0.5 * (1.0 - correlated) : 1.0 - correlated;
        const double of_drift = active[0] ? correlated * share : 0.0;
        at(kWhite) += 0.5 * std::log(independent);
        at(kTau) = lower_(kTau) + (upper_(kTau) - lower_(kTau)) * (k + 0.5) / taus;
        at(kDrift) = coordinate(total_ * std::sqrt(of_drift));
        at(kLine) = coordinate(total_ * std::sqrt(correlated - of_drift));
        at(kPerMetre) = coordinate(total_ * std::sqrt(independent));
        result.push_back(at);
      }
    }
  }
  return result;
}

NoiseSearch::Point NoiseSearch::best_start(const Point& from, const Active& active) {
  std::vector<std::pair<double, Eigen::VectorXd>> candidates;
  const std::vector<Eigen::VectorXd> all = starts(active);
  const std::vector<double> values = surrogates(from, all, active);
  for (std::size_t k = 0; k < all.size(); ++k) candidates.emplace_back(values[k], all[k]);
  std::ranges::sort(candidates, {}, &std::pair<double, Eigen::VectorXd>::first);
  std::set<double> taus;  // the refined ones differ in it, or are the best alone
  std::erase_if(candidates,
                [&](const auto& candidate) { return !taus.insert(candidate.second(kTau)).second; });
  if (candidates.size() > kRefinedStarts) candidates.resize(kRefinedStarts);
  candidates.emplace_back(0.0, from.at);
  const Box limits = box(active);
  Minimum best{{}, std::numeric_limits<double>::infinity()};
  for (const auto& candidate : candidates) {
    Minimum found = bounded_minimum(surrogate(from, active), candidate.second, limits, kSurrogateTolerance);
    if (found.value < best.value) best = std::move(found);
  }
  Point point;
  point.at = best.at;
  point.active = active;
  point.slope = from.slope;
  evaluate(point);
  return point;
}

void NoiseSearch::refine(Point& point) {
  const Box limits = box(point.active);
  double reach = kFirstReach;
  bool fresh = false;
  for (int k = 0; k < kRefinements && reach > kLeastReach; ++k) {
    const Box near{limits.lower.cwiseMax((point.at.array() - reach).matrix()).cwiseMin(limits.upper),
                   limits.upper.cwiseMin((point.at.array() + reach).matrix()).cwiseMax(limits.lower)};
    Point next;
    next.active = point.active;
    next.at = bounded_minimum(surrogate(point, point.active), point.at, near, kSurrogateTolerance).at;
    evaluate(next);
    const Eigen::VectorXd step = next.at - point.at;
    const double error = next.log_information - point.log_information - point.slope.dot(step);
    if (next.value < point.value) {
      const double gain = point.value - next.value;
      next.slope = point.slope;
      if (step.squaredNorm() > 0.0) next.slope += (2.0 * error / step.squaredNorm()) * step;
      point = std::move(next);
      fresh = false;
      if (gain < kSettled && std::abs(error) < kCurvedInformation) return;
      if (std::abs(error) > kCurvedInformation) {
        find_slope(point);
        fresh = true;
      }
    } else if (!fresh) {
      if (point.value > next.value - kSettled && std::abs(error) < kSettled) return;
      find_slope(point);
      fresh = true;
    } else {
      if (point.value > next.value - kSettled) return;
      reach = std::min(reach, step.cwiseAbs().maxCoeff()) / 4.0;
    }
  }
}

/// To the maximum, with a slope found there.
void NoiseSearch::settle(Point& point) {
  for (int k = 0; k < kRefinements; ++k) {
    const double before = point.value;
    find_slope(point);
    refine(point);
    if (before - point.value < kSettled) return;
  }
}

NoiseSearch::Point NoiseSearch::without(const Point& point, int term) {
  Active active = point.active;
  active[static_cast<std::size_t>(term)] = false;
  Point reduced = best_start(point, active);
  if (reduced.value - point.value < kHopeless) refine(reduced);
  return reduced;
}

/// A term added; what the rest gives up to it is left to the surrogate.
NoiseSearch::Point NoiseSearch::with(const Point& point, int term) {
  Point larger;
  larger.active = point.active;
  larger.active[static_cast<std::size_t>(term)] = true;
  larger.slope = point.slope;
  Eigen::VectorXd from = point.at;
  from(parameter_of(term)) = coordinate(kAddedShare * total_);
  if (term == 0) from(kTau) = 0.5 * (lower_(kTau) + upper_(kTau));
  larger.at =
      bounded_minimum(surrogate(point, larger.active), from, box(larger.active), kSurrogateTolerance).at;
  evaluate(larger);
  return larger;
}

NoiseSearch::Point NoiseSearch::search(InstrumentNoise& result) {
  const std::array<TermEvidence*, kTerms> evidence{&result.drift, &result.line, &result.per_metre};
  Point best = best_start(white_, possible_);
  settle(best);
  bool settled = true;
  for (bool dropped = true; dropped;) {
    dropped = false;
    Point next;
    std::size_t weakest = 0;
    double least = 1.0;
    for (std::size_t term = 0; term < kTerms; ++term) {
      if (!best.active[term]) continue;
      Point reduced = without(best, static_cast<int>(term));
      evidence[term]->likelihood_ratio = reduced.value - best.value;
      const double support = evidence[term]->likelihood_ratio / evidence[term]->threshold;
      if (support >= least) continue;
      least = support;
      weakest = term;
      next = std::move(reduced);
      dropped = true;
    }
    if (dropped) {
      evidence[weakest]->likelihood_ratio = std::max(evidence[weakest]->likelihood_ratio, 0.0);
      best = std::move(next);
      settled = false;
    }
  }
  if (!settled) settle(best);
  return best;
}

/// Where an earlier search ended, in its variables.
NoiseSearch::Point NoiseSearch::end_of(const InstrumentNoise& previous) {
  total_ = previous.start.scale;
  Point end;
  end.active = previous.start.active;
  end.at = previous.start.at;
  end.slope = held_ ? Eigen::VectorXd::Zero(kParameters).eval() : previous.start.slope;
  evaluate(end);
  return end;
}

/// Begins with less correlated drift where that is better: it may be what the residuals no longer hold.
NoiseSearch::NearbyMaximum NoiseSearch::nearby_maximum(const InstrumentNoise& previous) {
  Point best = end_of(previous);
  if (best.active[0]) {
    Point less = best;
    less.at(kDrift) = coordinate(kReducedDrift * deviation(best.at(kDrift)));
    evaluate(less);
    if (less.value < best.value) best = std::move(less);
  }
  refine(best);
  NearbyMaximum nearby{parameters(best.at, best.active), 0.0};
  for (std::size_t term = 0; term < kTerms; ++term) {
    if (!possible_[term] || best.active[term]) continue;
    nearby.gain = std::max(nearby.gain, best.value - with(best, static_cast<int>(term)).value);
  }
  return nearby;
}

/// From the end of an earlier search of nearly the same residuals; nothing when a term should come or go.
std::optional<NoiseSearch::Point> NoiseSearch::resume(InstrumentNoise& result,
                                                      const InstrumentNoise& previous) {
  const std::array<TermEvidence*, kTerms> evidence{&result.drift, &result.line, &result.per_metre};
  const std::array<const TermEvidence*, kTerms> before{&previous.drift, &previous.line, &previous.per_metre};
  Point best = end_of(previous);
  refine(best);
  for (std::size_t term = 0; term < kTerms; ++term) {
    if (!possible_[term]) continue;
    evidence[term]->likelihood_ratio = before[term]->likelihood_ratio;
    const double threshold = evidence[term]->threshold;
    if (!best.active[term]) {
      const double gain = best.value - with(best, static_cast<int>(term)).value;
      if (gain > kDoubtful * threshold) return std::nullopt;
      evidence[term]->likelihood_ratio = std::max(gain, 0.0);
    } else if (before[term]->likelihood_ratio < kOverwhelming * threshold) {
      evidence[term]->likelihood_ratio = without(best, static_cast<int>(term)).value - best.value;
      if (evidence[term]->likelihood_ratio < threshold) return std::nullopt;
    }
  }
  return best;
}

void NoiseSearch::run(InstrumentNoise& result, const InstrumentNoise& previous) {
  const std::array<TermEvidence*, kTerms> evidence{&result.drift, &result.line, &result.per_metre};
  for (std::size_t term = 0; term < kTerms; ++term) {
    *evidence[term] = {possible_[term], false, 0.0,
                       term == 0 ? options_.drift_threshold : options_.threshold};
  }
  const double scale = total_;
  std::optional<Point> found;
  if (previous.start.at.size() > 0 && std::abs(std::log(scale / previous.start.scale)) < kChanged)
    found = resume(result, previous);
  if (!found) {
    total_ = scale;
    found = search(result);
  }
  for (std::size_t term = 0; term < kTerms; ++term) evidence[term]->on = found->active[term];
  result.parameters = parameters(found->at, found->active);
  result.start = {found->at, found->slope + held_slope(*found), found->active, total_};
  if (options_.uncertainty) find_uncertainty(*found, result);
}

/// The logarithm of a parameter moved by `shift`.
Eigen::VectorXd NoiseSearch::moved(const Eigen::VectorXd& at, Eigen::Index parameter, double shift) const {
  Eigen::VectorXd result = at;
  const bool logarithm = parameter == kWhite || parameter == kTau;
  result(parameter) =
      logarithm ? at(parameter) + shift : coordinate(deviation(at(parameter)) * std::exp(shift));
  return result;
}

/// Second differences of -2 l over about half a standard uncertainty.
void NoiseSearch::find_uncertainty(const Point& point, InstrumentNoise& result) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  NoiseParameters& log_uncertainty = result.log_uncertainty;
  log_uncertainty = {kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
  const std::array<double*, kParameters> targets{&log_uncertainty.white, &log_uncertainty.drift,
                                                 &log_uncertainty.tau, &log_uncertainty.line,
                                                 &log_uncertainty.per_metre};
  const Box limits = box(point.active);
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < kParameters; ++i) {
    if (limits.lower(i) < limits.upper(i) && (i == kWhite || i == kTau || point.at(i) > 0.0))
      free.push_back(i);
  }
  const std::size_t count = free.size();
  const auto value = [&](const Eigen::VectorXd& at) {
    Point there;
    there.at = at;
    there.active = point.active;
    evaluate(there);
    return there.value;
  };
  std::vector<double> width(count), above(count);
  Eigen::MatrixXd hessian(count, count);
  for (std::size_t a = 0; a < count; ++a) {
    const std::vector<double> near = surrogates(
        point, {moved(point.at, free[a], kBendStep), point.at, moved(point.at, free[a], -kBendStep)},
        point.active);
    const double bend = (near[0] - 2.0 * near[1] + near[2]) / (kBendStep * kBendStep);
    width[a] = std::clamp(0.5 * std::sqrt(2.0 / std::max(bend, 1e-9)), 0.005, 0.3);
    const Eigen::VectorXd up = moved(point.at, free[a], width[a]);
    above[a] = value(up);
    const double below = value(moved(point.at, free[a], -width[a]));
    const auto i = static_cast<Eigen::Index>(a);
    hessian(i, i) = (above[a] - 2.0 * point.value + below) / (width[a] * width[a]);
    for (std::size_t b = 0; b < a; ++b) {
      const double both = value(moved(up, free[b], width[b]));
      const auto j = static_cast<Eigen::Index>(b);
      hessian(i, j) = (both - above[a] - above[b] + point.value) / (width[a] * width[b]);
      hessian(j, i) = hessian(i, j);
    }
  }
  const SymmetricEigen eigen = eigen_decomposition(0.5 * hessian);
  const Eigen::ArrayXd information = eigen.values.array().max(0.0) + 1.0 / (kSpread * kSpread);
  const Eigen::MatrixXd covariance =
      eigen.vectors * information.inverse().matrix().asDiagonal() * eigen.vectors.transpose();
  result.log_covariance.setZero();
  result.log_covariance(free, free) = covariance;
  for (std::size_t a = 0; a < count; ++a)
    *targets[static_cast<std::size_t>(free[a])] = std::sqrt(result.log_covariance(free[a], free[a]));
}

}  // namespace volcal
