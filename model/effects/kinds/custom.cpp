// What a user writes: a target and a formula of what was recorded, its amplitude unknown.
#include "volcal/model/effects/kinds/custom.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr std::array<const char*, 2> kParameters = {"p", "q"};

/// What the effect acts on. `owner`: tool, station or setup; empty = all.
struct CustomTarget {
  TargetKind kind = TargetKind::Motion;
  ErrorSymbol symbol;
  int component = 0;
  std::string owner;
  std::string column;  ///< of Reading
  std::string amplitude_key = "amplitude_um";
};

const std::string kTargets =
    "write an error motion (EAY), \"tool x\", \"tool NAME x\", \"station NAME x\", or a column of readings "
    "(\"length_mm\", \"azimuth_deg of SETUP\")";

/// Channel of a column in an instrument's set of columns.
std::optional<int> channel_of(const std::vector<ColumnSchema>& columns, const std::string& column) {
  const auto found = std::ranges::find(columns, column, &ColumnSchema::column);
  if (found == columns.end()) return std::nullopt;
  return static_cast<int>(found - columns.begin());
}

std::optional<int> channel_of(const Setup& setup, const std::string& column) {
  const Instrument* instrument = find_instrument(setup.instrument);
  if (instrument == nullptr) return std::nullopt;
  return channel_of(instrument->schema().column_sets[setup.readings.column_set], column);
}

std::optional<int> channel_of(const std::string& column) {
  for (const Instrument* instrument : instruments()) {
    for (const auto& columns : instrument->schema().column_sets) {
      if (const auto channel = channel_of(columns, column)) return channel;
    }
  }
  return std::nullopt;
}

/// "tool NAME x" after its first word; nothing when it does not end in a direction.
std::optional<CustomTarget> vector_target(TargetKind kind, const std::string& rest) {
  const std::size_t space = rest.rfind(' ');
  const std::string direction = space == std::string::npos ? rest : rest.substr(space + 1);
  if (direction.size() != 1 || direction[0] < 'x' || direction[0] > 'z') return std::nullopt;
  CustomTarget target;
  target.kind = kind;
  target.component = direction[0] - 'x';
  if (space != std::string::npos) target.owner = rest.substr(0, space);
  return target;
}

std::optional<CustomTarget> reading_target(const std::string& text) {
  const std::size_t of = text.find(" of ");
  CustomTarget target;
  target.kind = TargetKind::Reading;
  target.column = text.substr(0, of);
  if (of != std::string::npos) target.owner = text.substr(of + 4);
  const auto channel = channel_of(target.column);
  if (!channel) return std::nullopt;
  target.component = *channel;
  if (unit_of_key(target.column).suffix.ends_with("rad") || unit_of_key(target.column).suffix == "deg") {
    target.amplitude_key = "amplitude_urad";
  }
  return target;
}

CustomTarget target_of(const EffectTable& table) {
  const std::string text = table.text("target", kTargets);
  std::optional<CustomTarget> target;
  if (const auto symbol = ErrorSymbol::parse(text)) {
    target.emplace().symbol = *symbol;
    target->amplitude_key = motion_amplitude_key(*symbol, "");
  } else if (text.starts_with("tool ")) {
    target = vector_target(TargetKind::ToolOffset, text.substr(5));
  } else if (text.starts_with("station ")) {
    target = vector_target(TargetKind::Station, text.substr(8));
    if (target && target->owner.empty()) target.reset();
  } else {
    target = reading_target(text);
  }
  if (!target) table.fail("\"" + text + "\" is no target", kTargets);
  return *target;
}

/// The channel that a variable T_... means.
const std::vector<double>* temperature(const Readings& readings, const std::string& variable) {
  for (const auto& [channel, values] : readings.temperature) {
    if (channel_variable(channel) == variable) return &values;
  }
  return nullptr;
}

std::optional<AxisName> axis_of(const std::string& letter) {
  if (letter.size() != 1 || letter[0] < 'a') return std::nullopt;
  return axis_from_letter(static_cast<char>(std::toupper(letter[0])));
}

const std::vector<std::string>& plain_variables() {
  static const std::vector<std::string> kNames = {"t",      "length", "feed",  "tool_length",
                                                  "tool_x", "tool_y", "tool_z"};
  return kNames;
}

bool is_variable(const std::string& name) {
  if (name.starts_with("T_")) return name.size() > 2;
  if (std::ranges::find(plain_variables(), name) != plain_variables().end()) return true;
  if (std::ranges::find(kParameters, name) != kParameters.end()) return true;
  return axis_of(name.starts_with("dir_") ? name.substr(4) : name).has_value();
}

template <class Values>
Eigen::VectorXd scaled(const Values& values, double unit) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    out[static_cast<Eigen::Index>(i)] = static_cast<double>(values[i]) / unit;
  }
  return out;
}

/// A variable of a setup's readings in the units that users write; nothing when it was not recorded there.
std::optional<Eigen::VectorXd> recorded(const SetupView& view, const std::string& name) {
  const Readings& readings = view.setup.readings;
  const auto rows = static_cast<Eigen::Index>(view.rows());
  if (name.starts_with("T_")) {
    const std::vector<double>* values = temperature(readings, name);
    if (values == nullptr) return std::nullopt;
    return scaled(*values, 1.0);
  }
  if (name.starts_with("dir_")) {
    const auto& direction = readings.direction[index_of(*axis_of(name.substr(4)))];
    if (direction.empty()) return std::nullopt;
    return scaled(direction, 1.0);
  }
  if (const auto axis = axis_of(name)) {
    return scaled(readings.position[index_of(*axis)], position_unit(*axis).si_per_unit);
  }
  if (name == "t") {
    if (readings.time.empty()) return std::nullopt;
    return times(view).array() - clock_start(view);
  }
  if (name == "feed") {
    if (readings.feed.empty()) return std::nullopt;
    return scaled(readings.feed, unit_of_key("feed_mm_min").si_per_unit);
  }
  if (name == "length") return view.length / kMetrePerMillimetre;
  const Eigen::Vector3d offset = view.campaign.machine.tools[view.setup.tool].offset / kMetrePerMillimetre;
  return Eigen::VectorXd::Constant(rows, name == "tool_length" ? offset.norm() : offset[name.back() - 'x']);
}

/// Whether the readings of a setup have a variable's column.
bool is_recorded(const Setup& setup, const std::string& name) {
  const Readings& readings = setup.readings;
  if (name.starts_with("T_")) return temperature(readings, name) != nullptr;
  if (name.starts_with("dir_")) return !readings.direction[index_of(*axis_of(name.substr(4)))].empty();
  if (name == "t") return !readings.time.empty();
  if (name == "feed") return !readings.feed.empty();
  return true;
}

std::string column_of(const std::string& variable) {
  if (variable.starts_with("T_")) return variable + "_degC";
  if (variable == "t") return "time_s";
  if (variable == "feed") return "feed_mm_min";
  return variable;
}

class CustomFormula {
 public:
  explicit CustomFormula(const EffectTable& table)
      : place_(table.place), target_(target_of(table)), expression_(expression_of(table)) {
    for (const std::string& name : expression_.variables()) {
      const bool is_parameter = std::ranges::find(kParameters, name) != kParameters.end();
      (is_parameter ? parameters_ : variables_).push_back(name);
    }
    if (variables_.empty()) table.fail("its expression depends on nothing", "write a variable into it");
    for (const std::string parameter : kParameters) check_parameter(table, parameter);
  }

  const CustomTarget& target() const { return target_; }
  const Expression& expression() const { return expression_; }
  /// Those that were recorded, without the parameters of the shape.
  const std::vector<std::string>& variables() const { return variables_; }
  const std::vector<std::string>& parameters() const { return parameters_; }

  void check(const Campaign& campaign) const {
    check_target(campaign);
    for (const std::string& name : variables_) check_variable(campaign, name);
  }

  bool acts_on(const Campaign& campaign, const Setup& setup) const {
    switch (target_.kind) {
      case TargetKind::ToolOffset:
        return target_.owner.empty() || campaign.machine.tools[setup.tool].name == target_.owner;
      case TargetKind::Station:
        return station_of(setup) == target_.owner;
      case TargetKind::Reading:
        return (target_.owner.empty() || setup.name == target_.owner) &&
               channel_of(setup, target_.column) == target_.component;
      default:
        return true;
    }
  }

  bool all_recorded(const Setup& setup) const {
    return std::ranges::all_of(variables_, [&](const auto& name) { return is_recorded(setup, name); });
  }

  /// Throws InputError where the expression is not finite.
  Eigen::VectorXd values(const SetupView& view, const Eigen::VectorXd& shape) const {
    const auto rows = static_cast<Eigen::Index>(view.rows());
    const bool measured = view.length.size() == rows || !expression_.uses("length");
    if (!acts_on(view.campaign, view.setup) || !all_recorded(view.setup) || !measured)
      return Eigen::VectorXd::Zero(rows);
    const auto& names = expression_.variables();
    Eigen::MatrixXd columns(rows, static_cast<Eigen::Index>(names.size()));
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto parameter = std::ranges::find(parameters_, names[k]);
      columns.col(static_cast<Eigen::Index>(k)) =
          parameter == parameters_.end()
              ? *recorded(view, names[k])
              : Eigen::VectorXd(Eigen::VectorXd::Constant(rows, shape[parameter - parameters_.begin()]));
    }
    Eigen::VectorXd result = expression_.evaluate(columns);
    for (Eigen::Index row = 0; row < rows; ++row) {
      if (!std::isfinite(result[row])) fail_not_finite(view.setup, names, columns, row);
    }
    return result;
  }

 private:
  static Expression expression_of(const EffectTable& table) {
    const std::string text = table.text("expression", "add expression = \"z * (T_column - 20)\"");
    try {
      return custom_expression(text);
    } catch (const ExpressionError& error) {
      table.fail("the expression \"" + text + "\": " + error.what(), custom_expression_names());
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

  void check_target(const Campaign& campaign) const {
    switch (target_.kind) {
      case TargetKind::Motion:
        return check_axis(campaign, target_.symbol.axis, what(), place_);
      case TargetKind::ToolOffset:
        return target_.owner.empty() ? void() : check_tool(campaign, target_.owner, place_);
      case TargetKind::Station:
        return check_station(campaign, target_.owner, place_);
      default:
        break;
    }
    if (!target_.owner.empty()) check_setup(campaign, target_.owner, place_);
    for (const Setup& setup : campaign.setups) {
      if (acts_on(campaign, setup)) return;
    }
    throw InputError(place_, what() + ": no reading has the column " + target_.column,
                     "name a column of the campaign's readings or remove the effect");
  }

  void check_variable(const Campaign& campaign, const std::string& name) const {
    const auto axis = axis_of(name.starts_with("dir_") ? name.substr(4) : name);
    if (axis) check_axis(campaign, *axis, what(), place_);
    for (const Setup& setup : campaign.setups) {
      if (acts_on(campaign, setup) && is_recorded(setup, name)) return;
    }
    std::string remedy = "add the column " + column_of(name) + " or write another variable";
    if (name.starts_with("T_")) {
      remedy += "; channels of the campaign: " + listed_names(temperature_channels(campaign));
    }
    throw InputError(place_,
                     what() + ": column " + column_of(name) + " is missing, but the expression uses " + name +
                         " at character " + std::to_string(expression_.character_of(name)),
                     remedy);
  }

  std::string what() const { return "custom effect \"" + expression_.text() + "\""; }

  [[noreturn]] void fail_not_finite(const Setup& setup, const std::vector<std::string>& names,
                                    const Eigen::MatrixXd& columns, Eigen::Index row) const {
    std::string at;
    for (std::size_t k = 0; k < names.size(); ++k) {
      at +=
          (k > 0 ? ", " : "") + names[k] + " = " + std::to_string(columns(row, static_cast<Eigen::Index>(k)));
    }
    const std::string where = setup.data.empty() ? "setup " + setup.name : setup.data;
    const auto line = setup.readings.source_line[static_cast<std::size_t>(row)];
    throw InputError(
        place_, what() + " is not finite at " + where + ", line " + std::to_string(line) + " (" + at + ")",
        "write it so that it has a value at every reading, as in sqrt(max(0, z))");
  }

  SourcePlace place_;
  CustomTarget target_;
  Expression expression_;
  std::vector<std::string> variables_;
  std::vector<std::string> parameters_;
};

std::string joined_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

std::unique_ptr<FormulaEffect> make_custom(const EffectTable& table) {
  const CustomFormula formula(table);
  const std::string target = *table.spec.options.text("target");
  const std::string label = target + " by " + formula.expression().text();
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"custom", target, joined_names(formula.variables()), formula.expression().text()},
      std::vector<EffectAmplitude>{{.label = label,
                                    .target = {.kind = formula.target().kind,
                                               .symbol = formula.target().symbol,
                                               .component = formula.target().component},
                                    .key = formula.target().amplitude_key,
                                    .guess = table.number("amplitude", 0.0)}},
      [formula](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return formula.values(view, shape);
      },
      [formula](const Campaign& campaign, const SourcePlace& /*place*/) { formula.check(campaign); });
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
    specs.push_back(effect_spec("custom", {{"target", target}, {"expression", expression}}));
  };
  const ErrorSymbol symbol{Component::A, linear_axes(campaign.machine).front()};
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

Expression custom_expression(const std::string& formula) { return {formula, is_variable}; }

std::string custom_expression_names() {
  return "variables are x y z a b c, dir_x ... dir_c, T_<channel>, " + listed_names(plain_variables()) +
         ", p, q; functions are " + listed_names(Expression::function_names());
}

const EffectKind& custom_effect() {
  static const FormulaKind kind(
      {.kind = "custom",
       .summary = "your own: amplitude times an expression of what was recorded, added to a target; written "
                  "into the model file, never looked for",
       .source = "the user; expressions by muParser (beltoforion.de/en/muparser)",
       .keys = joined(
           {{text_key("target",
                      "error motion (EAY), \"tool x\", \"tool NAME x\", \"station NAME x\", or a "
                      "column of readings (\"length_mm\", \"azimuth_deg of SETUP\")"),
             text_key("expression",
                      "in x y z (mm) a b c (deg) as commanded, dir_x ... (-1, 0, 1), t (s since the first "
                      "reading), T_<channel> (degC), length (mm to the station), feed (mm/min), tool_length "
                      "tool_x tool_y tool_z (mm), p, q; 1 - exp(-t / p) or z / 1000 * (T_column - 20)"),
             {.key = "p", .help = "value of p in the expression", .plausible_max = 1e9},
             {.key = "p_sigma",
              .help = "standard uncertainty of p before the fit; absent = held",
              .plausible_max = 1e9},
             {.key = "q", .help = "value of q in the expression", .plausible_max = 1e9},
             {.key = "q_sigma",
              .help = "standard uncertainty of q before the fit; absent = held",
              .plausible_max = 1e9}},
            amplitude_keys("what is added where the expression is 1")})},
      make_custom, no_candidates, custom_examples);
  return kind;
}

}  // namespace volcal
