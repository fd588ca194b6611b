#include "volcal/identify/cli/provenance.h"

#include "volcal/identify/text/today.h"

namespace volcal::cli {
namespace {

std::string& command_line() {
  static std::string text;
  return text;
}

/// As a POSIX shell reads it back.
std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-+=./:,@%") == std::string::npos;
  if (plain) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

void remember_command_line(int count, char** arguments) {
  std::string& text = command_line();
  text = "volcal";
  for (int i = 1; i < count; ++i) text += " " + quoted(arguments[i]);
}

Provenance provenance() {
  return {.version = VOLCAL_VERSION, .date = present_time_text(), .command = command_line()};
}

ReportOptions report_options() { return {.date = today(), .provenance = provenance()}; }

}  // namespace volcal::cli
