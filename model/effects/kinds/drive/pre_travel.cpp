// What an axis has not yet taken up after it turned round: wind-up of a screw, friction in front of a scale.
#include <algorithm>
#include <cmath>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/travel_since_turning.h"

namespace volcal {
namespace {

constexpr double kUsualLength = 10e-3;  // m
constexpr double kShortestLength = 1e-3;
constexpr double kLongestLength = 300e-3;

/// d/2 exp(-s/length), s travelled since the axis turned round; 0 where the direction is not known.
Eigen::VectorXd fading_half(const SetupView& view, AxisName axis, double length) {
  Eigen::VectorXd half = 0.5 * directions(view, axis);
  if (!view.is_path) return Eigen::VectorXd::Zero(half.size());
  const std::vector<double> travelled = travel_since_turning(view.campaign.machine, view.setup, axis);
  for (Eigen::Index i = 0; i < half.size(); ++i)
    half[i] *= std::exp(-travelled[static_cast<std::size_t>(i)] / length);
  return half;
}

std::unique_ptr<FormulaEffect> make_pre_travel(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string label = "pre-travel " + symbol.name();
  const Variable approach = direction_of_approach(symbol.axis);
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"pre-travel", symbol, EffectDriver::called(approach.name() + " travel", {approach}),
                 "exp(-s/l)"},
      std::vector{motion_amplitude(table, label, symbol, "")},
      [symbol](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return fading_half(view, symbol.axis, shape[0]);
      },
      [symbol, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
      });
  const EffectShape length = shape_parameter(table, label + ": length", "length", "mm", kUsualLength,
                                             kShortestLength, kLongestLength);
  if (!(length.value > 0.0)) table.fail("its length is not positive", "give length_mm = 10.0");
  effect->add_shape(length);
  effect->count_unrecorded([symbol](const SetupView& view) {
    const auto& direction = view.setup.readings.direction[index_of(symbol.axis)];
    return direction.empty() ? view.rows()
                             : static_cast<std::size_t>(std::ranges::count(direction, std::int8_t{0}));
  });
  return effect;
}

std::vector<EffectSpec> pre_travels(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    if (symbol.is_positioning()) specs.push_back(effect_spec("pre-travel", {{"symbol", symbol.name()}}));
  }
  return specs;
}

}  // namespace

const EffectKind& pre_travel_effect() {
  static const FormulaKind kind(
      {.kind = "pre-travel",
       .summary =
           "after an axis has turned round, an error motion differs by b between the two directions, "
           "less the further it has travelled: b exp(-s/l); tables hold what is left after long travel",
       .plain = "After an axis has turned round it takes a way to settle: its error fades the farther it "
                "travels on.",
       .usual_causes = "seals, wipers or covers that stick before they slide; friction that winds up the "
                       "drive; a hydrostatic or plain guideway that lifts as it moves",
       .source =
           "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083 (presliding displacement)",
       .keys = joined({{symbol_key("error motion that lags: EXX, EYY, EZZ, or another motion of the axis")},
                       shape_keys("length", "mm", "travel after which a third of it is left"),
                       motion_amplitude_keys({""}, "b at the turn: value towards + minus value towards -")})},
      make_pre_travel, pre_travels);
  return kind;
}

}  // namespace volcal
