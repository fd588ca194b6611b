#include "own_effect.h"

#include <string>
#include <utility>
#include <vector>

#include "volcal/model/effects/formula_effect.h"

namespace {

/// -1 or +1 by the direction in which a position was approached, 0 where it was not recorded.
Eigen::MatrixXd approach(const volcal::SetupView& view, volcal::AxisName axis) {
  const auto& direction = view.setup.readings.direction[volcal::index_of(axis)];
  Eigen::MatrixXd driver = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(view.rows()), 1);
  for (std::size_t row = 0; row < direction.size(); ++row)
    driver(static_cast<Eigen::Index>(row), 0) = static_cast<double>(direction[row]);
  return driver;
}

std::unique_ptr<volcal::FormulaEffect> make_play(const volcal::EffectTable& table) {
  const volcal::ErrorSymbol symbol = table.symbol();
  const std::string label = "play " + symbol.name();
  return std::make_unique<volcal::FormulaEffect>(
      volcal::EffectName{
          "play", symbol,
          volcal::EffectDriver::called("approach", {volcal::direction_of_approach(symbol.axis)}), "step"},
      std::vector{volcal::motion_amplitude(table, label, symbol, "")},
      [symbol](const volcal::SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return 0.5 * approach(view, symbol.axis);
      },
      [symbol, label](const volcal::Campaign& campaign, const volcal::SourcePlace& place) {
        volcal::check_axis(campaign, symbol.axis, label, place);
      });
}

std::vector<volcal::EffectSpec> plays(const volcal::Campaign& campaign) {
  std::vector<volcal::EffectSpec> specs;
  for (const volcal::ErrorSymbol symbol : volcal::linear_axis_motions(campaign.machine))
    specs.push_back(volcal::effect_spec("play", {{"symbol", symbol.name()}}));
  return specs;
}

}  // namespace

std::unique_ptr<const volcal::EffectKind> play_effect() {
  volcal::EffectSchema schema{
      .kind = "play",
      .summary = "an error motion differs between the two directions of approach of its axis",
      .source = "this example",
      .keys = volcal::joined({{volcal::symbol_key("error motion that jumps")},
                              volcal::motion_amplitude_keys({""}, "value towards + minus value towards -")})};
  return std::make_unique<volcal::FormulaKind>(std::move(schema), make_play, plays);
}
