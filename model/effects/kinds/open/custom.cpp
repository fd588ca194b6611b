// What a user writes: a target and a formula of what was recorded, its amplitude unknown.
#include "volcal/model/effects/kinds/open/custom.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/recorded_variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/written_target.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr const char* kCustom = "custom";
constexpr std::array<const char*, 2> kParameters = {"p", "q"};

std::string shortened(const std::string& text) {
  constexpr std::size_t kShown = 200;  // characters
  return text.size() > kShown ? text.substr(0, kShown) + " ..." : text;
}

bool is_parameter(const std::string& name) {
  return std::ranges::find(kParameters, name) != kParameters.end();
}

class CustomFormula {
 public:
  explicit CustomFormula(const EffectTable& table)
      : place_(table.place), target_(written_target(table)), expression_(expression_of(table)) {
    for (const std::string& name : expression_.variables()) {
      if (is_parameter(name)) {
        parameters_.push_back(name);
      } else {
        variables_.push_back(*Variable::parse_written(name));
      }
    }
    if (variables_.empty()) table.fail("its expression depends on nothing", "write a variable into it");
    for (const std::string parameter : kParameters) check_parameter(table, parameter);
  }

  const WrittenTarget& target() const { return target_; }
  const Expression& expression() const { return expression_; }
  /// Those that were recorded, without the parameters of the shape.
  const std::vector<Variable>& variables() const { return variables_; }
  const std::vector<std::string>& parameters() const { return parameters_; }

  void check(const Campaign& campaign) const {
    at_its_place({}, [&] { target_.check(campaign, what(), place_); });
    for (const Variable& variable : variables_) {
      const std::string name = variable.written();
      at_its_place(expression_.character_of(name), [&] {
        check_variable(
            campaign, variable, [&](const Setup& setup) { return acts_on(campaign, setup); }, what(),
            "the expression uses " + name, place_);
      });
    }
  }

  bool acts_on(const Campaign& campaign, const Setup& setup) const {
    return target_.acts_on(campaign, setup);
  }

  bool all_recorded(const Setup& setup) const {
    return std::ranges::all_of(variables_, [&](const Variable& each) { return has_variable(setup, each); });
  }

  /// Throws InputError where the expression is not finite.
  Eigen::VectorXd values(const SetupView& view, const Eigen::VectorXd& shape) const {
    const auto rows = static_cast<Eigen::Index>(view.rows());
    const bool measured = view.length.size() == rows || !expression_.uses("length");
    if (!acts_on(view.campaign, view.setup) || !all_recorded(view.setup) || !measured)
      return Eigen::VectorXd::Zero(rows);
    const auto& names = expression_.variables();
    Eigen::MatrixXd columns(rows, static_cast<Eigen::Index>(names.size()));
    auto variable = variables_.begin();
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto parameter = std::ranges::find(parameters_, names[k]);
      columns.col(static_cast<Eigen::Index>(k)) =
          parameter == parameters_.end()
              ? *recorded_variable(view, *variable++)
              : Eigen::VectorXd(Eigen::VectorXd::Constant(rows, shape[parameter - parameters_.begin()]));
    }
    Eigen::VectorXd result = expression_.evaluate(columns);
    for (Eigen::Index row = 0; row < rows; ++row) {
      if (!std::isfinite(result[row])) fail_not_finite(view, names, columns, row);
    }
    return result;
  }

 private:
  static Expression expression_of(const EffectTable& table) {
    const std::string text = table.text("expression", "add expression = \"z * (T_column - 20)\"");
    try {
      return custom_expression(text);
    } catch (const ExpressionError& error) {
      table.fail("the expression \"" + shortened(text) + "\": " + error.what(), custom_expression_names());
    }
  }

  template <class Check>
  void at_its_place(std::optional<std::size_t> character, const Check& check) const {
    try {
      check();
    } catch (const InputError& error) {
      throw CustomEffectError(error, expression_.text(), character);
    }
  }

  void check_parameter(const EffectTable& table, const std::string& name) const {
    const bool used = expression_.uses(name), given = table.spec.options.number(name).has_value();
    if (used && !given)
      table.fail("its expression uses " + name + ", which has no value", "add " + name + " = 1.0");
    if (!used && (given || table.spec.options.number(name + "_sigma"))) {
      table.fail("its expression does not use " + name, "remove " + name + " and " + name + "_sigma");
    }
  }

  std::string what() const { return "custom effect \"" + expression_.text() + "\""; }

  /// The line of a reading; without readings, as in tables, the pose.
  static std::string place_of(const SetupView& view, std::size_t row) {
    const Setup& setup = view.setup;
    if (setup.data.empty() && setup.name.empty()) return "the pose" + pose_text(view, row);
    const std::string where = setup.data.empty() ? "setup " + setup.name : setup.data;
    return where + ", line " + std::to_string(setup.readings.source_line[row]);
  }

  /// " X10 mm Y0 mm B-30 deg"
  static std::string pose_text(const SetupView& view, std::size_t row) {
    std::ostringstream text;
    for (const Axis& axis : view.campaign.machine.axes) {
      const Unit unit = position_unit(axis.name);
      const double value = view.setup.readings.position[index_of(axis.name)][row] / unit.si_per_unit;
      text << ' ' << letter_of(axis.name) << value << ' ' << unit.suffix;
    }
    return text.str();
  }

  [[noreturn]] void fail_not_finite(const SetupView& view, const std::vector<std::string>& names,
                                    const Eigen::MatrixXd& columns, Eigen::Index row) const {
    std::string at;
    for (std::size_t k = 0; k < names.size(); ++k) {
      at +=
          (k > 0 ? ", " : "") + names[k] + " = " + std::to_string(columns(row, static_cast<Eigen::Index>(k)));
    }
    const InputError error(
        place_,
        what() + " is not finite at " + place_of(view, static_cast<std::size_t>(row)) + " (" + at + ")",
        "write it so that it has a value at every reading and pose, as in sqrt(max(0, z))");
    throw CustomEffectError(error, expression_.text(), std::size_t{1});
  }

  SourcePlace place_;
  WrittenTarget target_;
  Expression expression_;
  std::vector<Variable> variables_;  ///< in the order of the expression
  std::vector<std::string> parameters_;
};

/// The expression with the values of parameters that are held, as in "sin(x / p) with p=30": another value is
/// another effect. A value that is estimated moves, and tells none apart.
std::string text_with_held(const CustomFormula& formula, const EffectTable& table) {
  std::string text = formula.expression().text();
  const char* before = " with ";
  for (const std::string& parameter : formula.parameters()) {
    if (table.number(parameter + "_sigma", 0.0) > 0.0) continue;
    text += fmt::format("{}{}={}", before, parameter, table.number(parameter, 0.0));
    before = " ";
  }
  return text;
}

std::unique_ptr<FormulaEffect> make_custom(const EffectTable& table) {
  const CustomFormula formula(table);
  const std::string& target = formula.target().text;
  const std::string text = text_with_held(formula, table);
  const std::string label = target + " by " + text;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{kCustom, formula.target().name(), EffectDriver::written(formula.variables()), text},
      std::vector<EffectAmplitude>{{.label = label,
                                    .target = formula.target().target(),
                                    .key = formula.target().amplitude_key("amplitude"),
                                    .guess = table.number("amplitude", 0.0)}},
      [formula](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return formula.values(view, shape);
      },
      [formula](const Campaign& campaign, const SourcePlace& /*place*/) { formula.check(campaign); });
  effect->be_expression();
  for (const std::string& parameter : formula.parameters()) {
    effect->add_shape({.label = label + ": " + parameter,
                       .key = parameter,
                       .value = table.number(parameter, 0.0),
                       .sigma = table.number(parameter + "_sigma", 0.0)});
  }
  effect->count_unrecorded([formula](const SetupView& view) {
    const bool missing = formula.acts_on(view.campaign, view.setup) && !formula.all_recorded(view.setup);
    return missing ? view.rows() : 0;
  });
  return effect;
}

/// An expression may have any size, and so may its amplitude.
std::vector<KeySchema> amplitude_keys(const std::string& help) {
  std::vector<KeySchema> keys = motion_amplitude_keys({""}, help);
  for (KeySchema& key : keys) {
    key.plausible_min = 1e-18;
    key.plausible_max = 1e9;
  }
  return keys;
}

/// Nobody can guess a formula: there is nothing to look for.
std::vector<EffectSpec> no_candidates(const Campaign& /*campaign*/) { return {}; }

std::vector<EffectSpec> custom_examples(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  const auto add = [&](const std::string& target, const std::string& expression) {
    specs.push_back(written_spec(target, expression));
  };
  const ErrorSymbol symbol{Component::A, campaign.machine.linear_axes().front()};
  const std::string axis(1, lower_letter_of(symbol.axis));
  add(symbol.name(), axis + " / 1000 * tool_length");
  add("tool z", "(1 - exp(-" + axis + " / p)) * abs(" + axis + ")");
  specs.back().options.set("p", 250.0);
  specs.back().options.set("p_sigma", 50.0);
  for (const Setup& setup : campaign.setups) {
    if (traits_of(setup).laser_length != LaserLength::Distance) continue;
    const Instrument& instrument = *find_instrument(setup.instrument);
    add("station " + station_of(setup) + " x", setup.readings.time.empty() ? axis : "t / 3600");
    add(instrument.schema().column_sets[setup.readings.column_set].front().column + " of " + setup.name,
        "sin(2 * pi * length / 500)");
    break;
  }
  return specs;
}

}  // namespace

namespace {

std::string with_character(const std::string& problem, std::optional<std::size_t> character) {
  return character > std::size_t{1} ? fmt::format("{} at character {}", problem, *character) : problem;
}

}  // namespace

CustomEffectError::CustomEffectError(const InputError& error, std::string expression,
                                     std::optional<std::size_t> character)
    : InputError(error.place(), with_character(error.problem(), character), error.remedy()),
      expression_(std::move(expression)),
      told_(error.problem()),
      character_(character) {}

Expression custom_expression(const std::string& formula) {
  return {formula,
          [](const std::string& name) { return is_parameter(name) || Variable::parse_written(name); }};
}

EffectSpec written_spec(const std::string& target, const std::string& expression) {
  return effect_spec(kCustom, {{"target", target}, {"expression", expression}});
}

std::string custom_expression_names() {
  return "variables are " + listed_variables() + ", p, q; functions are " +
         listed_names(Expression::function_names());
}

const EffectKind& custom_effect() {
  static const FormulaKind kind(
      {.kind = kCustom,
       .summary = "your own: amplitude times an expression of what was recorded, added to a target; written "
                  "into the model file, never looked for",
       .plain = "What was written in the model file explains the readings.",
       .usual_causes = "those that its author had in mind",
       .source = "the user; expressions by muParser (beltoforion.de/en/muparser)",
       .keys = joined(
           {{written_target_key(),
             text_key(
                 "expression",
                 "in x y z (mm) a b c (deg) as commanded, dir_x ... (-1, 0, 1), since_x ... (mm since it "
                 "turned round), t (s since the first reading), T_<channel> (degC), length (mm to the "
                 "station), feed (mm/min), tool_length "
                 "tool_x tool_y tool_z (mm), p, q; 1 - exp(-t / p) or z / 1000 * (T_column - 20)"),
             {.key = "p", .help = "value of p in the expression", .plausible_max = 1e9},
             {.key = "p_sigma",
              .help = "standard uncertainty of p before the fit; absent = held",
              .plausible_max = 1e9},
             {.key = "q", .help = "value of q in the expression", .plausible_max = 1e9},
             {.key = "q_sigma",
              .help = "standard uncertainty of q before the fit; absent = held",
              .plausible_max = 1e9}},
            amplitude_keys("what is added where the expression is 1")}),
       .words = {{NamePart::Target, "TARGET",
                  "as written in the model file: SYMBOL, tool [TOOL] AXIS, station STATION AXIS, COLUMN [of "
                  "SETUP]"},
                 {NamePart::Driver, "VARIABLES", "variables of the expression"},
                 {NamePart::Shape, "EXPRESSION", "the expression"}}},
      make_custom, no_candidates, custom_examples);
  return kind;
}

}  // namespace volcal
