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

constexpr const char* kWithoutIt =
    "leave the effect out of a copy of the model, or hide it in the study as a [[hidden]] effect";

/// In the unit that users write.
StateNumber value_of(const HiddenSettings& settings, const Variable& variable) {
  const double unit = variable.unit().si_per_unit;
  const Machine& machine = settings.machine();
  if (variable.has_axis() && !machine.has_axis(variable.axis))
    settings.fail(variable.written() + " is of no axis of this machine", "name one of its axes");
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
    case Variable::Kind::ToolLength:
      return [machine, unit](const MachineState& state) {
        return machine.tools[state.tool].offset.norm() / unit;
      };
    case Variable::Kind::ToolOffset:
      return [machine, unit, k = variable.component](const MachineState& state) {
        return machine.tools[state.tool].offset[k] / unit;
      };
    default:
      settings.fail("it depends on " + variable.written() + ", which the simulator does not know",
                    kWithoutIt);
  }
}

StateNumber value_of(const HiddenSettings& settings, const std::string& written) {
  const auto variable = Variable::parse_written(written);
  if (!variable) settings.fail("\"" + written + "\" is no variable", "write x, dir_x, T_air, t ...");
  return value_of(settings, *variable);
}

std::vector<StateNumber> values_of(const HiddenSettings& settings, const std::string& list) {
  std::vector<StateNumber> values;
  std::istringstream words(list);
  for (std::string word; words >> word;) values.push_back(value_of(settings, word));
  return values;
}

/// Adds what an effect is to its target: an error motion, "tool x", "tool NAME x" or "station NAME x".
void add_to_target(const HiddenSettings& settings, const StateNumber& value, HiddenScene& scene) {
  const std::string target = settings.text("target", "");
  if (const auto symbol = ErrorSymbol::parse(target)) {
    if (!settings.machine().has_axis(symbol->axis))
      settings.fail("\"" + target + "\" is no error motion of this machine", "name one of its axes");
    scene.machine.add_state_error(*symbol, value);
    return;
  }
  std::istringstream words(target);
  std::string what, owner, direction;
  words >> what;
  for (std::string word; words >> word;) {
    if (!direction.empty()) owner += (owner.empty() ? "" : " ") + direction;
    direction = word;
  }
  if ((what != "tool" && what != "station") || direction.size() != 1 || direction[0] < 'x' ||
      direction[0] > 'z')
    settings.fail("its target is \"" + target + "\", which is not simulated", kWithoutIt);
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(direction[0] - 'x');
  if (what == "tool") {
    std::optional<std::size_t> tool;
    if (!owner.empty()) {
      tool = settings.machine().tool_index(owner);
      if (!tool) settings.fail("there is no tool \"" + owner + "\"", "use a tool of the machine file");
    }
    const auto of_tool = [value, tool](const MachineState& state) {
      return !tool || state.tool == *tool ? value(state) : 0.0;
    };
    move_tool(along, of_tool, scene);
  } else {
    scene.interference.instrument.emplace_back(
        [along, value, here = settings.at_station(owner)](const Occasion& occasion, InstrumentTruth& truth) {
          if (here(occasion)) truth.station += along * value(occasion.state);
        });
  }
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
  const std::vector<double> numbers = settings.numbers(key);
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
  if (settings.has("only"))
    settings.fail("it acts on \"" + settings.text("only", "") + "\" only, which is not simulated",
                  kWithoutIt);
  add_to_target(settings, KnownSurface(settings), scene);
}

}  // namespace

std::vector<KnownKind> known_open_kinds() {
  return {{"custom", known_custom}, {"empirical", known_empirical}};
}

}  // namespace volcal::sim
