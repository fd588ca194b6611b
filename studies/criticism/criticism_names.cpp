#include "volcal/studies/criticism/criticism_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>

#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal::studies {
namespace {

constexpr double kNotable = 0.5;  // component of a direction against its largest

class ExpectedDiagnosis {
 public:
  ExpectedDiagnosis(const sim::HiddenEffect& hidden, const Campaign& campaign)
      : hidden_(hidden), campaign_(campaign) {}

  RightAnswer answer() {
    name();
    drivers();
    directions();
    answer_.companions.insert({"x", "y", "z", "feed"});
    for (const Axis& axis : campaign_.machine.axes) {
      if (is_rotary(axis.name)) answer_.companions.insert(std::string(1, lower_letter_of(axis.name)));
    }
    for (const Tool& tool : campaign_.machine.tools) answer_.companions.insert("tool " + tool.name);
    either_of_two_tools();
    return std::move(answer_);
  }

 private:
  std::string text(const std::string& stem) const { return hidden_.options.text(stem).value_or(""); }
  bool has(const std::string& stem) const { return hidden_.options.has(stem); }
  bool is(std::initializer_list<const char*> kinds) const {
    return std::ranges::any_of(kinds, [&](const char* kind) { return hidden_.kind == kind; });
  }
  static std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
  }
  std::string own_axis() const { return lower(text("symbol").substr(2)); }
  /// A location error of a rotary axis, "EY0C": it moves as the constant of an error motion.
  bool is_of_rotary_axis() const {
    const auto location = LocationSymbol::parse(text("symbol"));
    return location && is_rotary(location->axis);
  }
  static std::string positioning(const std::string& axis) { return "E" + axis + axis; }
  /// Of the key `axes`, "X Y Z".
  std::vector<std::string> axes() const {
    std::istringstream words(text("axes"));
    return {std::istream_iterator<std::string>(words), {}};
  }
  std::string all_positioning() const {
    std::vector<std::string> symbols;
    for (const std::string& axis : axes()) symbols.push_back(positioning(axis));
    return fmt::format("{}", fmt::join(symbols, " "));
  }

  void set(const std::string& kind, const std::string& target, const std::string& driver,
           const std::string& shape = "") {
    const EffectKind* found = find_effect(kind);
    for (EffectSpec& spec : found->candidates(campaign_)) {
      const EffectName candidate = found->make(spec, {})->name();
      if (candidate.target.name() != target || (!driver.empty() && candidate.driver.name() != driver))
        continue;
      if (!shape.empty() && candidate.shape != shape) continue;
      for (const char* stem : {"period", "time_constant", "time", "length"}) {
        if (const auto value = hidden_.options.number(stem)) spec.options.set(stem, *value);
      }
      answer_.spec = spec;
      answer_.name = candidate;
    }
  }

  /// A candidate of the catalogue's if it holds the kind.
  void name() {
    name_drive();
    name_temperature();
    name_coupling();
    name_tool();
    name_instrument();
  }

  // One line per kind of sim/ that the catalogue holds.
  void name_drive() {
    const std::string symbol = text("symbol");
    if (is({"reversal"})) set("reversal", symbol, "");
    if (is({"common-reversal"})) set("common-reversal", all_positioning(), "");
    if (is({"reversal-position"})) set("position-reversal", symbol, "");
    if (is({"reversal-spike"})) set("pre-travel", symbol, "");
    if (is({"direction-temperature"}))
      set("thermal-reversal", symbol, "dir_" + own_axis() + " " + temperature());
    if (is({"screw-lead"})) set("lead-error", symbol, "");
    if (is({"encoder-subdivision"})) set("encoder-subdivision", symbol, "");
    if (is({"servo-mismatch"})) set("servo-mismatch", "XY", "");
    if (is({"worm"})) set("worm-error", symbol, "");
    if (is({"cradle-table"})) set("cradle-coupling", symbol, lower(text("by")), "sine");
  }

  void name_temperature() {
    const std::string symbol = text("symbol"), axis = text("axis"), channel = temperature();
    if (is({"screw-heating"})) set("screw-heating", positioning(axis), "");
    if (is({"common-growth"})) set("common-growth", all_positioning(), "");
    if (is({"common-expansion"})) set("common-expansion", all_positioning(), channel);
    if (is({"scale-expansion"})) set("scale-expansion", positioning(axis), channel);
    if (is({"thermal-tilt"}) && !has("by")) set("thermal-drift", symbol, channel);
    if (is({"lagged-temperature"}) && !has("by")) set("lagged-temperature", symbol, channel);
    if (is({"squareness-drift"})) set("squareness-drift", symbol, "time");
    if (is({"squareness-channel"}) && !is_of_rotary_axis()) set("squareness-drift", symbol, channel);
    if (is({"squareness-channel"}) && is_of_rotary_axis())
      set("thermal-drift", symbol.substr(0, 2) + symbol.back(), channel);
  }

  void name_coupling() {
    const std::string by = lower(text("by"));
    if (is({"cross-axis"})) set("axis-coupling", text("symbol"), by, power());
    if (is({"cross-product"})) name_product();
    if (is({"foundation-tilt"})) set("foundation-tilt", "machine about " + text("about"), by, power());
  }

  void name_product() {
    const std::string symbol = text("symbol"), by = lower(text("by")), with = lower(text("and"));
    const std::string first = std::min(by, with), second = std::max(by, with);
    // The catalogue holds a displacement once, under the first axis.
    const bool displacement = symbol[1] >= 'X';
    const std::string target =
        displacement ? symbol.substr(0, 2) + static_cast<char>(std::toupper(first[0])) : symbol;
    set("product-coupling", target, first + " " + second);
  }

  void name_tool() {
    const std::string tool = "tool " + text("tool");
    if (is({"tool-growth"}) && !has("tool")) set("spindle-growth", "tool", "");
    if (is({"tool-growth-channel"}) && !has("tool")) set("tool-expansion", "tool", temperature());
    if (is({"tool-load"}) && !has("by")) set("tool-load", text("symbol"), tool);
    if (is({"tool-offset"})) set("tool-offset", tool, "");
    if (is({"tool-clamping"})) set("tool-clamping", "clamping in " + text("setup"), "");
  }

  void name_instrument() {
    const std::string station = has("station") ? "station " + text("station") : "stations";
    const std::string lasers = has("station") ? station : "readings";
    const std::string readings = has("setup") ? "readings of " + text("setup") : lasers;
    if (is({"length-scale"}) && !has("setup")) set("length-scale", lasers, "");
    if (is({"dead-path-air"})) set("dead-path", readings, has("channel") ? temperature() : "time");
    if (is({"station-drift"})) set("station-drift", station, "");
    if (is({"station-event"})) set("station-event", station, "");
    if (is({"bar-length"})) set("ball-bar-length", "readings", "");
    if (is({"beam-cosine"})) set("beam-misalignment", readings, "");
    if (is({"encoder-eccentricity"})) {
      set("encoder-eccentricity", station, has("encoder") ? text("encoder") : "azimuth");
    }
  }

  std::string temperature() const { return "T_" + text("channel"); }
  std::string power() const {
    static const std::array<const char*, 3> kPowers = {"linear", "quadratic", "cubic"};
    const auto power = std::clamp<std::size_t>(
        static_cast<std::size_t>(hidden_.options.number("power").value_or(1.0)), 1, 3);
    return kPowers[power - 1];
  }

  void drivers() {
    std::set<std::string>& drivers = answer_.drivers;
    for (const char* stem : {"by", "and", "axis"}) {
      if (has(stem)) drivers.insert(lower(text(stem)));
    }
    for (const char* stem : {"channel", "minus"}) {
      if (has(stem)) drivers.insert("T_" + text(stem));
    }
    for (const std::string& axis : axes())
      drivers.insert(is({"common-reversal"}) ? "dir_" + lower(axis) : lower(axis));
    if (is({"common-growth"})) drivers.insert("time");
    if (has("station")) drivers.insert("station " + text("station"));
    if (has("tool")) drivers.insert("tool " + text("tool"));
    if (is({"reversal", "reversal-position", "backlash-kink", "reversal-spike", "direction-memory",
            "direction-temperature"})) {
      drivers.insert("dir_" + own_axis());
    }
    if (is({"screw-lead", "encoder-subdivision", "triangle-wave", "position-step", "local-bump", "worm",
            "cradle-table"})) {
      drivers.insert(own_axis());
    }
    if (is({"screw-heating", "tool-growth", "tool-growth-on-off", "squareness-drift", "station-drift",
            "station-event", "station-swing", "root-time", "heated-zone", "tool-clamping",
            "lagged-temperature"}) ||
        (is({"dead-path-air"}) && !has("channel"))) {
      drivers.insert("time");
    }
    if (is({"length-scale", "air-index"})) drivers.insert("length");
    if (is({"servo-mismatch"})) drivers.insert({"dir_x", "dir_y", "speed_x", "speed_y"});
    if (is({"bar-length"})) drivers.insert("instrument " + instrument_with_bar());
    if (is({"tool-clamping", "dead-path-air"})) add_setups();
  }

  /// Of two tools in use each says whether it is the other.
  void either_of_two_tools() {
    std::set<std::string> in_use;
    for (const Setup& setup : campaign_.setups)
      in_use.insert("tool " + campaign_.machine.tools[setup.tool].name);
    const bool is_driver =
        std::ranges::any_of(in_use, [&](const std::string& tool) { return answer_.drivers.contains(tool); });
    if (in_use.size() == 2 && is_driver) answer_.drivers.insert(in_use.begin(), in_use.end());
  }

  /// A setup shows as its station and tool.
  void add_setups() {
    for (const Setup& setup : campaign_.setups) {
      if (has("setup") && setup.name != text("setup")) continue;
      answer_.drivers.insert("tool " + campaign_.machine.tools[setup.tool].name);
      if (const auto station = setup.options.text("station")) answer_.drivers.insert("station " + *station);
    }
  }

  void add(int direction) { answer_.directions.insert(std::string(1, static_cast<char>('X' + direction))); }

  void directions() {
    if (is({"length-scale", "air-index", "dead-path-air", "bar-length"})) answer_.directions.insert("beam");
    if (is({"tool-growth", "tool-growth-channel", "tool-growth-on-off"}) && !has("direction")) add(2);
    if (const auto direction = hidden_.options.vector("direction")) {
      for (int k = 0; k < 3; ++k) {
        if (std::abs((*direction)[k]) >= kNotable * direction->cwiseAbs().maxCoeff()) add(k);
      }
    }
    if (is({"servo-mismatch"})) {  // in one plane the other axis may as well be early
      add(0);
      add(1);
    }
    for (const char* stem : {"axis", "about"}) {
      const std::string axis = lower(text(stem));
      if (axis.size() == 1) add_motion(stem == std::string("about"), axis[0] - 'x');
    }
    for (const std::string& axis : axes()) add(axis[0] - 'X');
    const std::string symbol = text("symbol");
    if (symbol.size() < 3) return;
    const bool rotation = symbol[1] >= 'A' && symbol[1] <= 'C';
    add_motion(rotation, symbol[1] - (rotation ? 'A' : 'X'));
  }

  void add_motion(bool rotation, int about) {
    for (int k = 0; k < 3; ++k) {
      if (rotation == (k != about)) add(k);
    }
  }

  const sim::HiddenEffect& hidden_;
  const Campaign& campaign_;
  RightAnswer answer_;
};

}  // namespace

RightAnswer right_answer(const sim::HiddenEffect& hidden, const Campaign& campaign) {
  return ExpectedDiagnosis(hidden, campaign).answer();
}

std::string text_of(const sim::HiddenEffect& hidden) {
  std::string text = hidden.kind;
  for (const auto& [key, value] : hidden.options.all()) {
    if (const auto* name = std::get_if<std::string>(&value)) text += " " + *name;
    if (const auto* number = std::get_if<double>(&value))
      text += fmt::format(" {}={:.4g}", key.first, *number);
  }
  return text;
}

}  // namespace volcal::studies
