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

std::string SettingText::in_words_of(const Wording& wording) const {
  std::string text;
  for (const auto& part : parts_) {
    const Setting* setting = std::get_if<Setting>(&part);
    text += setting != nullptr ? wording(setting->name) : std::get<std::string>(part);
  }
  return text;
}

std::string SettingText::as_options() const {
  return in_words_of([](const std::string& name) { return "--" + name; });
}

SettingText setting(std::string name) { return SettingText(SettingText::Setting{std::move(name)}); }

SettingText operator+(SettingText text, std::string_view further) {
  text.parts_.emplace_back(std::string(further));
  return text;
}

SettingText operator+(std::string_view first, SettingText text) {
  text.parts_.insert(text.parts_.begin(), std::string(first));
  return text;
}

InputError::InputError(SourcePlace place, const SettingText& problem, std::string remedy)
    : InputError(std::move(place), problem.as_options(), std::move(remedy)) {
  of_settings_ = problem;
}

InputError InputError::in_words_of(const SettingText::Wording& wording) const {
  return of_settings_ ? InputError(place_, of_settings_->in_words_of(wording), remedy_) : *this;
}

InputError::InputError(SourcePlace place, std::string problem, std::string remedy)
    : std::runtime_error(message(place, problem, remedy)),
      place_(std::move(place)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

}  // namespace volcal
