#include "volcal/identify/criticism/search/open_errors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr int kVarianceSteps = 40;
constexpr double kLeastVariance = 1e-8;    // of that at which a function alone makes the residuals
constexpr double kSettledVariance = 0.05;  // change of a logarithm that no test notices
constexpr double kHardlySeen = 0.1;        // amplitudes that the readings determine

/// The columns of every error function that the given model holds at zero, and where each begins.
struct Field {
  Eigen::MatrixXd columns;
  std::vector<Eigen::Index> first;  ///< and the end
  Eigen::VectorXd variance;         ///< of every function
  Eigen::VectorXd least;            ///< below, nothing is seen of it

  Eigen::Index functions() const { return variance.size(); }
  Eigen::Index width(Eigen::Index k) const {
    return first[static_cast<std::size_t>(k) + 1] - first[static_cast<std::size_t>(k)];
  }
  Eigen::Index begin(Eigen::Index k) const { return first[static_cast<std::size_t>(k)]; }
  Eigen::VectorXd precision() const {
    Eigen::VectorXd all(columns.cols());
    for (Eigen::Index k = 0; k < functions(); ++k)
      all.segment(begin(k), width(k)).setConstant(1.0 / variance[k]);
    return all;
  }
};

bool is_function(const Family& family) { return family.is_left_out() && !family.orders.empty(); }

/// Of sizes that together make residuals as large as these.
Field field_of(const ModelState& state) {
  Field field;
  const LinearModel& model = state.model();
  field.columns.resize(static_cast<Eigen::Index>(model.size()), 0);
  field.first.push_back(0);
  for (const Family& family : state.setting().families) {
    if (!is_function(family)) continue;
    const Eigen::MatrixXd own =
        family_columns(model, family, Eigen::VectorXd::Constant(1, static_cast<double>(family.amplitudes())));
    if (own.squaredNorm() == 0.0) continue;
    append_columns(own, field.columns);
    field.first.push_back(field.columns.cols());
  }
  const auto functions = static_cast<Eigen::Index>(field.first.size()) - 1;
  const double squares =
      state.residual().squaredNorm() / static_cast<double>(std::max<Eigen::Index>(functions, 1));
  field.variance.resize(functions);
  for (Eigen::Index k = 0; k < functions; ++k)
    field.variance[k] = squares / field.columns.middleCols(field.begin(k), field.width(k)).squaredNorm();
  field.least = kLeastVariance * field.variance;
  return field;
}

/// White noise beside the field is no less than stated, or than the residuals have without the field where
/// that is less: functions that can follow every reading leave nothing to tell noise by.
double least_white(const NoiseParameters& without_field) { return std::min(1.0, without_field.white); }

/// By how much the variance of the noise can fall at most.
double least_factor(const std::vector<NoiseParameters>& noise, const std::vector<NoiseParameters>& without) {
  double least = 1.0;
  for (std::size_t group = 0; group < noise.size(); ++group)
    least = std::min(least, std::pow(least_white(without[group]) / noise[group].white, 2));
  return least;
}

/// Variances of the restricted likelihood off the model with the field's columns last, at the noise of
/// `projector` times a factor that is found with them. With C the covariance of b given the readings the
/// square of the next v is v |b|^2 / (n - tr C / v).
void find_variances(const Projector& projector, const NoiseProblem& problem, double least_noise,
                    Field& field) {
  const Eigen::Index count = projector.parameters(), width = field.columns.cols(), before = count - width;
  const Eigen::MatrixXd gram = projector.gram().topLeftCorner(count, count);
  const Eigen::VectorXd right = projector.gram().col(count).head(count);
  const Eigen::VectorXd pull = problem.prior_precision * problem.prior_mean;
  double noise = 1.0;  // variance, of that of the projector
  for (int step = 0; step < kVarianceSteps; ++step) {
    Eigen::MatrixXd normal = gram / noise;
    normal.topLeftCorner(before, before) += problem.prior_precision.topLeftCorner(before, before);
    normal.diagonal().tail(width) += field.precision();
    const Eigen::MatrixXd covariance = invert_precision(normal).covariance;
    const Eigen::VectorXd solution = covariance * (right / noise + pull);
    const double squares = projector.gram()(count, count) + solution.dot(gram * solution - 2.0 * right);
    const double taken = covariance.cwiseProduct(gram).sum() / noise;
    const double left = static_cast<double>(projector.observations()) - taken;
    double change = 0.0;
    const auto move = [&change](double& variance, double next) {
      change = std::max(change, std::abs(std::log(next / variance)));
      variance = next;
    };
    for (Eigen::Index k = 0; k < field.functions(); ++k) {
      const Eigen::Index at = before + field.begin(k);
      double& v = field.variance[k];
      const double seen =
          static_cast<double>(field.width(k)) - covariance.diagonal().segment(at, field.width(k)).sum() / v;
      if (seen < kHardlySeen || v <= field.least[k]) continue;
      move(v, std::max(field.least[k],
                       std::sqrt(v * solution.segment(at, field.width(k)).squaredNorm() / seen)));
    }
    if (squares > 0.0 && left > 0.0) move(noise, std::max(least_noise, std::sqrt(noise * squares / left)));
    if (change < kSettledVariance) break;
  }
}

/// Off the model and the field, at the noise beside it.
Projector projector_beside(const ModelState& state, const std::set<std::size_t>& left_out) {
  const SearchSetting& setting = state.setting();
  const NoiseProblem model = state.problem(left_out);
  const NoiseData chosen = without(model.data, setting.heldout);
  Field field = field_of(state);
  NoiseOptions options = state.noise_options();
  options.uncertainty = false;
  NoiseEstimate estimate = state.noise_estimate();
  std::vector<NoiseParameters> noise = state.noise();
  const auto projector_of = [&](const NoiseProblem& problem) {
    return Projector(problem, chosen, noise, setting.threads, state.model().parts());
  };
  NoiseProblem beside = with_columns(model, field.columns, field.precision());
  for (int round = 0; round < kThresholds.noise_rounds; ++round) {
    find_variances(projector_of(beside), beside, least_factor(noise, state.noise()), field);
    beside = with_columns(model, field.columns, field.precision());
    estimate = estimate_noise(beside, options, &estimate);
    noise = estimate.parameters();
    for (std::size_t group = 0; group < noise.size(); ++group)
      noise[group].white = std::max(noise[group].white, least_white(state.noise()[group]));
  }
  return projector_of(beside);
}

}  // namespace

bool OpenErrors::any() const {
  const std::vector<Family>& families = state_.setting().families;
  for (std::size_t i = 0; i < families.size(); ++i) {
    if (is_function(families[i]) && !state_.has(i)) return true;
  }
  return false;
}

bool OpenErrors::admits(const FamilyTest& test) {
  const SearchSetting& setting = state_.setting();
  const Family& family = setting.families[test.family];
  if (family.is_left_out() || family.resolution || !setting.rules.follows(SearchRule::OpenErrors) || !any())
    return true;
  return !setting.rules.decide(SearchRule::OpenErrors, [&] {
    const FamilyTest& beside = tests()[test.family];
    return beside.score.dof == 0 || setting.family_wise_log10_p(beside) > kThresholds.open_errors_log10_risk;
  });
}

const std::vector<FamilyTest>& OpenErrors::tests() {
  if (!tests_) tests_ = refined_tests(state_.setting(), state_.model(), projector_beside(state_, left_out_));
  return *tests_;
}

}  // namespace volcal
