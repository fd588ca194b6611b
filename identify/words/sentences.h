#pragma once
/// Findings in words: one function per code, and no sentence of a finding anywhere else.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volcal/model/description/finding.h"

namespace volcal {

/// Throws std::invalid_argument where the finding lacks what its sentence says.
std::string sentence(const Finding& finding);
std::vector<std::string> sentences(const std::vector<Finding>& findings);

/// Why an error is not visible, and what to measure.
struct Explanation {
  std::string reason;
  std::string remedy;
};
/// Of a finding "rank.not-visible..."; empty without one.
Explanation explanation(const std::optional<Finding>& cause);

/// What a finding "model.contradicted" says of the residuals, without what to do.
std::string contradiction(const Finding& finding);

/// "a, b and c"
std::string list_in_words(const std::vector<std::string>& words);

struct SentenceMaker {
  FindingCode code;
  std::string (*make)(const Finding& finding);
};
/// All of them, one for every code.
std::vector<SentenceMaker> sentence_makers();

}  // namespace volcal
