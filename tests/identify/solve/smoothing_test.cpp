// Priors of smooth functions against Gaussian-process regression written down by its covariances (Rasmussen
// and Williams 2006, eq. 2.25-2.30 and 2.41), which knows nothing of splines or precisions.

#include "volcal/identify/solve/smoothing.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <random>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/datum.h"
#include "volcal/model/functions/registry.h"
#include "volcal/sim/reference_machines.h"

namespace volcal {
namespace {

constexpr double kVague = 1e4;  // variance of constant and slope, unit amplitude 1

Axis axis_of_one_metre() {
  return sim::machine_from_code("w X b Y Z t", {{{0.0, 1.0}, {0.0, 0.6}, {0.0, 0.5}}}).axis(AxisName::X);
}

std::unique_ptr<Basis> fine_splines(const Axis& axis) {
  FunctionSpec spec;
  spec.breakpoints = uniform_breakpoints(axis, 20);
  return find_basis(spec.basis)->make(spec, axis);
}

Eigen::MatrixXd rows_at(const Basis& basis, const Eigen::VectorXd& q) {
  Eigen::MatrixXd rows(q.size(), basis.size());
  for (Eigen::Index i = 0; i < q.size(); ++i) rows.row(i) = basis.row(q[i]).transpose();
  return rows;
}

double kernel(Roughness roughness, double length, double a, double b) {
  const double d = std::abs(a - b) / length;
  if (roughness == Roughness::SquaredExponential) return std::exp(-d * d / 2.0);
  if (roughness == Roughness::Matern52)
    return (1.0 + std::sqrt(5.0) * d + 5.0 * d * d / 3.0) * std::exp(-std::sqrt(5.0) * d);
  double sum = 0.0;
  for (unsigned n = 2; n <= 30; ++n) {
    const double exponent = roughness == Roughness::Heat ? n * n * length * length : n * length;
    sum += (2.0 * n + 1.0) * std::exp(-2.0 * exponent) * std::legendre(n, 2.0 * a - 1.0) *
           std::legendre(n, 2.0 * b - 1.0);
  }
  return sum;
}

Eigen::MatrixXd kernel_matrix(const PriorShape& shape, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  Eigen::MatrixXd k(a.size(), b.size());
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    for (Eigen::Index j = 0; j < b.size(); ++j) k(i, j) = kernel(shape.roughness, shape.length, a[i], b[j]);
  }
  return k;
}

/// Mean variance over the travel of the deviation from the least-squares line.
double mean_variance(const PriorShape& shape) {
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(200, 0.0025, 0.9975);
  Eigen::MatrixXd lines(q.size(), 2);
  lines << Eigen::VectorXd::Ones(q.size()), q;
  const Eigen::MatrixXd across = Eigen::MatrixXd::Identity(q.size(), q.size()) -
                                 lines * (lines.transpose() * lines).inverse() * lines.transpose();
  return (across * kernel_matrix(shape, q, q) * across).trace() / static_cast<double>(q.size());
}

/// Covariance of values with vague constant and slope, amplitude 1.
Eigen::MatrixXd prior_covariance(const PriorShape& shape, const Eigen::VectorXd& a,
                                 const Eigen::VectorXd& b) {
  return kernel_matrix(shape, a, b) / mean_variance(shape) +
         kVague * (Eigen::MatrixXd::Ones(a.size(), b.size()) + a * b.transpose());
}

class Prior : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Prior, PosteriorIsThatOfGaussianProcessRegression) {
  const Axis axis = axis_of_one_metre();
  const auto basis = fine_splines(axis);
  const auto identity = Eigen::MatrixXd::Identity(basis->size(), basis->size());
  const PriorShape shape = prior_shapes(*basis, axis, identity)[GetParam()];
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(31, 0.0, 1.0);
  const Eigen::VectorXd y = (q.array() * 9.0).sin() + 3.0 * q.array() + 1.0;
  const double variance = 0.01;

  const Eigen::MatrixXd rows = rows_at(*basis, q);
  const Eigen::MatrixXd precision = rows.transpose() * rows / variance + shape.precision;
  const Eigen::VectorXd coefficients = precision.llt().solve(rows.transpose() * y / variance);
  const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(50, 0.01, 0.99);
  const Eigen::MatrixXd at_rows = rows_at(*basis, at);
  const Eigen::MatrixXd posterior = at_rows * precision.inverse() * at_rows.transpose();

  const Eigen::MatrixXd noisy =
      prior_covariance(shape, q, q) + variance * Eigen::MatrixXd::Identity(q.size(), q.size());
  const Eigen::MatrixXd across = prior_covariance(shape, at, q);
  const Eigen::VectorXd mean = across * noisy.ldlt().solve(y);
  const Eigen::MatrixXd expected =
      prior_covariance(shape, at, at) - across * noisy.ldlt().solve(across.transpose());
  EXPECT_LT((at_rows * coefficients - mean).cwiseAbs().maxCoeff(), 0.02)
      << to_string(shape.roughness) << " " << shape.length;
  EXPECT_NEAR(std::sqrt(posterior.trace() / expected.trace()), 1.0, 0.03)
      << to_string(shape.roughness) << " " << shape.length;
}

// Middle lengths of the four kinds.
INSTANTIATE_TEST_SUITE_P(Kinds, Prior, ::testing::Values(6U, 8U, 18U, 20U, 30U, 32U, 42U, 44U));

TEST(PriorShapes, LeaveStraightLinesFree) {
  const Axis axis = axis_of_one_metre();
  const auto basis = fine_splines(axis);
  const ErrorSymbol positioning{Component::X, AxisName::X};
  const Eigen::MatrixXd datum = null_space(datum_constraints(*basis, positioning, axis));
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(100, 0.0, 1.0);
  const Eigen::VectorXd line = (rows_at(*basis, q) * datum).colPivHouseholderQr().solve(q);
  for (const PriorShape& shape : prior_shapes(*basis, axis, datum)) {
    EXPECT_LT(line.dot(shape.precision * line), 1e-6) << to_string(shape.roughness) << " " << shape.length;
    EXPECT_EQ(shape.rank, basis->size() - 2);
  }
}

TEST(PriorShapes, NoneForABasisOfStraightLines) {
  const Axis axis = axis_of_one_metre();
  FunctionSpec spec;
  spec.degree = 1;
  spec.breakpoints = uniform_breakpoints(axis, 1);
  const auto basis = find_basis(spec.basis)->make(spec, axis);
  EXPECT_TRUE(prior_shapes(*basis, axis, Eigen::MatrixXd::Identity(2, 2)).empty());
}

/// Functions, each read directly at 61 positions.
struct DirectReadings {
  std::vector<SmoothingTerm> terms;
  std::vector<NoiseGroupEquations> equations;
  GaussianPrior prior = GaussianPrior::none(0);
  Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(61, 0.0, 1.0);
  std::vector<Eigen::VectorXd> values;
  double sigma = 0.2e-6;

  struct Function {
    AxisName axis;
    std::size_t shape;
    double amplitude;
  };

  /// Of one axis.
  DirectReadings(std::size_t shape, const std::vector<double>& amplitudes)
      : DirectReadings(functions_of_x(shape, amplitudes)) {}

  explicit DirectReadings(const std::vector<Function>& functions) {
    const Axis axis = axis_of_one_metre();
    const auto basis = fine_splines(axis);
    const int n = basis->size();
    const auto shapes = std::make_shared<const std::vector<PriorShape>>(
        prior_shapes(*basis, axis, Eigen::MatrixXd::Identity(n, n)));
    const Eigen::MatrixXd rows = rows_at(*basis, q);
    const auto count = static_cast<Eigen::Index>(functions.size());
    equations.push_back({Eigen::MatrixXd::Zero(n * count, n * count), Eigen::VectorXd::Zero(n * count), 0.0,
                         static_cast<double>(q.size() * count)});
    prior = GaussianPrior::none(n * static_cast<int>(count));
    std::mt19937_64 engine(7);
    std::normal_distribution<double> normal;
    for (Eigen::Index f = 0; f < count; ++f) {
      const auto& [function_axis, shape, amplitude] = functions[static_cast<std::size_t>(f)];
      Eigen::MatrixXd covariance =
          kernel_matrix((*shapes)[shape], q, q) * (amplitude * amplitude / mean_variance((*shapes)[shape]));
      covariance.diagonal().array() += sigma * sigma;
      Eigen::VectorXd white(q.size());
      for (double& value : white) value = normal(engine);
      values.push_back(Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL() * white + 5e-6 * q);
      equations[0].matrix.block(f * n, f * n, n, n) = rows.transpose() * rows / (sigma * sigma);
      equations[0].gradient.segment(f * n, n) = -rows.transpose() * values.back() / (sigma * sigma);
      equations[0].squares += values.back().squaredNorm() / (sigma * sigma);
      terms.push_back({ErrorSymbol{kAllComponents[static_cast<std::size_t>(f)], function_axis},
                       static_cast<int>(f) * n, shapes, 6, 1.0 / (5e-6 * 5e-6)});
    }
  }

  static std::vector<Function> functions_of_x(std::size_t shape, const std::vector<double>& amplitudes) {
    std::vector<Function> functions;
    for (const double amplitude : amplitudes) functions.push_back({AxisName::X, shape, amplitude});
    return functions;
  }

  /// Shapes by evidence, per function.
  std::vector<std::size_t> chosen_shapes() {
    EvidenceOptions options;
    options.variance_components = false;
    maximise_evidence(equations, Eigen::VectorXd::Zero(prior.mean.size()), prior, options, {1.0}, terms);
    std::vector<std::size_t> chosen;
    for (const SmoothingTerm& term : terms) chosen.push_back(term.shape);
    return chosen;
  }

  /// log density of the values under a shape and amplitudes, vague lines, by dense covariances.
  double log_density(const PriorShape& shape, const std::vector<double>& lambda) const {
    double sum = 0.0;
    for (std::size_t f = 0; f < values.size(); ++f) {
      Eigen::MatrixXd covariance = kernel_matrix(shape, q, q) / mean_variance(shape) / lambda[f];
      covariance += 1e-4 * (Eigen::MatrixXd::Ones(q.size(), q.size()) + q * q.transpose());
      covariance.diagonal().array() += sigma * sigma;
      const Eigen::LLT<Eigen::MatrixXd> root(covariance);
      sum -= 0.5 * values[f].dot(root.solve(values[f])) + root.matrixLLT().diagonal().array().log().sum();
    }
    return sum;
  }
};

TEST(SmoothingTerms, AreAlikeUpToAQuarterOfAnAmplitude) {
  std::vector<SmoothingTerm> terms(2), others(2);
  terms[0].lambda = terms[1].lambda = others[0].lambda = 4.0;
  others[1].lambda = 4.0 / (1.25 * 1.25);
  EXPECT_TRUE(alike(terms, others));
  others[1].lambda = 4.0 / (1.30 * 1.30);
  EXPECT_FALSE(alike(terms, others));
  others = terms;
  others[0].shape = 1;
  EXPECT_FALSE(alike(terms, others));
  others.pop_back();
  EXPECT_FALSE(alike(terms, others));
}

TEST(MaximiseEvidence, FindsTheHighestPointOfTheDenseLikelihood) {
  DirectReadings readings(2 * kPriorLengths + 6, {4e-6, 8e-6, 2e-6, 6e-6, 5e-6, 3e-6});
  EvidenceOptions options;
  options.variance_components = false;
  maximise_evidence(readings.equations, Eigen::VectorXd::Zero(readings.prior.mean.size()), readings.prior,
                    options, {1.0}, readings.terms);
  std::vector<double> lambda;
  for (const SmoothingTerm& term : readings.terms) lambda.push_back(term.lambda);
  const std::size_t shape = readings.terms[0].shape;
  const auto& shapes = *readings.terms[0].shapes;
  const double best = readings.log_density(shapes[shape], lambda);
  for (std::size_t f = 0; f < lambda.size(); ++f) {
    for (const double factor : {0.5, 2.0}) {
      std::vector<double> other = lambda;
      other[f] *= factor;
      EXPECT_GT(best, readings.log_density(shapes[shape], other)) << "function " << f << " x " << factor;
    }
  }
  const double at_truth = readings.log_density(
      shapes[2 * kPriorLengths + 6],
      {1.0 / 16e-12, 1.0 / 64e-12, 1.0 / 4e-12, 1.0 / 36e-12, 1.0 / 25e-12, 1.0 / 9e-12});
  EXPECT_GT(best, at_truth - 1.0) << to_string(shapes[shape].roughness) << " " << shapes[shape].length;
}

// The second axis alone would choose another shape than the first.
TEST(MaximiseEvidence, GivesAxesThatAreHardToTellApartOneShape) {
  const std::vector<DirectReadings::Function> x = {{AxisName::X, 6, 4e-6}, {AxisName::X, 6, 4e-6}};
  const std::vector<DirectReadings::Function> y = {{AxisName::Y, 7, 4e-6}, {AxisName::Y, 7, 4e-6}};
  EXPECT_NE(DirectReadings(x).chosen_shapes()[0], DirectReadings(y).chosen_shapes()[0]);
  const auto together = DirectReadings({x[0], x[1], y[0], y[1]}).chosen_shapes();
  EXPECT_EQ(together, std::vector<std::size_t>(4, together[0]));
}

TEST(MaximiseEvidence, SetsAnAxisApartThatIsPlainlyRougher) {
  const auto chosen = DirectReadings({{AxisName::X, 8, 4e-6},
                                      {AxisName::X, 8, 6e-6},
                                      {AxisName::Y, 8, 5e-6},
                                      {AxisName::Y, 8, 3e-6},
                                      {AxisName::Z, 0, 4e-6},
                                      {AxisName::Z, 0, 6e-6}})
                          .chosen_shapes();
  EXPECT_EQ(chosen[0], chosen[1]);
  EXPECT_EQ(chosen[0], chosen[2]);
  EXPECT_EQ(chosen[0], chosen[3]);
  EXPECT_EQ(chosen[4], chosen[5]);
  EXPECT_LT(chosen[4] % kPriorLengths + 2, chosen[0] % kPriorLengths);
}

TEST(MaximiseEvidence, FindsTheStandardDeviation) {
  DirectReadings readings(6, {4e-6, 8e-6, 2e-6, 6e-6, 5e-6, 3e-6});
  for (NoiseGroupEquations& instrument : readings.equations) {  // stated twice as large as it is
    instrument.matrix /= 4.0;
    instrument.gradient /= 4.0;
    instrument.squares /= 4.0;
  }
  const EvidenceState state =
      maximise_evidence(readings.equations, Eigen::VectorXd::Zero(readings.prior.mean.size()), readings.prior,
                        EvidenceOptions{}, {1.0}, readings.terms);
  EXPECT_NEAR(state.scale[0], 0.5, 0.05);
}

TEST(AmplitudeCovariance, IsThatOfDifferencesOfTheDenseLikelihood) {
  DirectReadings readings(6, {4e-6});
  SmoothingTerm& term = readings.terms[0];
  const auto posterior = [&](double lambda) {
    return Eigen::MatrixXd((readings.equations[0].matrix + lambda * term.precision()).inverse());
  };
  const auto mean = [&](double lambda) {
    return Eigen::VectorXd(-posterior(lambda) * readings.equations[0].gradient);
  };
  const double step = 0.05;
  const double up = term.lambda * std::exp(step), down = term.lambda * std::exp(-step);
  const Eigen::VectorXd change = (mean(up) - mean(down)) / (2.0 * step);
  const PriorShape& shape = term.prior_shape();
  const double curvature =
      -(readings.log_density(shape, {up}) - 2.0 * readings.log_density(shape, {term.lambda}) +
        readings.log_density(shape, {down})) /
      (step * step);
  ASSERT_GT(curvature, 0.5);
  const Eigen::MatrixXd expected = change * change.transpose() / (curvature + 1.0 / 9.0);
  const Eigen::MatrixXd added =
      amplitude_covariance(readings.terms, posterior(term.lambda), mean(term.lambda));
  EXPECT_NEAR(added.trace() / expected.trace(), 1.0, 0.05);
  EXPECT_EQ(amplitude_covariance({}, posterior(term.lambda), mean(term.lambda)).norm(), 0.0);
}

}  // namespace
}  // namespace volcal
