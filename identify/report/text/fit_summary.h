#pragma once
/// What `volcal fit` prints: one page of text that says what was found, how well, and what was not.

#include <string>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// One sentence: how many parameters the readings alone determine, and what holds the rest.
std::string rank_text(const FitResult& result);

std::string fit_summary_text(const FitResult& result, const Campaign& campaign);

}  // namespace volcal
