// Priors of smooth functions against Gaussian-process regression written down by its covariances (Rasmussen
// and Williams 2006, eq. 2.25-2.30 and 2.41), which knows nothing of splines or precisions.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/normals/datum.h"
#include "volcal/identify/solve/priors/evidence.h"
#include "volcal/model/functions/registry.h"
#include "volcal/sim/machine/reference_machines.h"

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
  const FunctionPriors family(*basis, axis, identity);
  const PriorShape& shape = *family.shapes()[GetParam()];
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
  const FunctionPriors family(*basis, axis, datum);
  for (const auto& shape : family.shapes()) {
    EXPECT_LT(line.dot(shape->precision * line), 1e-6) << to_string(shape->roughness) << " " << shape->length;
    EXPECT_EQ(shape->rank, basis->size() - 2);
  }
}

TEST(PriorShapes, OfSeriesFollowFromTheirSpectrum) {
  const Axis axis = axis_of_one_metre();
  const auto basis = fine_splines(axis);
  const FunctionPriors family(*basis, axis, Eigen::MatrixXd::Identity(basis->size(), basis->size()));
  for (const Roughness roughness : {Roughness::Geometric, Roughness::Heat}) {
    const PriorShape& shape = *family.shapes()[static_cast<std::size_t>(roughness) * kPriorLengths + 5];
    const PriorShape again = family.with_spectrum(shape, 7.0 * shape.spectrum);
    EXPECT_NEAR(shape.spectrum.sum(), 1.0, 1e-12);
    EXPECT_NEAR(again.spectrum.sum(), 1.0, 1e-12);
    const Eigen::MatrixXd readings = 1e3 * Eigen::MatrixXd::Identity(basis->size(), basis->size());
    const Eigen::MatrixXd posterior = (readings + shape.precision).inverse();
    EXPECT_LT(((readings + again.precision).inverse() - posterior).norm(), 0.01 * posterior.norm())
        << to_string(shape.roughness) << " " << shape.length;
  }
}

TEST(PriorShapes, KnowTheirCorrelationLength) {
  PriorShape parabolas;
  parabolas.spectrum = Eigen::VectorXd::Unit(29, 0);  // n = 2: slope 6, weighted mean square 2 * 3
  EXPECT_NEAR(parabolas.correlation_length(), 1.0 / 6.0, 1e-12);

  const Axis axis = axis_of_one_metre();
  const auto basis = fine_splines(axis);
  const FunctionPriors family(*basis, axis, Eigen::MatrixXd::Identity(basis->size(), basis->size()));
  const PriorShape& squared_exponential = *family.shapes()[2 * kPriorLengths + 3];
  // Without its straight part a function is a little rougher.
  EXPECT_LT(squared_exponential.correlation_length(), squared_exponential.length);
  EXPECT_GT(squared_exponential.correlation_length(), 0.75 * squared_exponential.length);
}

TEST(PriorShapes, ExpectTheirSpectrumWithoutReadingsAndTheSquaresOfWhatIsKnown) {
  const Axis axis = axis_of_one_metre();
  const auto basis = fine_splines(axis);
  const Eigen::Index n = basis->size();
  const FunctionPriors family(*basis, axis, Eigen::MatrixXd::Identity(n, n));
  const PriorShape& shape = *family.shapes()[6];
  const double lambda = 1.0 / 9e-12;
  const Eigen::MatrixXd unknown =
      (lambda * shape.precision + 1e-6 * lambda * Eigen::MatrixXd::Identity(n, n)).inverse();
  const Eigen::VectorXd without = family.expected_squares(shape, lambda, Eigen::VectorXd::Zero(n), unknown);
  EXPECT_LT((without - shape.spectrum).norm(), 3e-3);

  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(200, 0.0, 1.0);
  Eigen::VectorXd values(q.size());
  for (Eigen::Index i = 0; i < q.size(); ++i)
    values[i] = 3e-6 * std::legendre(2, 2.0 * q[i] - 1.0) - 2e-6 * std::legendre(5, 2.0 * q[i] - 1.0);
  const Eigen::VectorXd known = rows_at(*basis, q).colPivHouseholderQr().solve(values);
  const Eigen::VectorXd squares =
      family.expected_squares(shape, lambda, known, Eigen::MatrixXd::Zero(n, n)) / lambda;
  EXPECT_NEAR(squares[0], 9e-12 / 5.0, 1e-14);
  EXPECT_NEAR(squares[3], 4e-12 / 11.0, 1e-14);
}

TEST(PriorShapes, NoneForABasisOfStraightLines) {
  const Axis axis = axis_of_one_metre();
  FunctionSpec spec;
  spec.degree = 1;
  spec.breakpoints = uniform_breakpoints(axis, 1);
  const auto basis = find_basis(spec.basis)->make(spec, axis);
  EXPECT_TRUE(FunctionPriors(*basis, axis, Eigen::MatrixXd::Identity(2, 2)).shapes().empty());
}

/// Functions, each read directly at 61 positions.
struct DirectReadings {
  std::vector<SmoothingTerm> terms;
  std::vector<NoiseGroupEquations> equations;
  GaussianPrior prior = GaussianPrior::none(0);
  Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(61, 0.0, 1.0);
  Eigen::MatrixXd rows;
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
    const auto family = std::make_shared<const FunctionPriors>(*basis, axis, Eigen::MatrixXd::Identity(n, n));
    rows = rows_at(*basis, q);
    const auto count = static_cast<Eigen::Index>(functions.size());
    equations.push_back({Eigen::MatrixXd::Zero(n * count, n * count), Eigen::VectorXd::Zero(n * count), 0.0,
                         static_cast<double>(q.size() * count)});
    prior = GaussianPrior::none(n * static_cast<int>(count));
    std::mt19937_64 engine(7);
    std::normal_distribution<double> normal;
    for (Eigen::Index f = 0; f < count; ++f) {
      const auto& [function_axis, shape, amplitude] = functions[static_cast<std::size_t>(f)];
      const PriorShape& kind = *family->shapes()[shape];
      Eigen::MatrixXd covariance = kernel_matrix(kind, q, q) * (amplitude * amplitude / mean_variance(kind));
      covariance.diagonal().array() += sigma * sigma;
      Eigen::VectorXd white(q.size());
      for (double& value : white) value = normal(engine);
      values.emplace_back(Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL() * white + 5e-6 * q);
      equations[0].matrix.block(f * n, f * n, n, n) = rows.transpose() * rows / (sigma * sigma);
      equations[0].gradient.segment(f * n, n) = -rows.transpose() * values.back() / (sigma * sigma);
      equations[0].squares += values.back().squaredNorm() / (sigma * sigma);
      terms.push_back({ErrorSymbol{kAllComponents[static_cast<std::size_t>(f)], function_axis},
                       static_cast<int>(f) * n, family, 6, 1.0 / (5e-6 * 5e-6), family->shapes()[6]});
    }
  }

  static std::vector<Function> functions_of_x(std::size_t shape, const std::vector<double>& amplitudes) {
    std::vector<Function> functions;
    functions.reserve(amplitudes.size());
    for (const double amplitude : amplitudes) functions.push_back({AxisName::X, shape, amplitude});
    return functions;
  }

  void set_values(const std::function<double(std::size_t, double)>& function) {
    equations[0].squares = 0.0;
    const Eigen::Index n = equations[0].matrix.rows() / static_cast<Eigen::Index>(values.size());
    for (std::size_t f = 0; f < values.size(); ++f) {
      for (Eigen::Index i = 0; i < q.size(); ++i) values[f][i] = function(f, q[i]);
      equations[0].gradient.segment(static_cast<Eigen::Index>(f) * n, n) =
          -rows.transpose() * values[f] / (sigma * sigma);
      equations[0].squares += values[f].squaredNorm() / (sigma * sigma);
    }
  }

  void maximise() {
    EvidenceOptions options;
    options.variance_components = false;
    maximise_evidence(equations, Eigen::VectorXd::Zero(prior.mean.size()), prior, options, {1.0}, terms);
  }

  /// Shapes by evidence, per function.
  std::vector<std::size_t> chosen_shapes() {
    maximise();
    std::vector<std::size_t> chosen;
    for (const SmoothingTerm& term : terms) chosen.push_back(term.shape);
    return chosen;
  }

  Eigen::MatrixXd of_kernel(const PriorShape& shape) const {
    return kernel_matrix(shape, q, q) / mean_variance(shape);
  }
  Eigen::MatrixXd of_spectrum(const Eigen::VectorXd& spectrum) const {
    Eigen::MatrixXd polynomials(q.size(), spectrum.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      for (unsigned n = 2; n < spectrum.size() + 2; ++n)
        polynomials(i, n - 2) = std::sqrt(2.0 * n + 1.0) * std::legendre(n, 2.0 * q[i] - 1.0);
    }
    return polynomials * spectrum.asDiagonal() * polynomials.transpose();
  }

  /// log density of the values under a covariance of unit amplitude and amplitudes, vague lines, by dense
  /// covariances.
  double log_density(const Eigen::MatrixXd& of_unit, const std::vector<double>& lambda) const {
    double sum = 0.0;
    for (std::size_t f = 0; f < values.size(); ++f) {
      Eigen::MatrixXd covariance = of_unit / lambda[f];
      covariance += 1e-4 * (Eigen::MatrixXd::Ones(q.size(), q.size()) + q * q.transpose());
      covariance.diagonal().array() += sigma * sigma;
      const Eigen::LLT<Eigen::MatrixXd> root(covariance);
      sum -= 0.5 * values[f].dot(root.solve(values[f])) + root.matrixLLT().diagonal().array().log().sum();
    }
    return sum;
  }
};

TEST(SmoothingTerms, AreAlikeUpToAQuarterOfAnAmplitude) {
  const auto of_degree = [](int degree) {
    PriorShape shape;
    shape.spectrum = Eigen::VectorXd::Unit(8, degree - 2);
    return std::make_shared<const PriorShape>(shape);
  };
  std::vector<SmoothingTerm> terms(2), others(2);
  for (auto* both : {&terms, &others}) {
    for (SmoothingTerm& term : *both) term.prior = of_degree(6);
  }
  terms[0].lambda = terms[1].lambda = others[0].lambda = 4.0;
  others[1].lambda = 4.0 / (1.25 * 1.25);
  EXPECT_TRUE(alike(terms, others));
  others[1].lambda = 4.0 / (1.30 * 1.30);
  EXPECT_FALSE(alike(terms, others));
  others = terms;
  others[0].shape = 1;
  EXPECT_FALSE(alike(terms, others));
  others = terms;
  others[0].prior = of_degree(9);
  EXPECT_FALSE(alike(terms, others));
  others.pop_back();
  EXPECT_FALSE(alike(terms, others));
}

/// Readings on a straight line: the likelihood of an amplitude is highest at none, and so is that of the
/// function's interval. With the prior a exp(-a / 5 um) it is highest where the dense likelihood says.
TEST(MaximiseEvidence, KnowsNoFunctionToBeStraight) {
  for (const double sigma : {0.2e-6, 3e-6}) {
    DirectReadings readings(6, {1e-6});
    readings.equations[0].matrix *= std::pow(readings.sigma / sigma, 2);
    readings.sigma = sigma;
    readings.set_values([](std::size_t /*function*/, double q) { return 5e-6 * q; });
    readings.maximise();
    const SmoothingTerm& term = readings.terms[0];
    ASSERT_EQ(term.prior, term.family->shapes()[term.shape]);
    const Eigen::MatrixXd of_unit = readings.of_kernel(*term.prior);
    double best = 0.0, highest = -std::numeric_limits<double>::infinity();
    for (double amplitude = 1e-9; amplitude < 1e-4; amplitude *= 1.02) {
      const double height = readings.log_density(of_unit, {1.0 / (amplitude * amplitude)}) +
                            std::log(amplitude) - amplitude / 5e-6;
      if (height <= highest) continue;
      highest = height;
      best = amplitude;
    }
    EXPECT_GT(best, 0.05 * sigma);
    EXPECT_NEAR(1.0 / std::sqrt(term.lambda), best, 0.05 * best) << sigma;
  }
}

TEST(MaximiseEvidence, FindsTheHighestPointOfTheDenseLikelihood) {
  DirectReadings readings(2 * kPriorLengths + 6, {4e-6, 8e-6, 2e-6, 6e-6, 5e-6, 3e-6});
  const PriorShape& true_shape = *readings.terms[0].family->shapes()[2 * kPriorLengths + 6];
  readings.maximise();
  std::vector<double> lambda;
  for (const SmoothingTerm& term : readings.terms) lambda.push_back(term.lambda);
  const auto& kept = readings.terms[0];
  EXPECT_EQ(kept.prior, kept.family->shapes()[kept.shape]);  // six functions give no better spectrum than it
  const Eigen::MatrixXd prior = readings.of_kernel(*kept.prior);
  const double best = readings.log_density(prior, lambda);
  for (std::size_t f = 0; f < lambda.size(); ++f) {
    for (const double factor : {0.5, 2.0}) {
      std::vector<double> other = lambda;
      other[f] *= factor;
      EXPECT_GT(best, readings.log_density(prior, other)) << "function " << f << " x " << factor;
    }
  }
  const double at_truth = readings.log_density(
      readings.of_kernel(true_shape),
      {1.0 / 16e-12, 1.0 / 64e-12, 1.0 / 4e-12, 1.0 / 36e-12, 1.0 / 25e-12, 1.0 / 9e-12});
  EXPECT_GT(best, at_truth - 1.0);
}

// The second axis alone would choose another shape than the first.
TEST(MaximiseEvidence, GivesAxesThatAreHardToSeparateOneShape) {
  const std::vector<DirectReadings::Function> x = {{AxisName::X, 6, 4e-6}, {AxisName::X, 6, 4e-6}};
  const std::vector<DirectReadings::Function> y = {{AxisName::Y, 7, 4e-6}, {AxisName::Y, 7, 4e-6}};
  EXPECT_NE(DirectReadings(x).chosen_shapes()[0], DirectReadings(y).chosen_shapes()[0]);
  const auto together = DirectReadings({x[0], x[1], y[0], y[1]}).chosen_shapes();
  EXPECT_EQ(together, std::vector<std::size_t>(4, together[0]));
}

TEST(MaximiseEvidence, SetsAnAxisApartThatIsPlainlyRougher) {
  DirectReadings readings({{AxisName::X, 8, 4e-6},
                           {AxisName::X, 8, 6e-6},
                           {AxisName::Y, 8, 5e-6},
                           {AxisName::Y, 8, 3e-6},
                           {AxisName::Z, 0, 4e-6},
                           {AxisName::Z, 0, 6e-6}});
  readings.maximise();
  std::vector<double> length;
  for (const SmoothingTerm& term : readings.terms) length.push_back(term.prior->correlation_length());
  EXPECT_EQ(length[0], length[1]);
  EXPECT_NEAR(length[2], length[0], 0.4 * length[0]);
  EXPECT_EQ(length[4], length[5]);
  EXPECT_LT(length[4], 0.6 * length[0]);
}

TEST(MaximiseEvidence, CorrectsTheSpectrumWhereReadingsShowAnother) {
  DirectReadings readings(6, std::vector<double>(6, 1e-6));
  const Eigen::VectorXd start = readings.terms[0].family->shapes()[6]->spectrum;
  readings.set_values([](std::size_t f, double q) {
    const double sign = f % 2 == 0 ? 1.0 : -1.0;
    return sign * 5e-6 * std::legendre(2, 2.0 * q - 1.0) + 4e-6 * std::legendre(6, 2.0 * q - 1.0);
  });
  readings.maximise();
  const Eigen::VectorXd spectrum = readings.terms[0].prior->spectrum;
  const double c2 = 25.0 / 5.0, c6 = 16.0 / 13.0;  // sqrt(2n + 1) P_n has a mean square of 1
  EXPECT_NEAR(spectrum[4] / spectrum[0], c6 / c2, 0.05 * c6 / c2);
  EXPECT_LT(spectrum[2] / spectrum[0], 0.5 * start[2] / start[0]);
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

TEST(MaximiseEvidence, IntegratesOutWhatIsNotSmoothed) {
  DirectReadings readings(6, {4e-6, 8e-6});
  NoiseGroupEquations& own = readings.equations[0];
  const Eigen::Index n = own.matrix.rows(), half = n / 2;
  const double weight = 1.0 / (readings.sigma * readings.sigma), wide = 1.0 / (1e-4 * 1e-4);
  // An offset of all readings beside the functions.
  Eigen::VectorXd coupling(n);
  coupling << readings.rows.colwise().sum().transpose(), readings.rows.colwise().sum().transpose();
  coupling *= weight;
  const double information = weight * 2.0 * static_cast<double>(readings.q.size()) + wide;
  const double pull = -weight * (readings.values[0].sum() + readings.values[1].sum());
  NoiseGroupEquations with_offset{Eigen::MatrixXd::Zero(n + 1, n + 1), Eigen::VectorXd(n + 1), own.squares,
                                  own.observations};
  with_offset.matrix.topLeftCorner(n, n) = own.matrix;
  with_offset.matrix.col(n).head(n) = coupling;
  with_offset.matrix.row(n).head(n) = coupling.transpose();
  with_offset.matrix(n, n) = information - wide;
  with_offset.gradient << own.gradient, pull;
  GaussianPrior prior = GaussianPrior::none(static_cast<int>(n) + 1);
  prior.precision(n, n) = wide;
  std::vector<SmoothingTerm> terms = readings.terms;
  const EvidenceOptions held{.variance_components = false};
  const EvidenceState all =
      maximise_evidence({with_offset}, Eigen::VectorXd::Zero(n + 1), prior, held, {1.0}, terms);

  own.matrix -= coupling * coupling.transpose() / information;
  own.gradient -= coupling * (pull / information);
  const EvidenceState by_hand = maximise_evidence(readings.equations, Eigen::VectorXd::Zero(n),
                                                  readings.prior, held, {1.0}, readings.terms);
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_EQ(terms[f].offset, static_cast<int>(f) * half);
    EXPECT_EQ(terms[f].shape, readings.terms[f].shape);
    EXPECT_NEAR(terms[f].lambda / readings.terms[f].lambda, 1.0, 1e-6);
  }
  // The search counts 0.02 as settled.
  EXPECT_NEAR(all.log_evidence,
              by_hand.log_evidence + 0.5 * (pull * pull / information - std::log(information)), 1e-3);
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
  const Eigen::MatrixXd of_unit = readings.of_kernel(*term.prior);
  const double curvature =
      -(readings.log_density(of_unit, {up}) - 2.0 * readings.log_density(of_unit, {term.lambda}) +
        readings.log_density(of_unit, {down})) /
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
