#pragma once
/// Effects beside the error functions that the model still holds at zero.
///
/// In: a model state that lacks error functions of the machine. Out: which effects beyond these exceed the
/// noise and what all missing functions together can make of the readings; SI. While several functions are
/// missing, an effect that is not there can follow what they leave better than any one of them. Here they
/// stand beside it as a random field: with G_k the columns of a function (left_out.h),
///
///   y = J x + sum_k G_k b_k + e,    b_k ~ N(0, v_k I),    e ~ N(0, Sigma)
///
/// v_k by restricted likelihood (Zhou, Hu, Zhou and Lange 2019, J. Comput. Graph. Stat. 28, 350: each step
/// raises it), in turn with Sigma (noise_estimate.h), whose white part is held no smaller than stated, and
/// effects by score tests at that covariance. Valid where the columns of functions can follow the errors of
/// the machine; what a function that came back may have beyond its few terms belongs to the field as well.

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

class OpenErrors {
 public:
  /// `left_out`: of the effects that were added, by their places.
  explicit OpenErrors(ModelState state, std::set<std::size_t> left_out = {})
      : state_(std::move(state)), left_out_(std::move(left_out)) {}

  /// The model holds error functions at zero that could come back.
  bool any() const;
  /// An error of the machine itself, or an effect that stands out beside those that are open (thresholds.h).
  bool admits(const FamilyTest& test);
  /// Tests of all families beside them.
  const std::vector<FamilyTest>& tests();

 private:
  ModelState state_;
  std::set<std::size_t> left_out_;
  std::optional<std::vector<FamilyTest>> tests_;  ///< once they are asked for
};

}  // namespace volcal
