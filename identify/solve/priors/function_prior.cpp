#include "volcal/identify/solve/priors/function_prior.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/solve/normals/datum.h"

namespace volcal {
namespace {

constexpr int kPointsPerPiece = 4;
constexpr int kHighestDegree = 30;
constexpr int kAnalysisPoints = 64;
constexpr int kDegrees = kHighestDegree - 1;  // beyond straight lines
constexpr double kNugget = 1e-7;  // of the mean variance: keeps the covariance of smooth shapes invertible
constexpr double kEdge = 1e-9;    // in t
constexpr double kBridge = 0.25;  // in t: length of what leads a Legendre series out of the stretch

struct LengthRange {
  double shortest;
  double longest;
};
/// Chosen so that equal places in the ranges are about as smooth.
constexpr std::array<LengthRange, kRoughnessKinds> kLengthRange = {
    {{0.12, 1.6}, {0.05, 0.7}, {0.03, 0.7}, {0.06, 2.0}}};

double length_at(Roughness roughness, int place) {
  const LengthRange range = kLengthRange[static_cast<std::size_t>(roughness)];
  return range.shortest *
         std::pow(range.longest / range.shortest, static_cast<double>(place) / (kPriorLengths - 1));
}

Eigen::VectorXd collocation_points(const Basis& basis) {
  const std::vector<double> pieces = basis.pieces();
  Eigen::VectorXd points(static_cast<Eigen::Index>(pieces.size() - 1) * kPointsPerPiece);
  Eigen::Index next = 0;
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    for (int k = 0; k < kPointsPerPiece; ++k)
      points[next++] = pieces[i] + (pieces[i + 1] - pieces[i]) * (k + 0.5) / kPointsPerPiece;
  }
  return points;
}

/// Coefficients of the least-squares fit to values at the points, as a matrix.
Eigen::MatrixXd projection(const Basis& basis, const Eigen::VectorXd& points) {
  Eigen::MatrixXd values(points.size(), basis.size());
  for (Eigen::Index i = 0; i < points.size(); ++i) values.row(i) = basis.row(points[i]).transpose();
  return solve_positive_definite(values.transpose() * values, values.transpose());
}

/// How far outside of [-1, 1].
double beyond(double t) { return std::max(0.0, std::abs(t) - 1.0); }
bool is_outside(double t) { return beyond(t) > kEdge; }

/// How far outside, in what the basis resolves there: its pieces double in length.
double resolved_beyond(double t) { return kBridge * std::log1p(beyond(t) / kBridge); }

double squared_exponential(double distance) { return std::exp(-0.5 * distance * distance); }

/// Rows of columns outside of [-1, 1]: what value and slope at the edge lead to.
void lead_out(const Eigen::ArrayXd& t, Eigen::MatrixXd& columns) {
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    if (!is_outside(t[i])) continue;
    const double sense = t[i] > 0.0 ? 1.0 : -1.0, away = resolved_beyond(t[i]);
    for (Eigen::Index n = 0; n < columns.cols(); ++n) {
      const auto degree = static_cast<double>(n);
      const double value = std::sqrt(2.0 * degree + 1.0) * (n % 2 == 0 ? 1.0 : sense);
      const double slope_outwards = value * 0.5 * degree * (degree + 1.0);
      columns(i, n) = squared_exponential(away / kBridge) * (value + slope_outwards * away);
    }
  }
}

/// Covariance of what is free outside, of a variance of 1 far away, either side by itself.
Eigen::MatrixXd free_outside(const Eigen::ArrayXd& t) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(t.size(), t.size());
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    for (Eigen::Index j = 0; j < t.size(); ++j) {
      if (!is_outside(t[i]) || !is_outside(t[j]) || t[i] * t[j] < 0.0) continue;
      const double a = resolved_beyond(t[i]) / kBridge, b = resolved_beyond(t[j]) / kBridge;
      covariance(i, j) =
          squared_exponential(a - b) - squared_exponential(a) * squared_exponential(b) * (1.0 + a * b);
    }
  }
  return covariance;
}

/// Columns sqrt(2n + 1) P_n(t), n = 0, 1, ...
Eigen::MatrixXd legendre_columns(const Eigen::ArrayXd& t) {
  Eigen::MatrixXd columns(t.size(), kHighestDegree + 1);
  Eigen::ArrayXd previous = Eigen::ArrayXd::Ones(t.size());
  Eigen::ArrayXd current = t;
  columns.col(0) = previous;
  columns.col(1) = std::sqrt(3.0) * current;
  for (int n = 2; n <= kHighestDegree; ++n) {
    const Eigen::ArrayXd next = ((2 * n - 1) * t * current - (n - 1) * previous) / n;
    previous = current;
    current = next;
    columns.col(n) = std::sqrt(2.0 * n + 1.0) * current;
  }
  lead_out(t, columns);
  return columns;
}

Eigen::MatrixXd legendre_covariance(Roughness roughness, double length, const Eigen::ArrayXd& t) {
  Eigen::MatrixXd columns = legendre_columns(t).rightCols(kDegrees);
  for (int n = 2; n <= kHighestDegree; ++n) {
    const double exponent = roughness == Roughness::Heat ? n * length * n * length : n * length;
    columns.col(n - 2) *= std::exp(-exponent);
  }
  return columns * columns.transpose();
}

double correlation(Roughness roughness, double distance) {
  if (roughness == Roughness::SquaredExponential) return squared_exponential(distance);
  const double s = std::sqrt(5.0) * distance;
  return (1.0 + s + s * s / 3.0) * std::exp(-s);
}

Eigen::MatrixXd stationary_covariance(Roughness roughness, double length, const Eigen::ArrayXd& positions) {
  const Eigen::ArrayXd t = positions.unaryExpr(
      [](double each) { return is_outside(each) ? std::copysign(1.0 + resolved_beyond(each), each) : each; });
  Eigen::MatrixXd covariance(t.size(), t.size());
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    for (Eigen::Index j = 0; j < t.size(); ++j)
      covariance(i, j) = correlation(roughness, std::abs(t[i] - t[j]) / (2.0 * length));
  }
  return covariance;
}

/// Of the deviation from the least-squares line.
Eigen::MatrixXd deviation_covariance(const Eigen::MatrixXd& covariance, const Eigen::ArrayXd& t) {
  Eigen::MatrixXd lines(t.size(), 2);
  lines.col(0).setOnes();
  lines.col(1) = t;
  const Eigen::MatrixXd along = lines * solve_positive_definite(lines.transpose() * lines, lines.transpose());
  const Eigen::MatrixXd across = Eigen::MatrixXd::Identity(t.size(), t.size()) - along;
  return across * covariance * across;
}

/// Up to straight lines; mean variance of the deviation from the least-squares line 1, within [-1, 1].
Eigen::MatrixXd shape_covariance(Roughness roughness, double length, const Eigen::ArrayXd& t) {
  const bool is_series = roughness == Roughness::Geometric || roughness == Roughness::Heat;
  Eigen::MatrixXd covariance =
      is_series ? legendre_covariance(roughness, length, t) : stationary_covariance(roughness, length, t);
  std::vector<Eigen::Index> inside;
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    if (!is_outside(t[i])) inside.push_back(i);
  }
  if (static_cast<Eigen::Index>(inside.size()) == t.size()) {
    const Eigen::MatrixXd deviation = deviation_covariance(covariance, t);
    return deviation * (static_cast<double>(t.size()) / deviation.trace());
  }
  covariance *= static_cast<double>(inside.size()) /
                deviation_covariance(covariance(inside, inside), t(inside)).trace();
  if (is_series) covariance += free_outside(t);
  return covariance;
}

/// Of all shapes, in their order; of an axis or a basis they know nothing.
const std::vector<Eigen::VectorXd>& spectra() {
  static const std::vector<Eigen::VectorXd> all = [] {
    constexpr double kHalfStep = 1.0 / kAnalysisPoints;
    const Eigen::ArrayXd t = Eigen::ArrayXd::LinSpaced(kAnalysisPoints, kHalfStep - 1.0, 1.0 - kHalfStep);
    const Eigen::MatrixXd columns = legendre_columns(t);
    const Eigen::MatrixXd analyse =
        solve_positive_definite(columns.transpose() * columns, columns.transpose()).bottomRows(kDegrees);
    std::vector<Eigen::VectorXd> result;
    for (int kind = 0; kind < kRoughnessKinds; ++kind) {
      const auto roughness = static_cast<Roughness>(kind);
      for (int place = 0; place < kPriorLengths; ++place) {
        const Eigen::MatrixXd covariance = shape_covariance(roughness, length_at(roughness, place), t);
        const Eigen::VectorXd variances = (analyse * covariance * analyse.transpose()).diagonal();
        result.emplace_back(variances / variances.sum());
      }
    }
    return result;
  }();
  return all;
}

/// Columns: combinations of three neighbouring coefficients that vanish for straight lines. Outside the
/// stretch coefficients are free by far more than inside, which combinations of all would mix.
Eigen::MatrixXd contrasts_of_neighbours(const Eigen::MatrixXd& straight) {
  const Eigen::Index count = std::max<Eigen::Index>(0, straight.cols() - 2);
  Eigen::MatrixXd contrasts = Eigen::MatrixXd::Zero(straight.cols(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d constant = straight.block<1, 3>(0, i).transpose();
    const Eigen::Vector3d slope = straight.block<1, 3>(1, i).transpose();
    contrasts.col(i).segment<3>(i) = constant.cross(slope).normalized();
  }
  return contrasts;
}

/// Variance of cosine and sine of a harmonic, up to a factor.
double harmonic_variance(Roughness roughness, double length, int harmonic) {
  const double k = harmonic, w = 2.0 * std::numbers::pi * harmonic * length;
  switch (roughness) {
    case Roughness::Geometric:
      return std::exp(-2.0 * k * length);
    case Roughness::Heat:
      return std::exp(-2.0 * k * length * k * length);
    case Roughness::SquaredExponential:
      return std::exp(-0.5 * w * w);
    case Roughness::Matern52:
      return std::pow(1.0 + w * w / 5.0, -3.0);
  }
  return 0.0;
}

/// Of cos q, sin q, cos 2q, ...; their sum over one of each pair is 1.
Eigen::VectorXd periodic_spectrum(Roughness roughness, double length, int harmonics) {
  Eigen::VectorXd variances(2 * harmonics);
  for (int k = 1; k <= harmonics; ++k)
    variances.segment<2>(2 * (k - 1)).setConstant(harmonic_variance(roughness, length, k));
  return variances * (2.0 / variances.sum());
}

/// Cosine and sine of a harmonic with their mean variance, scaled as periodic_spectrum().
Eigen::VectorXd paired(const Eigen::VectorXd& variances) {
  Eigen::VectorXd result(variances.size());
  for (Eigen::Index i = 0; i < variances.size(); i += 2)
    result.segment<2>(i).setConstant(0.5 * variances.segment<2>(i).sum());
  return result * (2.0 / result.sum());
}

double periodic_correlation_length(const Eigen::VectorXd& spectrum) {
  double slope = 0.0;
  for (Eigen::Index i = 0; i < spectrum.size(); ++i) {
    const double k = static_cast<double>(i / 2 + 1);
    slope += spectrum[i] * k * k;
  }
  return std::sqrt(spectrum.sum() / slope) / (2.0 * std::numbers::pi);
}

}  // namespace

std::string_view to_string(Roughness roughness) {
  switch (roughness) {
    case Roughness::Geometric:
      return "geometric";
    case Roughness::Heat:
      return "heat";
    case Roughness::SquaredExponential:
      return "squared exponential";
    case Roughness::Matern52:
      return "Matern 5/2";
  }
  return "";
}

double PriorShape::correlation_length() const {
  if (periodic) return periodic_correlation_length(spectrum);
  double slope = 0.0;
  for (Eigen::Index i = 0; i < spectrum.size(); ++i) {
    const double n = static_cast<double>(i) + 2.0;
    slope += spectrum[i] * n * (n + 1.0);  // mean of (1 - t^2) (2n + 1) P_n'^2
  }
  return 0.5 * std::sqrt(spectrum.sum() * 2.0 / 3.0 / slope);
}

FunctionPriors::FunctionPriors(const Basis& basis, const Axis& axis, const Eigen::MatrixXd& datum_basis)
    : FunctionPriors(basis, ResolvedStretch{axis.travel_min, axis.travel_max, 1}, datum_basis) {}

FunctionPriors::FunctionPriors(const Basis& basis, const ResolvedStretch& stretch,
                               const Eigen::MatrixXd& datum_basis)
    : stretch_length_(stretch.max - stretch.min), periodic_(basis.harmonics() > 0) {
  if (periodic_) {
    add_periodic_shapes(basis, datum_basis);
    return;
  }
  const Eigen::VectorXd points = collocation_points(basis);
  const Eigen::ArrayXd t = (2.0 * points.array() - stretch.min - stretch.max) / stretch_length_;
  reaches_beyond_ = t.unaryExpr([](double each) { return beyond(each); }).maxCoeff() > kEdge;
  const Eigen::MatrixXd project = projection(basis, points);
  Eigen::MatrixXd straight(2, basis.size());
  straight.row(0) = project.rowwise().sum().transpose();
  straight.row(1) = (project * t.matrix()).transpose();
  const Eigen::MatrixXd contrasts =
      reaches_beyond_ ? contrasts_of_neighbours(straight) : null_space(straight);
  if (contrasts.cols() == 0) return;
  const Eigen::MatrixXd of_values = contrasts.transpose() * project;
  of_reduced_ = contrasts.transpose() * datum_basis;
  of_series_ = of_values * legendre_columns(t).rightCols(kDegrees);
  if (reaches_beyond_) of_outside_ = of_values * free_outside(t) * of_values.transpose();
  for (int kind = 0; kind < kRoughnessKinds; ++kind) {
    const auto roughness = static_cast<Roughness>(kind);
    for (int place = 0; place < kPriorLengths; ++place) {
      const double length = length_at(roughness, place);
      const Eigen::MatrixXd covariance = shape_covariance(roughness, length, t);
      PriorShape shape = with_covariance(of_values * covariance * of_values.transpose());
      shape.roughness = roughness;
      shape.length = length;
      shape.spectrum = spectra()[shapes_.size()];
      shapes_.push_back(std::make_shared<const PriorShape>(std::move(shape)));
    }
  }
}

void FunctionPriors::add_periodic_shapes(const Basis& basis, const Eigen::MatrixXd& datum_basis) {
  const int harmonics = basis.harmonics();
  stretch_length_ = 2.0 * std::numbers::pi;
  of_reduced_ = datum_basis.bottomRows(2 * harmonics);
  of_series_ = Eigen::MatrixXd::Identity(2 * harmonics, 2 * harmonics);
  for (int kind = 0; kind < kRoughnessKinds; ++kind) {
    const auto roughness = static_cast<Roughness>(kind);
    for (int place = 0; place < kPriorLengths; ++place) {
      PriorShape like;
      like.roughness = roughness;
      like.length = length_at(roughness, place);
      const Eigen::VectorXd spectrum = periodic_spectrum(roughness, like.length, harmonics);
      shapes_.push_back(std::make_shared<const PriorShape>(with_spectrum(like, spectrum)));
    }
  }
}

Eigen::MatrixXd FunctionPriors::with_nugget(Eigen::MatrixXd of_contrasts) const {
  if (reaches_beyond_) {
    of_contrasts.diagonal() *= 1.0 + kNugget;
  } else {
    of_contrasts.diagonal().array() += kNugget * of_contrasts.diagonal().mean();
  }
  return of_contrasts;
}

PriorShape FunctionPriors::with_covariance(const Eigen::MatrixXd& of_contrasts) const {
  const std::optional<Eigen::MatrixXd> root = cholesky_lower(with_nugget(of_contrasts));
  if (!root) throw std::runtime_error("the prior covariance of an error function is not positive definite");
  Eigen::MatrixXd half = of_reduced_;
  solve_lower(*root, half);
  PriorShape shape;
  shape.precision = half.transpose() * half;
  shape.log_determinant = -log_determinant(*root);
  shape.rank = static_cast<int>(of_contrasts.cols());
  return shape;
}

PriorShape FunctionPriors::with_spectrum(const PriorShape& like, const Eigen::VectorXd& variances) const {
  const Eigen::VectorXd spectrum =
      periodic_ ? paired(variances) : Eigen::VectorXd(variances / variances.sum());
  Eigen::MatrixXd covariance = of_series_ * spectrum.asDiagonal() * of_series_.transpose();
  if (reaches_beyond_) covariance += of_outside_;
  PriorShape shape = with_covariance(covariance);
  shape.roughness = like.roughness;
  shape.length = like.length;
  shape.spectrum = spectrum;
  shape.periodic = periodic_;
  return shape;
}

Eigen::VectorXd FunctionPriors::expected_squares(const PriorShape& prior, double lambda,
                                                 const Eigen::VectorXd& mean,
                                                 const Eigen::Ref<const Eigen::MatrixXd>& covariance) const {
  const Eigen::MatrixXd across = prior.spectrum.asDiagonal() * of_series_.transpose();
  Eigen::MatrixXd of_contrasts = of_series_ * across;
  if (reaches_beyond_) of_contrasts += of_outside_;
  of_contrasts = with_nugget(std::move(of_contrasts));
  const Eigen::MatrixXd gain = solve_positive_definite(of_contrasts, across.transpose()).transpose();
  const Eigen::MatrixXd coefficients = gain * of_reduced_;
  const Eigen::VectorXd known = (coefficients * mean).cwiseAbs2() +
                                (coefficients * covariance).cwiseProduct(coefficients).rowwise().sum();
  const Eigen::VectorXd open = prior.spectrum - gain.cwiseProduct(across).rowwise().sum();
  return (lambda * known + open).cwiseMax(0.0);  // below by rounding alone
}

}  // namespace volcal
