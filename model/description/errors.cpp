#include "volcal/model/description/errors.h"

#include <utility>

namespace volcal {
namespace {

std::string message(const SourcePlace& place, const std::string& problem, const std::string& remedy) {
  std::string text = place.file;
  if (!text.empty() && place.line > 0) text += ":" + std::to_string(place.line);
  if (!text.empty()) text += ": ";
  text += problem;
  if (!remedy.empty()) text += " (" + remedy + ")";
  return text;
}

}  // namespace

InputError::InputError(SourcePlace place, std::string problem, std::string remedy)
    : std::runtime_error(message(place, problem, remedy)),
      place_(std::move(place)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

}  // namespace volcal
