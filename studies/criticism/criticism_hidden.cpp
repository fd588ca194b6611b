#include "volcal/studies/criticism/criticism_hidden.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "volcal/model/description/symbols.h"
#include "volcal/sim/measurement/measurements.h"

namespace volcal::studies {
namespace {

constexpr std::array<const char*, 3> kAxes = {"X", "Y", "Z"};
constexpr const char* kAtStation = " at a station";
constexpr const char* kEverywhere = " everywhere";

/// One cause in several places.
bool is_shared(const std::string& kind) { return kind.ends_with(kAtStation) || kind.ends_with(kEverywhere); }

class HiddenEffectGenerator {
 public:
  HiddenEffectGenerator(std::string kind, const sim::Study& study, sim::RandomStream& random)
      : kind_(std::move(kind)), study_(study), random_(random) {
    for (const sim::Measurement& measurement : study.measurements) {
      for (sim::SetupPlan& plan : sim::plan_setups(measurement, study.machine, study.seed)) {
        duration_ +=
            plan.seconds_per_reading * static_cast<double>(plan.points.size()) + study.pause_between_setups;
        plans_.push_back(std::move(plan));
      }
    }
  }

  sim::HiddenEffect draw() {
    effect_.kind = kind_.substr(0, kind_.find(' '));
    const bool grows = kind_.ends_with(" by");
    draw_target();
    draw_place();
    draw_shape();
    if (grows || is({"root-time", "gradient-bending", "temperature-squared"})) {
      if (grows || random_.uniform() < 0.5) set("by", other_axis());
    }
    return std::move(effect_);
  }

 private:
  bool is(std::initializer_list<const char*> kinds) const {
    return std::ranges::any_of(kinds, [&](const char* kind) { return effect_.kind == kind; });
  }
  void set(const std::string& stem, OptionValue value) { effect_.options.set(stem, std::move(value)); }
  template <class Values>
  auto one_of(const Values& values) {
    return values[static_cast<std::size_t>(random_.uniform() * static_cast<double>(std::size(values)))];
  }
  double logarithmic(double low, double high) { return low * std::pow(high / low, random_.uniform()); }
  Eigen::Vector3d direction() { return random_.normal_vector().normalized(); }
  const Axis& axis(const std::string& name) const { return study_.machine.axis(*axis_from_letter(name[0])); }
  double within(const std::string& name, double low, double high) {
    return axis(name).travel_min + axis(name).travel() * random_.uniform(low, high);
  }
  std::string channel() {
    const auto& channels = study_.environment.channels;
    return channels[static_cast<std::size_t>(random_.uniform() * static_cast<double>(channels.size()))].name;
  }
  std::string own_axis() const { return own_; }
  std::string other_axis() {
    std::string axis = one_of(kAxes);
    while (axis == own_) axis = one_of(kAxes);
    return axis;
  }
  /// Of the tracking setups.
  std::string station() {
    std::vector<std::string> names;
    for (const sim::SetupPlan& plan : plans_) {
      if (const auto name = plan.options.text("station")) names.push_back(*name);
    }
    return names.empty() ? "" : one_of(names);
  }

  void draw_target() {
    const bool any_motion = is({"reversal", "reversal-position", "cross-product", "backlash-kink",
                                "local-bump", "direction-memory", "direction-temperature"});
    const bool rotation_only =
        is({"cross-axis", "thermal-tilt", "tool-load", "triangle-wave", "cross-wave", "position-step",
            "cross-kink", "lagged-temperature", "root-time", "gradient-bending", "temperature-squared"});
    if (any_motion || rotation_only) {
      own_ = one_of(kAxes);
      static const std::string kMotions = "ABCXYZ";
      set("symbol",
          "E" +
              std::string(
                  1, kMotions[static_cast<std::size_t>(random_.uniform() * (rotation_only ? 3.0 : 6.0))]) +
              own_);
    }
    if (is({"screw-lead", "encoder-subdivision", "reversal-spike"})) {
      own_ = one_of(kAxes);
      set("symbol", "E" + own_ + own_);
    }
    if (is({"common-reversal", "common-expansion", "common-growth"})) set("axes", std::string("X Y Z"));
    if (is({"squareness-drift", "squareness-channel"})) {
      set("symbol", one_of(study_.machine.datum.squareness()).name());
    }
    if (is({"screw-heating", "scale-expansion", "heated-zone", "servo-mismatch"})) {
      own_ = effect_.kind == "servo-mismatch" ? kAxes[random_.uniform() < 0.5 ? 0 : 1] : one_of(kAxes);
      set("axis", own_);
    }
    if (is({"tool-load", "tool-offset"})) set("tool", study_.machine.tools[one_of(plans_).tool].name);
    if (is({"tool-growth", "tool-growth-channel", "tool-growth-on-off", "tool-offset", "station-drift",
            "station-event", "station-swing", "station-expansion", "tool-clamping"})) {
      set("direction", direction());
    }
  }

  void draw_place() {
    if (kind_.ends_with(kAtStation)) set("station", station());
    if (!is_shared(kind_) && is({"station-drift", "station-event", "station-swing", "station-expansion"}))
      set("station", station());
    if (is({"tool-clamping"})) set("setup", one_of(plans_).name);
    if (is({"length-scale"}) && random_.uniform() < 0.5) set("station", station());
    if (is({"dead-path-air"})) {
      if (!is_shared(kind_)) set("setup", one_of(plans_).name);
      set("dead_path", 0.3);
      if (random_.uniform() < 0.7) set("channel", channel());
    }
    if (is({"scale-expansion", "common-expansion", "tool-growth-channel", "thermal-tilt",
            "squareness-channel", "air-index", "lagged-temperature", "direction-temperature",
            "gradient-bending", "temperature-squared", "station-expansion"})) {
      set("channel", channel());
    }
    if (is({"gradient-bending"})) {
      const std::string first = *effect_.options.text("channel");
      std::string second = channel();
      while (second == first) second = channel();
      set("minus", second);
    }
  }

  void draw_shape() {
    const double turn = 2.0 * std::numbers::pi;
    if (is({"screw-lead"})) {
      set("period", logarithmic(5e-3, 40e-3));
      set("phase", random_.uniform(0.0, turn));
    }
    if (is({"encoder-subdivision"})) {
      set("period", one_of(std::array{20e-6, 40e-6, 100e-6, 200e-6, 500e-6, 1e-3, 2e-3}));
      set("phase", random_.uniform(0.0, turn));
    }
    if (is({"screw-heating", "common-growth", "tool-growth", "heated-zone", "tool-growth-on-off"})) {
      set("time_constant", logarithmic(600.0, 7200.0));
    }
    if (is({"tool-growth-on-off"})) set("off", duration_ * random_.uniform(0.3, 0.6));
    if (is({"lagged-temperature"})) set("time_constant", logarithmic(1200.0, 7200.0));
    if (is({"cross-axis"})) {
      set("by", other_axis());
      set("power", 1.0 + std::floor(3.0 * random_.uniform()));
    }
    if (is({"cross-product"})) {
      const auto skipped = static_cast<std::size_t>(3.0 * random_.uniform());
      set("by", std::string(kAxes[(skipped + 1) % 3]));
      set("and", std::string(kAxes[(skipped + 2) % 3]));
    }
    if (is({"station-event"})) set("time", duration_ * random_.uniform(0.1, 0.9));
    if (is({"station-swing"})) {
      set("period", logarithmic(0.15, 0.6) * duration_);
      set("phase", random_.uniform(0.0, turn));
    }
    draw_position_shape();
  }

  void draw_position_shape() {
    const double turn = 2.0 * std::numbers::pi;
    if (is({"triangle-wave", "position-step", "cross-wave", "cross-kink", "local-bump"}))
      set("by", other_axis());
    const std::string by = effect_.options.text("by").value_or(own_);
    if (is({"triangle-wave", "cross-wave"})) {
      set("period", axis(by).travel() * random_.uniform(0.3, 0.9));
      set("phase", random_.uniform(0.0, turn));
    }
    if (is({"position-step", "cross-kink"})) set("position", within(by, 0.3, 0.7));
    if (is({"backlash-kink"})) set("position", within(own_, 0.3, 0.7));
    if (is({"local-bump"})) {
      set("centre", within(own_, 0.2, 0.8));
      set("width", axis(own_).travel() * random_.uniform(0.1, 0.25));
      set("by_centre", within(by, 0.2, 0.8));
      set("by_width", axis(by).travel() * random_.uniform(0.1, 0.25));
    }
    if (is({"reversal-spike", "direction-memory"}))
      set("length", axis(own_).travel() * random_.uniform(0.05, 0.3));
    if (is({"heated-zone"})) {
      set("centre", within(own_, 0.2, 0.8));
      set("width", axis(own_).travel() * random_.uniform(0.1, 0.25));
    }
    if (is({"foundation-tilt"})) {
      set("by", std::string(one_of(kAxes)));
      set("about", std::string(1, "xyz"[static_cast<std::size_t>(3.0 * random_.uniform())]));
      set("power", 1.0 + std::floor(2.0 * random_.uniform()));
    }
  }

  std::string kind_;
  const sim::Study& study_;
  sim::RandomStream& random_;
  std::vector<sim::SetupPlan> plans_;
  double duration_ = 0.0;
  sim::HiddenEffect effect_;
  std::string own_;
};

const std::vector<std::pair<std::string, std::string>>& listed() {
  static const std::vector<std::pair<std::string, std::string>> kListed = {
      {"reversal", "reversal"},
      {"cross-axis", "axis-coupling"},
      {"scale-expansion", "scale-expansion"},
      {"station-drift", "station-drift"},
      {"screw-lead", "lead-error"},
      {"tool-offset", "tool-offset"},
      {"thermal-tilt", "thermal-drift"},
      {"length-scale", "length-scale"},
      {"reversal-position", "position-reversal"},
      {"cross-product", "product-coupling"},
      {"tool-growth", "spindle-growth"},
      {"dead-path-air", "dead-path"},
      {"encoder-subdivision", "encoder-subdivision"},
      {"tool-load", "tool-load"},
      {"squareness-drift", "squareness-drift"},
      {"station-event", "station-event"},
      {"screw-heating", "screw-heating"},
      {"bar-length", "ball-bar-length"},
      {"tool-growth-channel", "tool-expansion"},
      {"servo-mismatch", "servo-mismatch"},
      {"lagged-temperature", "lagged-temperature"},
      {"squareness-channel", "squareness-drift"},
      {"foundation-tilt", "foundation-tilt"},
      {"tool-clamping", "tool-clamping"},
      {"direction-temperature", "thermal-reversal"},
      {"reversal-spike", "pre-travel"}};
  return kListed;
}

}  // namespace

std::span<const std::string> listed_kinds() {
  static const std::vector<std::string> kKinds = [] {
    std::vector<std::string> kinds;
    for (const auto& [hidden, known] : listed()) kinds.push_back(hidden);
    return kinds;
  }();
  return kKinds;
}

std::span<const std::string> unlisted_kinds() {
  static const std::vector<std::string> kKinds = {
      "tool-growth-on-off", "air-index",     "station-swing",    "station-expansion",
      "backlash-kink",      "triangle-wave", "cross-wave",       "local-bump",
      "position-step",      "cross-kink",    "direction-memory", "lagged-temperature by",
      "root-time",          "heated-zone",   "gradient-bending", "temperature-squared",
      "thermal-tilt by",    "tool-load by"};
  return kKinds;
}

std::span<const std::string> shared_kinds() {
  static const std::vector<std::string> kKinds = {std::string("dead-path-air") + kAtStation,
                                                  std::string("dead-path-air") + kEverywhere,
                                                  std::string("station-drift") + kEverywhere};
  return kKinds;
}

std::span<const std::string> kinds_over_axes() {
  static const std::vector<std::string> kKinds = {"common-reversal", "common-expansion", "common-growth"};
  return kKinds;
}

std::string catalogue_kind(const std::string& hidden_kind) {
  for (const auto& [hidden, known] : listed()) {
    if (hidden == hidden_kind) return known;
  }
  throw std::invalid_argument("not in the catalogue: " + hidden_kind);
}

sim::HiddenEffect random_effect(const std::string& kind, const sim::Study& study, sim::RandomStream& random) {
  return HiddenEffectGenerator(kind, study, random).draw();
}

sim::HiddenEffect first_of_kind(const std::string& kind, const sim::Study& study) {
  sim::HiddenEffect effect;
  effect.kind = kind;
  if (kind == "reversal") effect.options.set("symbol", std::string("EXX"));
  if (kind == "squareness-drift") {
    effect.options.set("symbol", study.machine.datum.squareness().front().name());
  }
  if (kind == "scale-expansion") {
    effect.options.set("axis", std::string("X"));
    effect.options.set("channel", study.environment.channels.front().name);
  }
  return effect;
}

}  // namespace volcal::studies
