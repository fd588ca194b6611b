#include "volcal/identify/criticism/data/effect_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr const char* kResolution = "resolution";
constexpr const char* kCommon = "common-";  // one cause in several places

constexpr auto kModelChanges = std::to_array<ModelChange>({
    {kLeftOut, "an error function or squareness that the model file switches off: give it back to the model"},
    {kResolution, "an error function that the readings ask to be finer: give it more knots"},
});

constexpr auto kTargets = std::to_array<EffectWord>({
    {"SYMBOL", "error motion of an axis (EXX, EAY), or a squareness (EC0Y)"},
    {"SYMBOL SYMBOL ...", "several error motions, all by the same amount", kCommon},
    {"tool", "offset of every tool, tool coordinates"},
    {"tool TOOL", "offset of one tool, tool coordinates"},
    {"clamping in SETUP", "offset of the tool that one setup carries, tool coordinates"},
    {"station STATION", "position of a station, workpiece coordinates, or all that is read from it"},
    {"stations", "positions of all stations, workpiece coordinates, or all that is read from them"},
    {"machine about AXIS", "rotation of the machine against the floor, about a workpiece axis"},
    {"readings", "readings of the instruments that the effect is about"},
    {"readings of SETUP", "readings of one setup"},
    {"PLANE", "readings of circles in this plane"},
});

constexpr auto kDrivers = std::to_array<EffectWord>({
    {"AXIS", "position of an axis"},
    {"AXIS AXIS", "positions of two axes"},
    {"AXIS AXIS AXIS", "positions of three axes"},
    {"dir_AXIS", "direction of approach of an axis"},
    {"dir_AXIS dir_AXIS ...", "directions of approach of several axes, each for its own error motion"},
    {"dir_AXIS AXIS", "direction of approach, and position, of an axis"},
    {"dir_AXIS travel", "direction of approach, and travel since the axis turned round"},
    {"dir_AXIS T_CHANNEL", "direction of approach of an axis, and temperature of a channel less 20 degC"},
    {"dir_AXIS feed", "velocity of an axis"},
    {"dir", "sense in which a circle is run through"},
    {"dir feed", "sense in which a circle is run through, and feed"},
    {"time", "time since the first reading of the campaign"},
    {"time AXIS", "time, and position of an axis"},
    {"time AXIS AXIS ...", "time, and position of each of several axes"},
    {"T_CHANNEL", "temperature of a channel less 20 degC"},
    {"rate of T_CHANNEL", "how fast the temperature of a channel changes"},
    {"length", "length that is measured"},
    {"azimuth", "azimuth of a tracker"},
    {"elevation", "elevation of a tracker"},
    {"tool", "which tool is carried: the one that the target names"},
    {"tool TOOL", "whether this tool is carried"},
    {"tool_length", "length of the tool that is carried"},
    {"setup", "whether the reading belongs to the setup that the target names"},
    {"run RUN", "whether the reading belongs to this run"},
    {"INSTRUMENT", "whether an instrument of this sort reads"},
});

/// In the order of Variable::Kind.
constexpr auto kScanMeanings = std::to_array<std::string_view>({
    "position of an axis",
    "direction of approach of an axis",
    "share of the feed along an axis, with its sign, of readings taken in motion",
    "time since the first reading of the campaign",
    "temperature of a channel",
    "length that is measured",
    "angle of the beam above the horizontal, at the nominal station",
    "number of the run",
    "feed rate",
    "whether the reading is of this instrument",
    "whether this tool is carried",
    "whether the reading was taken from this station",
});

constexpr auto kShapes = std::to_array<EffectWord>({
    {"step", "on or off, or a change of sign: constant either side"},
    {"linear", "proportional to the driver"},
    {"quadratic", "to its square"},
    {"cubic", "to its third power"},
    {"product", "to the product of its drivers"},
    {"square of the first", "to the square of the first driver and to the second"},
    {"square of the second", "to the first driver and to the square of the second"},
    {"growing wave", "sine and cosine of the driver, in proportion to it; the period is given or looked for"},
    {"periodic", "sine and cosine of the driver; the period is given or looked for"},
    {"sin(2 phi)", "twice per turn of a circle"},
    {"cos(phi)", "once per turn of a circle, most where the axis is fastest"},
    {"1-exp(-t/tau)", "towards a final value; the time constant is given or looked for"},
    {"exp(-s/l)", "less the further it has travelled; the length is given or looked for"},
    {"lag", "follows the driver late; the time constant is given or looked for"},
    {"function", "an error function of its own axis", kLeftOut},
    {"location", "the place or tilt of an axis of rotation", kLeftOut},
    {"sine", "with the sine of the tilt"},
    {"one-minus-cosine", "with one minus the cosine of the tilt"},
    {"squareness", "an angle between two axes", kLeftOut},
    {"finer", "an error function that needs more knots", kResolution},
});

std::span<const EffectWord> common_words(NamePart part) {
  switch (part) {
    case NamePart::Target:
      return kTargets;
    case NamePart::Driver:
      return kDrivers;
    case NamePart::Shape:
      break;
  }
  return kShapes;
}

}  // namespace

std::span<const ModelChange> model_change_kinds() { return kModelChanges; }

std::vector<MachineError> errors_given_back(const EffectSpec& spec) {
  std::vector<MachineError> errors;
  for (const std::string& word : words_in(spec.options.text("symbol").value_or("")))
    errors.push_back(MachineError::parse(word));
  return errors;
}

EffectName resolution_name(ErrorSymbol symbol) {
  return {kResolution, symbol, position_of(symbol.axis), "finer"};
}

std::vector<EffectWord> effect_words(NamePart part) {
  const auto common = common_words(part);
  std::vector<EffectWord> words(common.begin(), common.end());
  for (const EffectKind* kind : effect_kinds()) {
    const EffectSchema& schema = kind->schema();
    for (const NameWord& word : schema.words) {
      if (word.part == part) words.push_back({word.pattern, word.meaning, schema.kind});
    }
  }
  return words;
}

std::span<const EffectWord> scan_words() {
  static const std::vector<EffectWord> kScanWords = [] {
    std::vector<EffectWord> words;
    for (std::size_t kind = 0; kind < kScanMeanings.size(); ++kind)
      words.push_back({pattern_of(static_cast<Variable::Kind>(kind)), kScanMeanings[kind]});
    return words;
  }();
  return kScanWords;
}

int complexity_rank(const std::vector<Variable>& variables, ScanDirection direction) {
  const auto holds = [&](Variable::Kind kind) {
    return std::ranges::find(variables, kind, &Variable::kind) != variables.end();
  };
  const bool station = holds(Variable::Kind::Station), temperature = holds(Variable::Kind::Temperature),
             time = holds(Variable::Kind::Time), beam = direction == ScanDirection::Beam;
  if (variables.size() < 2) return beam && station ? 1 : 0;
  if (time && temperature) return 3;
  return (beam ? time : station && temperature) ? 2 : 1;
}

}  // namespace volcal
