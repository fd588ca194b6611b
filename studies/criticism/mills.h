#pragma once
/// Mills with a B/C head of which the model knows the location errors of the head alone, diagnosed and
/// counted: which of the machine's own error functions come back, and which effects are named that are not
/// there.
///
/// Campaign i has seed `seed` + i: six to eight error functions, in every other a rack's period of X, read at
/// a sphere in 72 poses of B and C with 8 um of noise, by an R-test and by the contacts of a probe in turn.
/// The given model holds every error function and squareness at zero.

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/search_rules.h"

namespace volcal::studies {

/// What a diagnosis of a mill accepts.
struct DiagnosedMill {
  std::uint64_t seed = 0;
  std::vector<std::string> hidden;           ///< symbols of the error functions, and "rack"
  std::vector<std::string> found;            ///< of these
  std::vector<std::string> other_functions;  ///< symbols of error functions that the machine does not have
  std::vector<std::string> wrong_effects;  ///< labels of what is neither an error of the machine nor the rack
  double given_um = 0.0;    ///< root mean square of the prediction error at poses that were not measured
  double offered_um = 0.0;  ///< the same of the model that the diagnosis offers; 0: it cannot be fitted
  std::vector<std::string> without;  ///< names of rules that were left out
  double seconds = 0.0;              ///< of the diagnosis, by the clock
};

struct MillStudyOptions {
  int campaigns = 32;
  std::uint64_t seed = 1;
  int threads = 0;     ///< 0 = all; results do not depend on it
  std::string output;  ///< folder of finished campaigns; empty = none is kept
  bool resume = false;
  std::set<SearchRule> without;  ///< rules of the search that are left out
  std::function<void(int done, int all)> progress;
};

/// In the order of the campaigns. Throws InputError for a folder that holds campaigns of another seed or
/// other rules, or any without `resume`.
std::vector<DiagnosedMill> mill_study(const MillStudyOptions& options);

}  // namespace volcal::studies
