#pragma once
/// Bases of one-dimensional error functions f(q) = sum_j c_j B_j(q), q in m (linear) or rad (rotary).

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

namespace volcal {

/// Upper bound of Basis::support(): size of a buffer that any basis can write its values to.
inline constexpr int kMaxBasisSupport = 64;

/// A linear space of functions of one axis position. Thread-safe after construction.
class Basis {
 public:
  virtual ~Basis() = default;

  /// Number of basis functions = number of coefficients.
  virtual int size() const = 0;
  /// Largest number of basis functions that differ from zero at one position.
  virtual int support() const = 0;
  /// Writes the `support()` values (or `order`-th derivatives) of the active functions at q; returns the
  /// index of the first one. Outside the travel the end pieces are continued.
  virtual int evaluate(double q, int order, double* values) const = 0;
  int evaluate(double q, double* values) const { return evaluate(q, 0, values); }
  /// Ends of the pieces on which the functions are smooth, ascending; first and last are the travel.
  virtual std::vector<double> pieces() const = 0;
  /// Degree of the polynomials that all functions are on these pieces; none where they are no polynomials.
  virtual std::optional<int> degree() const { return std::nullopt; }
  /// Highest harmonic of a Fourier series 1, cos q, sin q, cos 2q ...; 0 for other bases.
  virtual int harmonics() const { return 0; }
  /// Gauss-Legendre points per piece that integrate products of two functions to rounding.
  virtual int quadrature_order() const = 0;
  /// Order of the derivative that a smoothing prior penalises; 0 = the basis takes no prior.
  virtual int roughness_order() const = 0;

  /// f(q) for given coefficients.
  double value(double q, const Eigen::Ref<const Eigen::VectorXd>& coefficients) const;
  /// Values of all basis functions at q (zeros included).
  Eigen::VectorXd row(double q, int order = 0) const;
};

/// Moments over [travel_min, travel_max]: integrals of B_j(q) and of q B_j(q), exact for piecewise
/// polynomials.
struct BasisMoments {
  Eigen::VectorXd zeroth;
  Eigen::VectorXd first;
};
BasisMoments moments(const Basis& basis);
/// Coefficients of the function whose integrals with each B_j over the travel are `integrals`: gram(basis, 0)
/// times them, by Cholesky's method in the band that the support leaves. Memory and time in proportion to the
/// number of functions.
Eigen::VectorXd coefficients_with_integrals(const Basis& basis, const Eigen::VectorXd& integrals);
/// Gram matrix of the `order`-th derivatives, integral of B_i^(k) B_j^(k) over the travel.
Eigen::MatrixXd gram(const Basis& basis, int order);

}  // namespace volcal
