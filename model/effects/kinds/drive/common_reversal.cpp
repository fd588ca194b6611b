// The same reversal on several axes: drives of one make, one setting of the control, one way of probing.
#include <algorithm>
#include <set>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/shared_motions.h"

namespace volcal {
namespace {

EffectDriver directions_of(const std::vector<ErrorSymbol>& symbols) {
  std::vector<Variable> directions;
  std::set<AxisName> known;
  for (const ErrorSymbol symbol : symbols) {
    if (known.insert(symbol.axis).second) directions.push_back(direction_of_approach(symbol.axis));
  }
  return EffectDriver(directions);
}

std::unique_ptr<FormulaEffect> make_common_reversal(const EffectTable& table) {
  const std::vector<ErrorSymbol> symbols = shared_symbols(table);
  const std::string label = "common reversal of " + names_of_symbols(symbols);
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"common-reversal", TargetName(symbols), directions_of(symbols), "step"},
      std::vector{motion_amplitude(table, label, symbols.front(), "")},
      [symbols](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        Eigen::MatrixXd halves(static_cast<Eigen::Index>(view.rows()),
                               static_cast<Eigen::Index>(symbols.size()));
        for (std::size_t k = 0; k < symbols.size(); ++k)
          halves.col(static_cast<Eigen::Index>(k)) = 0.5 * directions(view, symbols[k].axis);
        return halves;
      },
      [symbols, label](const Campaign& campaign, const SourcePlace& place) {
        for (const ErrorSymbol symbol : symbols) check_axis(campaign, symbol.axis, label, place);
      });
  effect->act_on(targets_of(symbols));
  effect->count_unrecorded([symbols](const SetupView& view) {
    std::size_t most = 0;
    for (const ErrorSymbol symbol : symbols) {
      const auto& direction = view.setup.readings.direction[index_of(symbol.axis)];
      const auto unknown = direction.empty() ? static_cast<std::ptrdiff_t>(view.rows())
                                             : std::ranges::count(direction, std::int8_t{0});
      most = std::max(most, static_cast<std::size_t>(unknown));
    }
    return most;
  });
  return effect;
}

std::vector<EffectSpec> common_reversals(const Campaign& campaign) {
  const std::vector<AxisName> axes = axes_that_turn_round(campaign);
  if (axes.size() < 2) return {};
  return {effect_spec("common-reversal", {{"symbols", names_of_symbols(positioning_errors(axes))}})};
}

}  // namespace

const EffectKind& common_reversal_effect() {
  static const FormulaKind kind(
      {.kind = "common-reversal",
       .summary =
           "several error motions differ by the same b between the directions of approach of their own "
           "axes: one cause in several drives",
       .plain = "Several axes stop at two different places by the same amount.",
       .usual_causes = "one setting of backlash compensation or friction in the control for all axes; drives "
                       "of one make at one preload; a reflector or probe that follows its carrier late; "
                       "settling that is not waited for",
       .source = "ISO 230-2:2014, 3.11 (reversal value)",
       .polynomial = true,
       .keys = joined({{shared_symbols_key("error motions that jump alike: \"EXX EYY EZZ\"")},
                       motion_amplitude_keys({""}, "b of each: value towards + minus value towards -")})},
      make_common_reversal, common_reversals);
  return kind;
}

}  // namespace volcal
