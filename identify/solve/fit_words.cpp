#include "volcal/identify/solve/fit_words.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

/// The words stand in the order of the values.
template <class Value, std::size_t count>
Value value_of_word(const std::string& what, const std::string& word,
                    const std::array<std::string_view, count>& words) {
  const auto found = std::ranges::find(words, word);
  if (found == words.end()) {
    throw InputError({}, fmt::format("{} \"{}\" is not known", what, word),
                     fmt::format("choose one of {}", fmt::join(words, ", ")));
  }
  return static_cast<Value>(found - words.begin());
}

}  // namespace

OutlierPolicy outlier_policy(const std::string& word) {
  return value_of_word<OutlierPolicy>("outliers", word, kOutlierWords);
}

NoisePolicy noise_policy(const std::string& word) {
  return value_of_word<NoisePolicy>("noise", word, kNoiseWords);
}

RobustLoss robust_loss(const std::string& word) {
  return value_of_word<RobustLoss>("robust loss", word, kLossWords);
}

SolverKind solver_kind(const std::string& word) {
  return value_of_word<SolverKind>("solver", word, kSolverWords);
}

}  // namespace volcal
