#pragma once
/// A law times a function of one more recorded variable, judged by its own column: what a surface of the
/// law's drivers does not see.
///
/// In: a law and the effect that it is. Out: longer laws at their best shapes, best first, with their LM. The
/// shape of the law itself is held. Valid near the fit.

#include <cstddef>
#include <deque>
#include <vector>

#include "volcal/identify/criticism/formulas/law.h"
#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

inline constexpr std::size_t kMostFactors = 3;    // of a law
inline constexpr std::size_t kMostLawShapes = 2;  // p and q

/// From where a variable counts in a law: home, 20 degC, 0.
double zero_of(const Machine& machine, const Variable& variable);

class FurtherFactors {
 public:
  /// `surface`: whose drivers and factors a law has already. Model and projector outlive the object, which
  /// outlives its laws.
  FurtherFactors(const LinearModel& model, const Projector& projector, const EffectSpec& surface);

  /// Functions that a law is multiplied with.
  std::size_t tried() const;
  std::vector<Law> times(const Law& law, const Effect& effect) const;

 private:
  struct Further {
    DriverRange range;
    Eigen::VectorXd value;  ///< per observation
    std::vector<ElementaryFunction> functions;
  };
  void add(const Variable& variable);

  const LinearModel& model_;
  const Projector& projector_;
  std::deque<Further> further_;
};

}  // namespace volcal
