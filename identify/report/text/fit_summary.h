#pragma once
/// What `volcal fit` prints.

#include <string>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// One sentence: how many parameters the readings alone determine, and what holds the rest.
std::string rank_text(const FitResult& result);

/// A dozen lines: what was found, how well, what was not, what to mind. Of a result that was read from files
/// without what needs residuals.
std::string fit_summary_text(const FitResult& result);

/// All of it: every error, setup, noise term, flagged reading and message.
std::string fit_text(const FitResult& result, const Campaign& campaign);

}  // namespace volcal
