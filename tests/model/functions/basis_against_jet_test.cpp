/// Values and derivatives of our bases against the textbook definition, differentiated by automatic
/// differentiation (ceres::Jet). What every registered basis must keep is in basis_contract_test.cpp.

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

using First = ceres::Jet<double, 1>;
using Second = ceres::Jet<First, 1>;

double plain(const Second& value) { return value.a.a; }

Second constant(double value) { return Second(First(value)); }

/// De Boor 1978, ch. IX, (14): B_(j,1) = 1 on [t_j, t_(j+1)), and
/// B_(j,k) = (q - t_j) / (t_(j+k-1) - t_j) B_(j,k-1) + (t_(j+k) - q) / (t_(j+k) - t_(j+1)) B_(j+1,k-1).
Second cox_de_boor(const std::vector<double>& knots, std::size_t j, int order, const Second& q) {
  if (order == 1) return constant(knots[j] <= plain(q) && plain(q) < knots[j + 1] ? 1.0 : 0.0);
  const std::size_t end = j + static_cast<std::size_t>(order);
  Second sum = constant(0.0);
  if (knots[end - 1] > knots[j])
    sum +=
        (q - constant(knots[j])) / constant(knots[end - 1] - knots[j]) * cox_de_boor(knots, j, order - 1, q);
  if (knots[end] > knots[j + 1])
    sum += (constant(knots[end]) - q) / constant(knots[end] - knots[j + 1]) *
           cox_de_boor(knots, j + 1, order - 1, q);
  return sum;
}

std::vector<Second> bspline(const FunctionSpec& spec, const Axis&, const Second& q) {
  std::vector<double> knots(static_cast<std::size_t>(spec.degree), spec.breakpoints.front());
  knots.insert(knots.end(), spec.breakpoints.begin(), spec.breakpoints.end());
  knots.insert(knots.end(), static_cast<std::size_t>(spec.degree), spec.breakpoints.back());
  std::vector<Second> values;
  for (std::size_t j = 0; j + static_cast<std::size_t>(spec.degree) + 1 < knots.size(); ++j)
    values.push_back(cox_de_boor(knots, j, spec.degree + 1, q));
  return values;
}

/// Abramowitz and Stegun 22.3.8: P_n(t) = 2^-n sum_m (-1)^m C(n, m) C(2n - 2m, n) t^(n - 2m).
std::vector<Second> legendre(const FunctionSpec& spec, const Axis& axis, const Second& q) {
  const auto binomial = [](int n, int k) {
    double value = 1.0;
    for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
    return value;
  };
  const Second t = (q - constant(axis.travel_min)) * constant(2.0 / axis.travel()) - constant(1.0);
  std::vector<Second> values;
  for (int n = 0; n <= spec.degree; ++n) {
    Second sum = constant(0.0);
    for (int m = 0; 2 * m <= n; ++m) {
      Second power = constant(1.0);
      for (int i = 0; i < n - 2 * m; ++i) power *= t;
      sum += constant((m % 2 == 0 ? 1.0 : -1.0) * binomial(n, m) * binomial(2 * n - 2 * m, n)) * power;
    }
    values.push_back(sum * constant(std::pow(0.5, n)));
  }
  return values;
}

std::vector<Second> fourier(const FunctionSpec& spec, const Axis&, const Second& q) {
  using std::cos;
  using std::sin;
  std::vector<Second> values = {constant(1.0)};
  for (int k = 1; k <= spec.degree; ++k) {
    values.push_back(cos(constant(k) * q));
    values.push_back(sin(constant(k) * q));
  }
  return values;
}

std::vector<Second> zero_basis(const FunctionSpec&, const Axis&, const Second&) { return {}; }

struct TextbookBasis {
  const char* name;
  std::vector<Second> (*values)(const FunctionSpec& spec, const Axis& axis, const Second& q);
};
constexpr TextbookBasis kTextbook[] = {
    {"zero", zero_basis}, {"bspline", bspline}, {"legendre", legendre}, {"fourier", fourier}};

Axis axis_for(const BasisKind& kind) {
  Axis axis;
  axis.name = kind.linear_axes ? AxisName::X : AxisName::C;
  axis.travel_min = kind.linear_axes ? -0.3 : -std::numbers::pi;
  axis.travel_max = kind.linear_axes ? 0.7 : std::numbers::pi;
  return axis;
}

void expect_row(const Basis& basis, double q, int order, const Eigen::VectorXd& expected) {
  if (expected.size() == 0) return;
  const double scale = 1.0 + expected.cwiseAbs().maxCoeff();
  EXPECT_LT((basis.row(q, order) - expected).cwiseAbs().maxCoeff(), 1e-11 * scale)
      << "derivative " << order << " at " << q;
}

TEST(BasisAgainstJet, ValuesAndTwoDerivativesOfOurBases) {
  for (const TextbookBasis& textbook : kTextbook) {
    const BasisKind* kind = find_basis(textbook.name);
    ASSERT_NE(kind, nullptr) << textbook.name;
    const Axis axis = axis_for(*kind);
    for (int degree = kind->degree_min; degree <= std::min(kind->degree_max, 6); ++degree) {
      SCOPED_TRACE(std::string(kind->name) + " " + std::to_string(degree));
      FunctionSpec spec;
      spec.basis = std::string(kind->name);
      spec.degree = degree;
      if (kind->uses_knots) {
        spec.knots = KnotChoice::Explicit;
        spec.breakpoints = uniform_breakpoints(axis, 5);
        spec.breakpoints[2] += 0.07 * axis.travel();
      }
      const std::unique_ptr<Basis> basis = kind->make(spec, axis);
      for (int i = 0; i < 23; ++i) {
        const double q = axis.travel_min + (i + 0.37) / 23.0 * axis.travel();  // on no knot
        Second jet(First(q, 0), 0);
        jet.v[0] = First(1.0);
        const std::vector<Second> exact = textbook.values(spec, axis, jet);
        ASSERT_EQ(static_cast<int>(exact.size()), basis->size());
        Eigen::VectorXd value(basis->size()), first(basis->size()), second(basis->size());
        for (Eigen::Index j = 0; j < value.size(); ++j) {
          const Second& each = exact[static_cast<std::size_t>(j)];
          value[j] = each.a.a;
          first[j] = each.a.v[0];
          second[j] = each.v[0].v[0];
        }
        expect_row(*basis, q, 0, value);
        expect_row(*basis, q, 1, first);
        expect_row(*basis, q, 2, second);
      }
    }
  }
}

}  // namespace
}  // namespace volcal
