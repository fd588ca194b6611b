#pragma once
/// Findings with the sentences that they are expected to make: one at least of every code.

#include <cstdint>
#include <string>
#include <vector>

#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {

using Texts = std::vector<std::string>;
using Integers = std::vector<std::int64_t>;
using Numbers = std::vector<FindingNumber>;

struct WordedFinding {
  Finding finding;
  std::string sentence;
};

std::vector<WordedFinding> examples_of_readings();
std::vector<WordedFinding> examples_of_fit();
std::vector<WordedFinding> examples_of_criticism();
std::vector<WordedFinding> examples_of_errors();

}  // namespace volcal
