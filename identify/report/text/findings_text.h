#pragma once
/// Findings as warnings on the terminal.

#include <string>
#include <vector>

#include "volcal/identify/words/sentences.h"

namespace volcal {

/// One line each, "! SENTENCE"; empty without findings.
inline std::string findings_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const std::string& each : sentences(findings)) text += "! " + each + "\n";
  return text;
}

}  // namespace volcal
