#pragma once
/// A law, a product of elementary functions of recorded variables, and what the splines of a surface follow
/// of one. Shapes and values in the units in which users write of the variables (recorded_variable.h).

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "volcal/identify/criticism/formulas/elementary_functions.h"
#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/model/functions/tensor_basis.h"

namespace volcal {

/// One function of one variable.
struct LawFactor {
  const ElementaryFunction* function = nullptr;
  const DriverRange* range = nullptr;
};

struct Law {
  std::vector<LawFactor> factors;
  std::vector<double> shape;  ///< of all functions, one after the other
  double lm = 0.0;

  std::size_t shapes() const { return shape.size(); }
  /// The part of `shape` that belongs to a factor.
  std::vector<double> shape_of(std::size_t factor) const;
  /// "y * (z - p)^2", parameters p and q in their order; what is 1 is left out.
  std::string expression() const;
  /// Of its amplitude on a target in `of_target`: "um/mm2/K" of y^2 * (T_air - 20).
  std::string amplitude_unit(const std::string& of_target) const;
  /// "p = 120.3 mm, q = 4 K"; empty without parameters of its shape.
  std::string shape_text() const;
  bool smooth_in_shape() const;
  /// Whether it depends on anything.
  bool depends() const;
};

/// Shapes are moved, each by its step and then by less, while LM rises (compass search: Kolda, Lewis and
/// Torczon 2003, SIAM Review 45, 385).
template <class LmOf>
void climb_shape(Law& law, const LmOf& lm_of);

/// How much of what the readings show, in LM, products follow by the splines of a surface: the model without
/// the surface has been allowed to explain all it can.
class LawMeasure {
 public:
  LawMeasure(const TensorBasis& basis, const ProjectedColumns& surface);

  double lm(const Law& law) const;
  /// Of laws that differ in the function of one driver alone, the factors in the order of the drivers.
  class OfDriver {
   public:
    OfDriver(const LawMeasure& measure, const Law& law, std::size_t driver);
    double lm(const ElementaryFunction& function, const std::vector<double>& shape) const;

   private:
    const LawMeasure& measure_;
    std::size_t driver_;
    Eigen::MatrixXd gram_;
    Eigen::VectorXd score_;
  };

 private:
  /// Coefficients of the spline that follows a function of one driver best.
  Eigen::VectorXd along(std::size_t driver, const ElementaryFunction& function,
                        const std::vector<double>& shape) const;

  const TensorBasis& basis_;
  std::vector<Eigen::MatrixXd> to_coefficients_;  ///< per driver: of values at its samples
  Eigen::MatrixXd gram_;
  Eigen::VectorXd score_;
};

// Implementation.

constexpr int kShapeRefinements = 60;     // evaluations of one law's shape
constexpr double kFirstShapeStep = 0.03;  // of the variable's range
constexpr double kLastShapeStep = 3e-4;

template <class LmOf>
void climb_shape(Law& law, const LmOf& lm_of) {
  std::vector<double> step;
  for (const LawFactor& factor : law.factors)
    step.insert(step.end(), factor.function->shapes(), factor.range->to - factor.range->from);
  double share = kFirstShapeStep;
  for (int used = 0; used < kShapeRefinements && !step.empty() && share > kLastShapeStep;) {
    bool better = false;
    for (std::size_t k = 0; k < step.size() && !better; ++k) {
      for (const double sign : {-1.0, 1.0}) {
        Law moved = law;
        moved.shape[k] += sign * share * step[k];
        moved.lm = lm_of(moved);
        ++used;
        if (!(moved.lm > law.lm)) continue;
        law = std::move(moved);
        better = true;
        break;
      }
    }
    if (!better) share *= 0.5;
  }
}

}  // namespace volcal
