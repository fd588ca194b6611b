#pragma once
/// What was noticed while a campaign was read (campaign_notes.h), for the terminal.

#include <string>
#include <vector>

#include "volcal/identify/words/sentences.h"

namespace volcal {

/// One line each, "! SENTENCE"; empty without notes.
inline std::string campaign_notes_text(const std::vector<Finding>& notes) {
  std::string text;
  for (const std::string& note : sentences(notes)) text += "! " + note + "\n";
  return text;
}

}  // namespace volcal
