#pragma once
/// Errors that a user can mend. Everything a file or a command line can get wrong ends in an `InputError`
/// (exit code 2), which names the place, what was expected and what to do.

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace volcal {

/// Where in a file something stands; `line` is 1-based, 0 when the whole file is meant.
struct SourcePlace {
  std::string file;
  int line = 0;
};

/// A sentence in which settings of the user are named by what they are: `setting("step") + " 0 is out of
/// range"`. Who talks to the user words them: the command line "--step", Python "step_mm".
class SettingText {
 public:
  /// How a setting is called, of its name.
  using Wording = std::function<std::string(const std::string& setting)>;

  friend SettingText setting(std::string name);
  friend SettingText operator+(SettingText text, std::string_view further);
  friend SettingText operator+(std::string_view first, SettingText text);

  std::string in_words_of(const Wording& wording) const;
  /// As options of the command line.
  std::string as_options() const;

 private:
  struct Setting {
    std::string name;
  };
  explicit SettingText(Setting setting) : parts_{std::move(setting)} {}

  std::vector<std::variant<std::string, Setting>> parts_;
};

/// Of its name on the command line without hyphens before it: "rotary-step".
SettingText setting(std::string name);
SettingText operator+(SettingText text, std::string_view further);
SettingText operator+(std::string_view first, SettingText text);

/// Bad input: `what()` reads "file:line: problem (remedy)".
class InputError : public std::runtime_error {
 public:
  InputError(SourcePlace place, std::string problem, std::string remedy);
  /// Of a setting; problem() and what() have it as an option of the command line.
  InputError(SourcePlace place, const SettingText& problem, std::string remedy);

  /// The same with the settings as another front end calls them.
  InputError in_words_of(const SettingText::Wording& wording) const;

  const SourcePlace& place() const { return place_; }
  const std::string& problem() const { return problem_; }
  const std::string& remedy() const { return remedy_; }

 private:
  SourcePlace place_;
  std::string problem_;
  std::string remedy_;
  std::optional<SettingText> of_settings_;  ///< problem_, where it names settings
};

}  // namespace volcal
