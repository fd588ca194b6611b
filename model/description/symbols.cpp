#include "volcal/model/description/symbols.h"

namespace volcal {
namespace {

constexpr std::string_view kLetters = "XYZABCUVW";
constexpr std::string_view kLowerLetters = "xyzabcuvw";
constexpr std::string_view kComponentLetters = "XYZABC";

}  // namespace

char letter_of(AxisName axis) { return kLetters[index_of(axis)]; }
char lower_letter_of(AxisName axis) { return kLowerLetters[index_of(axis)]; }
std::string letters_of(const std::vector<AxisName>& axes) {
  std::string letters;
  for (const AxisName axis : axes) letters += letter_of(axis);
  return letters;
}

std::optional<AxisName> axis_from_letter(char letter) {
  const auto position = kLetters.find(letter);
  if (position == std::string_view::npos) return std::nullopt;
  return kAllAxes[position];
}

std::string ErrorSymbol::name() const {
  return {'E', kComponentLetters[index_of(component)], letter_of(axis)};
}

std::optional<ErrorSymbol> ErrorSymbol::parse(std::string_view name) {
  if (name.size() != 3 || name[0] != 'E') return std::nullopt;
  const auto component = kComponentLetters.find(name[1]);
  const auto axis = axis_from_letter(name[2]);
  if (component == std::string_view::npos || !axis) return std::nullopt;
  return ErrorSymbol{kAllComponents[component], *axis};
}

std::string LocationSymbol::name() const {
  return {'E', kComponentLetters[index_of(component)], '0', letter_of(axis)};
}

std::optional<LocationSymbol> LocationSymbol::parse(std::string_view name) {
  if (name.size() != 4 || name[0] != 'E' || name[2] != '0') return std::nullopt;
  const auto component = kComponentLetters.find(name[1]);
  const auto axis = axis_from_letter(name[3]);
  if (component == std::string_view::npos || !axis) return std::nullopt;
  return LocationSymbol{kAllComponents[component], *axis};
}

std::string_view edge_unit(Component component) { return is_rotation(component) ? "urad" : "um"; }

}  // namespace volcal
