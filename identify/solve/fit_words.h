#pragma once
/// Options of a fit by the words that a user knows them by.

#include <array>
#include <string>
#include <string_view>

#include "volcal/identify/solve/fit.h"

namespace volcal {

inline constexpr std::array<std::string_view, 2> kOutlierWords = {"list", "remove"};
inline constexpr std::array<std::string_view, 2> kNoiseWords = {"auto", "white"};
inline constexpr std::array<std::string_view, 3> kLossWords = {"none", "huber", "cauchy"};
inline constexpr std::array<std::string_view, 2> kSolverWords = {"compressed", "per-reading"};

/// Of the words above. Throws InputError for another.
OutlierPolicy outlier_policy(const std::string& word);
NoisePolicy noise_policy(const std::string& word);
RobustLoss robust_loss(const std::string& word);
SolverKind solver_kind(const std::string& word);

}  // namespace volcal
