#include "volcal/identify/compensation/compensation_type.h"

#include <algorithm>
#include <cctype>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::array<CompensationTypeInfo, 5> kTypes = {{
    {CompensationPart::Positioning, "L-POS", "8.2.2",
     "EXX EYY EZZ, and EA EB EC as they act on the specific lines",
     "positioning of each linear axis along its specific line"},
    {CompensationPart::Straightness, "L-STR", "8.2.3",
     "EYX EZX EXY EZY EXZ EYZ, and EA EB EC as they act on the specific lines",
     "straightness of each linear axis along its specific line"},
    {CompensationPart::Squareness, "L-SQU", "8.2.4",
     "the three squarenesses, and EA EB EC as they act on the specific lines",
     "angles between the linear axes on their specific lines"},
    {CompensationPart::Angular, "L-ANG", "8.2.5", "EA EB EC of X, Y and Z",
     "what angular errors do away from the specific lines; needs the tool length"},
    {CompensationType::volumetric(), "L-VOL", "8.2.7", "all 21",
     "all of the others: the functional point anywhere in the volume; needs the tool length"},
}};

/// Types of Annex A that cannot be had by moving linear axes alone.
constexpr std::array<std::string_view, 10> kNotLinear = {"FOR",   "L-VOL+", "L-SPEC", "R-POS",  "R-RAX",
                                                         "R-POR", "R-ANG",  "R-VOL",  "R-VOL+", "R-SPEC"};

CompensationType one_type(const std::string& name) {
  const auto* const found = std::ranges::find(kTypes, name, &CompensationTypeInfo::name);
  if (found != kTypes.end()) return found->type;
  std::string names;
  for (const CompensationTypeInfo& info : kTypes)
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  const std::string remedy = "write one of " + names + ", or several joined by +";
  if (std::ranges::find(kNotLinear, name) != kNotLinear.end())
    throw InputError({},
                     "compensation type " + name +
                         " moves rotary axes or is special to one machine; "
                         "tables here correct by the linear axes alone",
                     remedy);
  throw InputError({}, "\"" + name + "\" is no compensation type of ISO/TR 16907, 8.2", remedy);
}

}  // namespace

CompensationType CompensationType::parse(std::string_view text) {
  std::string upper(text);
  std::ranges::transform(upper, upper.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  CompensationType type;
  for (std::size_t from = 0; from <= upper.size();) {
    std::size_t stop = upper.find('+', from);
    // the + of L-VOL+ and R-VOL+ belongs to the name
    if (stop != std::string::npos && (stop + 1 == upper.size() || upper[stop + 1] == '+')) ++stop;
    stop = std::min(stop, upper.size());
    type = type | one_type(upper.substr(from, stop - from));
    from = stop + 1;
  }
  return type;
}

std::string CompensationType::name() const {
  if (is_volumetric()) return "L-VOL";
  std::string text;
  for (const CompensationTypeInfo& info : kTypes) {
    if (info.type.is_volumetric() || !contains(info.type)) continue;
    text += (text.empty() ? "" : "+") + std::string(info.name);
  }
  return text;
}

std::span<const CompensationTypeInfo> compensation_types() { return kTypes; }

}  // namespace volcal
