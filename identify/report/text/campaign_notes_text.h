#pragma once
/// What was noticed while a campaign was read (campaign_notes.h), for the terminal.

#include <string>
#include <vector>

namespace volcal {

/// One line each, "! SENTENCE"; empty without notes.
inline std::string campaign_notes_text(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += "! " + note + "\n";
  return text;
}

}  // namespace volcal
