// Errors of a rotary axis that repeat with a turn of its worm or pinion, and with a turn of its encoder's
// ring.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "volcal/model/description/rotary_places.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;
constexpr int kFewestTeeth = 3;
constexpr int kMostTeeth = 720;
constexpr double kUsualTeeth = 90.0;

Eigen::MatrixXd wave(const SetupView& view, AxisName axis, double period) {
  const Eigen::ArrayXd phase = positions_from_home(view, axis).array() * (kFullTurn / period);
  Eigen::MatrixXd drivers(phase.size(), 2);
  drivers << phase.cos(), phase.sin();
  return drivers;
}

/// How many teeth a wheel may have to be told from one with fewer: less than half as many as the axis had
/// different places. At half, as at the Nyquist frequency, one of the two amplitudes moves nothing where the
/// places are regular.
int most_teeth(const Campaign& campaign, AxisName axis) {
  return std::min(kMostTeeth, most_periods(places_in_turn(campaign, axis)));
}

/// Whole numbers of periods a turn, as teeth of a wheel are; none where the places are too few for any.
std::vector<Eigen::VectorXd> periods_of_wheels(const Campaign& campaign, AxisName axis) {
  const int most = most_teeth(campaign, axis);
  std::vector<Eigen::VectorXd> values;
  for (int teeth = kFewestTeeth; teeth <= most; ++teeth)
    values.emplace_back(Eigen::VectorXd::Constant(1, kFullTurn / teeth));
  return values;
}

ErrorSymbol rotary_symbol(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  if (!is_rotary(symbol.axis))
    table.fail(symbol.name() + " is of a linear axis",
               "use lead-error or rack-error, or name a motion of a rotary axis");
  return symbol;
}

std::unique_ptr<FormulaEffect> make_worm_error(const EffectTable& table) {
  const ErrorSymbol symbol = rotary_symbol(table);
  const std::string label = "worm error " + symbol.name();
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"worm-error", symbol, position_of(symbol.axis), "periodic"},
      std::vector{motion_amplitude(table, label, symbol, "", "cos"),
                  motion_amplitude(table, label, symbol, "", "sin")},
      [symbol](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return wave(view, symbol.axis, shape[0]);
      },
      [symbol, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
      });
  const EffectShape period =
      shape_parameter(table, label + ": period", "period", "deg", kFullTurn / kUsualTeeth,
                      kFullTurn / kMostTeeth, kFullTurn / kFewestTeeth);
  if (!(period.value > 0.0)) table.fail("its period is not positive", "give period_deg = 4.0");
  effect->add_shape(period);
  effect->scan_by([axis = symbol.axis, given = period.value](const Campaign& campaign) {
    auto values = periods_of_wheels(campaign, axis);
    if (values.empty()) values.emplace_back(Eigen::VectorXd::Constant(1, given));
    return values;
  });
  return effect;
}

/// Of axes whose places tell waves of as many periods a turn.
std::vector<EffectSpec> positioning_of_rotary_axes(const Campaign& campaign, const char* kind, int periods) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : motions_in_campaign(campaign)) {
    if (is_rotary(symbol.axis) && symbol.is_positioning() && most_teeth(campaign, symbol.axis) >= periods)
      specs.push_back(effect_spec(kind, {{"symbol", symbol.name()}}));
  }
  return specs;
}

std::vector<KeySchema> wave_keys(const std::string& of) {
  std::vector<KeySchema> keys;
  for (const char* part : {"cos", "sin"}) {
    for (const char* unit : {"um", "urad"}) {
      keys.push_back(amplitude_key(std::string(part) + "_" + unit,
                                   std::string("amplitude of the ") + (part[0] == 'c' ? "cosine" : "sine") +
                                       of + (unit[1] == 'm' ? ", displacements" : ", rotations")));
    }
  }
  return keys;
}

std::unique_ptr<FormulaEffect> make_ring_eccentricity(const EffectTable& table) {
  const ErrorSymbol symbol = rotary_symbol(table);
  if (!symbol.is_positioning())
    table.fail(symbol.name() + " is not a rotation about the axis itself",
               "write EAA, EBB or ECC: an encoder acts on the angle of its axis");
  const std::string label = "ring eccentricity " + symbol.name();
  return std::make_unique<FormulaEffect>(
      EffectName{"ring-eccentricity", symbol, position_of(symbol.axis), "periodic"},
      std::vector{motion_amplitude(table, label, symbol, "", "cos"),
                  motion_amplitude(table, label, symbol, "", "sin")},
      [symbol](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return wave(view, symbol.axis, kFullTurn);
      },
      [symbol, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
      });
}

}  // namespace

const EffectKind& worm_error_effect() {
  static const FormulaKind kind(
      {.kind = "worm-error",
       .summary = "a rotary axis repeats its error with every turn of its worm or pinion",
       .plain = "The angle of a rotary axis repeats its error with every turn of its worm or pinion.",
       .usual_causes = "a worm or pinion that is not centred in its bearings; a worn or badly meshed pair; a "
                       "motor's encoder that sits off centre",
       .source = "ISO 1328-1 (single-pitch and tooth-to-tooth composite deviations of gears)",
       .keys = joined({{symbol_key("error motion of a rotary axis: EAA, EBB, ECC, or another")},
                       shape_keys("period", "deg", "period in positions of the axis: 360 / teeth"),
                       wave_keys("")})},
      make_worm_error, [](const Campaign& campaign) {
        return positioning_of_rotary_axes(campaign, "worm-error", kFewestTeeth);
      });
  return kind;
}

const EffectKind& ring_eccentricity_effect() {
  static const FormulaKind kind(
      {.kind = "ring-eccentricity",
       .summary = "the encoder ring of a rotary axis sits off centre: its angle is wrong by one wave a turn",
       .plain = "The angle of a rotary axis is wrong by one wave a turn.",
       .usual_causes = "an encoder ring or wheel that is not centred on the axis; one reading head where two "
                       "would cancel it",
       .source = "ISO 230-1, angular positioning; error 2 e / D of a ring of diameter D, eccentric by e",
       .keys = joined({{symbol_key("angle of the axis: EAA, EBB or ECC")}, wave_keys(" of the position")})},
      make_ring_eccentricity,
      [](const Campaign& campaign) { return positioning_of_rotary_axes(campaign, "ring-eccentricity", 1); });
  return kind;
}

}  // namespace volcal
