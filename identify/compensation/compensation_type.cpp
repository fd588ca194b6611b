#include "volcal/identify/compensation/compensation_type.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using Part = CompensationPart;

constexpr CompensationType kLinearVolume = CompensationType::volumetric();
constexpr CompensationType kRotaryVolume = CompensationType::rotary_volumetric();

constexpr std::array<CompensationTypeInfo, 13> kTypes = {{
    {Part::Positioning, "L-POS", "8.2.2", "EXX EYY EZZ, and EA EB EC as they act on the specific lines",
     "positioning of each linear axis along its specific line"},
    {Part::Straightness, "L-STR", "8.2.3",
     "EYX EZX EXY EZY EXZ EYZ, and EA EB EC as they act on the specific lines",
     "straightness of each linear axis along its specific line"},
    {Part::Squareness, "L-SQU", "8.2.4",
     "the three squarenesses, and EA EB EC as they act on the specific lines",
     "angles between the linear axes on their specific lines"},
    {Part::Angular, "L-ANG", "8.2.5", "EA EB EC of X, Y and Z",
     "what angular errors do away from the specific lines; needs the tool length"},
    {kLinearVolume, "L-VOL", "8.2.7", "all 21",
     "L-POS to L-ANG: the functional point anywhere in the volume; needs the tool length"},
    {kLinearVolume | Part::Orientation, "L-VOL+", "8.2.8", "all 21",
     "L-VOL and FOR; needs two rotary axes and the tool length"},
    {Part::RotaryPositioning, "R-POS", "8.2.9", "EAA EBB ECC and zero positions EA0A EB0B EC0C",
     "positioning of each rotary axis, by the axis itself"},
    {Part::RotaryRadialAxial, "R-RAX", "8.2.10", "radial, axial and tilt error motions of rotary axes",
     "radial and axial error motion at one elevation over a table or one tool length"},
    {Part::RotaryLocation, "R-POR", "8.2.11", "location errors of rotary axes, as EX0C EY0C EA0C EB0C",
     "position and orientation of the axis average lines; needs the tool length"},
    {Part::RotaryAngular, "R-ANG", "8.2.12", "tilt error motions of rotary axes",
     "what tilt does away from the reference point of R-RAX; needs the tool length"},
    {kRotaryVolume, "R-VOL", "8.2.13", "all errors of rotary axes",
     "R-POS to R-ANG: the functional point at every rotary position; needs the tool length"},
    {kRotaryVolume | Part::Orientation, "R-VOL+", "8.2.14", "all errors of rotary axes",
     "R-VOL and FOR; needs two rotary axes and the tool length"},
    {Part::Orientation, "FOR", "8.2.6", "every error that turns the tool against the workpiece",
     "direction of the tool's axis, by two rotary axes; no table of a controller holds it"},
}};

constexpr std::array<std::string_view, 2> kOfOneMachine = {"L-SPEC", "R-SPEC"};

CompensationType one_type(const std::string& name) {
  const auto* const found = std::ranges::find(kTypes, name, &CompensationTypeInfo::name);
  if (found != kTypes.end()) return found->type;
  std::string names;
  for (const CompensationTypeInfo& info : kTypes)
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  const std::string remedy = "write one of " + names + ", or several joined by +";
  if (std::ranges::find(kOfOneMachine, name) != kOfOneMachine.end())
    throw InputError({},
                     "compensation type " + name +
                         " is special to one machine: its manufacturer says what it corrects (ISO/TR 16907, "
                         "8.2.15 and 8.2.16)",
                     remedy);
  throw InputError({}, "\"" + name + "\" is not a compensation type of ISO/TR 16907, 8.2", remedy);
}

/// Of the parts alone, L-VOL and R-VOL in place of theirs.
std::vector<std::string> names_of_parts(CompensationType type, const CompensationType& volume,
                                        std::string_view name_of_volume) {
  if (type == volume) return {std::string(name_of_volume)};
  std::vector<std::string> names;
  for (const CompensationTypeInfo& info : kTypes) {
    const bool of_several = info.type.contains(kLinearVolume) || info.type.contains(kRotaryVolume);
    if (!of_several && type.contains(info.type)) names.emplace_back(info.name);
  }
  return names;
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
    const bool of_name = stop != std::string::npos && upper.substr(from, stop - from).ends_with("-VOL") &&
                         (stop + 1 == upper.size() || upper[stop + 1] == '+');
    if (of_name) ++stop;
    stop = std::min(stop, upper.size());
    type = type | one_type(upper.substr(from, stop - from));
    from = stop + 1;
  }
  return type;
}

std::string CompensationType::name() const {
  const CompensationType orientation = Part::Orientation;
  const bool turns = contains(orientation);
  const CompensationType of_rotary(rotary().bits_ & kRotaryBits);
  std::vector<std::string> names = names_of_parts(linear(), kLinearVolume, "L-VOL");
  const std::vector<std::string> rotary_names = names_of_parts(of_rotary, kRotaryVolume, "R-VOL");
  names.insert(names.end(), rotary_names.begin(), rotary_names.end());
  const bool last_takes_it = of_rotary == kRotaryVolume || (of_rotary.empty() && linear() == kLinearVolume);
  if (turns && !last_takes_it) names.emplace_back("FOR");
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : "+") + name;
  return turns && last_takes_it ? text + "+" : text;
}

std::span<const CompensationTypeInfo> compensation_types() { return kTypes; }

}  // namespace volcal
