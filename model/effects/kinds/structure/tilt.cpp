// What gravity does to a machine whose table or head tilts.
#include <cmath>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr const char* kTiltShapes[] = {"sine", "one-minus-cosine"};

KeySchema tilt_shape_key() {
  return {.key = "shape",
          .type = KeyType::Text,
          .help = "how it follows the tilt: its sine (default) or one minus its cosine",
          .choices = {kTiltShapes[0], kTiltShapes[1]}};
}

KeySchema rotary_axis_key(const std::string& help) {
  return {.key = "axis", .type = KeyType::Text, .required = true, .help = help, .choices = {"A", "B", "C"}};
}

/// Component of gravity along or across, as the tilt changes it.
Eigen::ArrayXd gravity(const SetupView& view, AxisName axis, const std::string& shape) {
  const Eigen::ArrayXd tilt = positions_from_home(view, axis).array();
  return shape == kTiltShapes[0] ? Eigen::ArrayXd(tilt.sin()) : Eigen::ArrayXd(1.0 - tilt.cos());
}

/// What both kinds read from their table.
struct TiltTable {
  ErrorSymbol symbol;
  AxisName axis;
  std::string shape;
  std::string label;

  explicit TiltTable(const EffectTable& table)
      : symbol(table.symbol()),
        axis(table.axis("axis")),
        shape(table.spec.options.text("shape").value_or(kTiltShapes[0])),
        label(symbol.name() + " by " + (shape == kTiltShapes[0] ? "sin " : "1 - cos ") +
              lower_letter_of(axis)) {
    if (!is_rotary(axis))
      table.fail(std::string(1, letter_of(axis)) + " does not tilt", "name a rotary axis");
    if (axis == symbol.axis) {
      table.fail(symbol.name() + " depending on its own axis is the error function itself",
                 "name another axis");
    }
  }

  std::function<void(const Campaign&, const SourcePlace&)> check() const {
    return [*this](const Campaign& campaign, const SourcePlace& place) {
      check_axis(campaign, symbol.axis, label, place);
      check_axis(campaign, axis, label, place);
    };
  }
};

std::unique_ptr<FormulaEffect> make_tilt_load(const EffectTable& table) {
  const TiltTable own(table);
  return std::make_unique<FormulaEffect>(
      EffectName{"tilt-load", own.symbol, position_of(own.axis), own.shape},
      std::vector{motion_amplitude(table, own.label, own.symbol, "")},
      [own](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return gravity(view, own.axis, own.shape);
      },
      own.check());
}

std::unique_ptr<FormulaEffect> make_cradle_coupling(const EffectTable& table) {
  const TiltTable own(table);
  if (!is_rotary(own.symbol.axis))
    table.fail(own.symbol.name() + " is of a linear axis",
               "use tilt-load, or name a motion of a rotary axis");
  return std::make_unique<FormulaEffect>(
      EffectName{"cradle-coupling", own.symbol, position_of(own.axis), own.shape},
      std::vector{motion_amplitude(table, own.label, own.symbol, "", "cos"),
                  motion_amplitude(table, own.label, own.symbol, "", "sin")},
      [own](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const Eigen::ArrayXd turned = positions_from_home(view, own.symbol.axis).array();
        const Eigen::ArrayXd load = gravity(view, own.axis, own.shape);
        Eigen::MatrixXd drivers(turned.size(), 2);
        drivers << load * turned.cos(), load * turned.sin();
        return drivers;
      },
      own.check());
}

/// For every motion of an axis that is wanted, and every other rotary axis that moves.
template <class Wanted>
std::vector<EffectSpec> tilted(const Campaign& campaign, const char* kind, const Wanted& wanted) {
  std::vector<EffectSpec> specs;
  for (const AxisName axis : moving_rotary_axes(campaign)) {
    for (const ErrorSymbol symbol : motions_in_campaign(campaign)) {
      if (symbol.axis == axis || !wanted(symbol)) continue;
      for (const char* shape : kTiltShapes) {
        specs.push_back(effect_spec(kind, {{"symbol", symbol.name()},
                                           {"axis", std::string(1, letter_of(axis))},
                                           {"shape", std::string(shape)}}));
      }
    }
  }
  return specs;
}

std::vector<KeySchema> wave_amplitude_keys() {
  std::vector<KeySchema> keys;
  for (const char* wave : {"cos", "sin"}) {
    for (const char* unit : {"um", "urad"}) {
      keys.push_back(amplitude_key(std::string(wave) + "_" + unit,
                                   std::string("amplitude of the ") + (wave[0] == 'c' ? "cosine" : "sine") +
                                       " of the axis' own position at full tilt"));
    }
  }
  return keys;
}

}  // namespace

const EffectKind& tilt_load_effect() {
  static const FormulaKind kind(
      {.kind = "tilt-load",
       .summary =
           "the weight of a table or head that tilts bends what carries it: an error motion of another "
           "axis follows the component of gravity",
       .plain = "An error motion changes as a table or head tilts: its weight pulls on what carries it in "
                "another direction.",
       .usual_causes = "a cradle or head whose centre of gravity is off its axis; a column or ram that "
                       "yields; a balance that is weak or out of adjustment",
       .source = "ISO/TR 16907:2015, 7.4.2 (non-rigid behaviour) and Figure 9",
       .keys = joined({{symbol_key("error motion that changes: EAZ, EXY ..."),
                        rotary_axis_key("rotary axis that tilts"), tilt_shape_key()},
                       motion_amplitude_keys({""}, "change at a quarter turn")})},
      make_tilt_load, [](const Campaign& campaign) {
        return tilted(campaign, "tilt-load",
                      [](ErrorSymbol symbol) { return is_rotation(symbol.component); });
      });
  return kind;
}

const EffectKind& cradle_coupling_effect() {
  static const FormulaKind kind(
      {.kind = "cradle-coupling",
       .summary = "an error motion of a rotary axis, once per turn, depends on how far another rotary axis "
                  "tilts it: a table whose bearing yields under its weight",
       .plain = "An error motion of a rotary axis, once per turn, grows as another rotary axis tilts it.",
       .usual_causes = "a table bearing that yields under its weight when it stands on edge; a workpiece out "
                       "of balance; a clamp that lets go",
       .source = "ISO/TR 16907:2015, Figure 9 (error motions of a table at several positions of its cradle)",
       .keys = joined({{symbol_key("error motion of a rotary axis: EAC, EZC ..."),
                        rotary_axis_key("rotary axis that tilts it"), tilt_shape_key()},
                       wave_amplitude_keys()})},
      make_cradle_coupling, [](const Campaign& campaign) {
        return tilted(campaign, "cradle-coupling", [](ErrorSymbol symbol) { return is_rotary(symbol.axis); });
      });
  return kind;
}

}  // namespace volcal
