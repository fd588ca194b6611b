// Effects without a formula of their own: what a user wrote, and surfaces.
#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/sim/known/known_kinds.h"
#include "volcal/sim/known/known_spline.h"

namespace volcal::sim {
namespace {

/// In the unit that users write.
StateNumber value_of(const HiddenSettings& settings, const Variable& variable) {
  const double unit = variable.unit().si_per_unit;
  const Machine& machine = settings.machine();
  if (variable.has_axis() && !machine.has_axis(variable.axis))
    settings.fail(variable.written() + " is of an axis that this machine does not have",
                  "name one of its axes");
  switch (variable.kind) {
    case Variable::Kind::Position:
      return
          [k = index_of(variable.axis), unit](const MachineState& state) { return state.position[k] / unit; };
    case Variable::Kind::Direction:
      return approach_of(variable.axis);
    case Variable::Kind::Time:
      return [unit](const MachineState& state) { return state.time / unit; };
    case Variable::Kind::Temperature:
      return settings.written_temperature(variable.written());
    case Variable::Kind::TravelSinceTurning:
      return [k = index_of(variable.axis), unit](const MachineState& state) {
        return std::min(state.since_reversal[k], state.farthest[k]) / unit;
      };
    case Variable::Kind::Feed:
      return [unit](const MachineState& state) { return state.feed() / unit; };
    case Variable::Kind::Length:
      return [unit](const MachineState& state) { return state.length / unit; };
    case Variable::Kind::ToolLength:
      return [machine, unit](const MachineState& state) {
        return machine.tools[state.tool].offset.norm() / unit;
      };
    case Variable::Kind::ToolOffset:
      return [machine, unit, k = variable.component](const MachineState& state) {
        return machine.tools[state.tool].offset[k] / unit;
      };
    default:
      settings.fail(
          "it depends on " + variable.written() + ", which the simulator does not know",
          "leave the effect out of a copy of the model, or hide it in the study as a [[hidden]] effect");
  }
}

StateNumber value_of(const HiddenSettings& settings, const std::string& written) {
  const auto variable = Variable::parse_written(written);
  if (!variable) settings.fail("\"" + written + "\" is not a variable", "write x, dir_x, T_air, t ...");
  return value_of(settings, *variable);
}

std::vector<StateNumber> values_of(const HiddenSettings& settings, const std::string& list) {
  std::vector<StateNumber> values;
  std::istringstream words(list);
  for (std::string word; words >> word;) values.push_back(value_of(settings, word));
  return values;
}

/// Words of a text but the last one, and that one.
std::pair<std::string, std::string> split_last(const std::string& text) {
  const std::size_t space = text.rfind(' ');
  return space == std::string::npos ? std::pair{std::string(), text}
                                    : std::pair{text.substr(0, space), text.substr(space + 1)};
}

std::size_t tool_named(const HiddenSettings& settings, const std::string& name) {
  const auto tool = settings.machine().tool_index(name);
  if (!tool) settings.fail("there is no tool \"" + name + "\"", "use a tool of the machine file");
  return *tool;
}

/// Where the key `only` has it: "tool NAME", "station NAME" or "setup NAME"; everywhere without it.
StateNumber only_where_told(const HiddenSettings& settings, const StateNumber& value) {
  const std::string only = settings.text("only", "");
  if (only.empty()) return value;
  const std::size_t space = only.find(' ');
  const std::string what = only.substr(0, space);
  const std::string name = space == std::string::npos ? "" : only.substr(space + 1);
  if (what == "tool") {
    return [value, tool = tool_named(settings, name)](const MachineState& state) {
      return state.tool == tool ? value(state) : 0.0;
    };
  }
  if (what == "station") {
    settings.at_station(name);
    return [value, name](const MachineState& state) { return state.station == name ? value(state) : 0.0; };
  }
  if (what != "setup")
    settings.fail("only = \"" + only + "\" is not a part of a campaign",
                  "write \"tool NAME\", \"station NAME\" or \"setup NAME\"");
  settings.at_setup(name);
  return [value, name](const MachineState& state) { return state.setup == name ? value(state) : 0.0; };
}

void move_tool_along(const HiddenSettings& settings, const std::string& owner, const Eigen::Vector3d& along,
                     const StateNumber& value, HiddenScene& scene) {
  if (owner.empty()) return move_tool(along, value, scene);
  move_tool(
      along,
      [value, tool = tool_named(settings, owner)](const MachineState& state) {
        return state.tool == tool ? value(state) : 0.0;
      },
      scene);
}

/// Of a column of readings, "length_mm", or of that of one setup, "azimuth_deg of P1".
void add_to_readings(const HiddenSettings& settings, const std::string& target, const StateNumber& value,
                     HiddenScene& scene) {
  const std::size_t of = target.find(" of ");
  const std::string column = target.substr(0, of);
  const std::string setup = of == std::string::npos ? "" : target.substr(of + 4);
  scene.interference.reading.emplace_back(
      [value, here = settings.of_column(column, setup)](const Occasion& occasion, std::size_t channel,
                                                        double /*undisturbed*/) {
        return here(occasion, channel) ? value(occasion.state) : 0.0;
      });
}

/// Adds what an effect is to its target: an error motion, "tool x", "tool NAME x", "station NAME x" or a
/// column of readings.
void add_to_target(const HiddenSettings& settings, const StateNumber& everywhere, HiddenScene& scene) {
  const StateNumber value = only_where_told(settings, everywhere);
  const std::string target = settings.text("target", "");
  if (const auto symbol = ErrorSymbol::parse(target)) {
    if (!settings.machine().has_axis(symbol->axis))
      settings.fail("\"" + target + "\" is not an error motion of this machine", "name one of its axes");
    scene.machine.add_state_error(*symbol, value);
    return;
  }
  const auto [whose, direction] = split_last(target);
  const std::string what = whose.substr(0, whose.find(' '));
  if ((what != "tool" && what != "station") || direction.size() != 1 || direction[0] < 'x' ||
      direction[0] > 'z')
    return add_to_readings(settings, target, value, scene);
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(direction[0] - 'x');
  const std::string owner = whose.size() > what.size() ? whose.substr(what.size() + 1) : "";
  if (what == "tool") return move_tool_along(settings, owner, along, value, scene);
  scene.interference.instrument.emplace_back(
      [along, value, here = settings.at_station(owner)](const Occasion& occasion, InstrumentTruth& truth) {
        if (here(occasion)) truth.station += along * value(occasion.state);
      });
}

/// A formula of muParser. Copies share its numbers, one after another.
class KnownFormula {
 public:
  explicit KnownFormula(const HiddenSettings& settings)
      : numbers_(std::make_shared<Numbers>()),
        not_finite_(settings.error("its expression is not finite at a pose of the study",
                                   "write it so that it has a value everywhere, as in sqrt(max(0, z))")) {
    mu::Parser& parser = numbers_->parser;
    parser.DefineConst("pi", std::numbers::pi);
    try {
      parser.SetExpr(settings.text("expression", ""));
      const auto used = parser.GetUsedVar();
      numbers_->values.reserve(used.size());
      for (const auto& [name, unused] : used) {
        numbers_->values.push_back(0.0);
        parser.DefineVar(name, &numbers_->values.back());
        drivers_.push_back(driver(settings, name));
      }
      parser.Eval();
    } catch (const mu::ParserError& error) {
      settings.fail("its expression: " + error.GetMsg(), "write it as volcal fit takes it");
    }
  }

  double operator()(const MachineState& state) const {
    const std::scoped_lock lock(numbers_->mutex);
    for (std::size_t i = 0; i < drivers_.size(); ++i) numbers_->values[i] = drivers_[i](state);
    const double value = numbers_->parser.Eval();
    if (!std::isfinite(value)) throw InputError(not_finite_);
    return value;
  }

 private:
  struct Numbers {
    std::mutex mutex;
    mu::Parser parser;
    std::vector<double> values;
  };

  static StateNumber driver(const HiddenSettings& settings, const std::string& name) {
    if (name != "p" && name != "q") return value_of(settings, name);
    return [value = settings.number(name)](const MachineState& /*state*/) { return value; };
  }

  std::shared_ptr<Numbers> numbers_;
  InputError not_finite_;
  std::vector<StateNumber> drivers_;
};

void known_custom(const HiddenSettings& settings, HiddenScene& scene) {
  add_to_target(
      settings,
      [a = amplitude_of(settings), formula = KnownFormula(settings)](const MachineState& state) {
        return a * formula(state);
      },
      scene);
}

/// One variable of a surface, in equal pieces of cubic splines.
struct KnownSide {
  StateNumber driver;
  double from = 0.0, to = 1.0;
  int pieces = 1;

  std::size_t size() const { return static_cast<std::size_t>(pieces) + 3; }
  /// Of what is beyond, half a cosine over one piece.
  double presence(double at) const {
    const double beyond = std::max({0.0, from - at, at - to}) * pieces / (to - from);
    return beyond >= 1.0 ? 0.0 : 0.5 * (1.0 + std::cos(std::numbers::pi * beyond));
  }
  double value(double at, const std::vector<double>& coefficients) const {
    constexpr int kCubic = 3;
    const KnownSpline spline(kCubic, equal_pieces(from, to, pieces), coefficients);
    return spline(std::clamp(at, from, to));
  }
};

std::vector<double> numbers_of(const HiddenSettings& settings, const std::string& key, std::size_t count) {
  std::vector<double> numbers = settings.numbers(key);
  if (numbers.size() != count)
    settings.fail(
        key + " has " + std::to_string(numbers.size()) + " numbers, " + std::to_string(count) + " are needed",
        "write it as volcal fit leaves it in identified.toml");
  return numbers;
}

/// Of one to three variables; coefficients of the last one stand next to each other.
class KnownSurface {
 public:
  explicit KnownSurface(const HiddenSettings& settings)
      : factors_(values_of(settings, settings.text("factor", ""))) {
    const std::vector<StateNumber> drivers = values_of(settings, settings.text("drivers", ""));
    if (drivers.empty()) settings.fail("it has no drivers", "write drivers = \"y z\"");
    const auto from = numbers_of(settings, "from", drivers.size());
    const auto to = numbers_of(settings, "to", drivers.size());
    const auto pieces = numbers_of(settings, "pieces", drivers.size());
    std::size_t size = 1;
    for (std::size_t i = 0; i < drivers.size(); ++i) {
      sides_.push_back({drivers[i], from[i], to[i], static_cast<int>(pieces[i])});
      size *= sides_.back().size();
    }
    coefficients_ = numbers_of(settings, "coefficients", size);
  }

  double operator()(const MachineState& state) const {
    double share = 1.0;
    for (const StateNumber& factor : factors_) share *= factor(state);
    std::vector<double> values = coefficients_;
    for (std::size_t i = sides_.size(); i-- > 0;) {  // the last one first
      const KnownSide& side = sides_[i];
      const double at = side.driver(state);
      share *= side.presence(at);
      std::vector<double> along;
      for (auto first = values.begin(); first != values.end();
           first += static_cast<std::ptrdiff_t>(side.size()))
        along.push_back(side.value(at, {first, first + static_cast<std::ptrdiff_t>(side.size())}));
      values = std::move(along);
    }
    return share * values.front();
  }

 private:
  std::vector<StateNumber> factors_;
  std::vector<KnownSide> sides_;
  std::vector<double> coefficients_;
};

void known_empirical(const HiddenSettings& settings, HiddenScene& scene) {
  add_to_target(settings, KnownSurface(settings), scene);
}

}  // namespace

std::vector<KnownKind> known_open_kinds() {
  return {{"custom", known_custom}, {"empirical", known_empirical}};
}

}  // namespace volcal::sim
