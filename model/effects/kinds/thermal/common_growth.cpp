// A machine that warms up as a whole after it is switched on: every axis grows by the same share.
#include <cmath>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/shared_motions.h"

namespace volcal {
namespace {

constexpr double kUsualGrowth = 3600.0;  // s
constexpr double kShortestGrowth = 120.0;
constexpr double kLongestGrowth = 10.0 * kSecondsPerHour;

std::unique_ptr<FormulaEffect> make_common_growth(const EffectTable& table) {
  const std::vector<AxisName> axes = shared_axes(table);
  const std::vector<ErrorSymbol> symbols = positioning_errors(axes);
  const std::string label = "common growth of " + names_of_axes(axes);
  std::vector<Variable> driver{{Variable::Kind::Time}};
  for (const AxisName axis : axes) driver.push_back(position_of(axis));
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"common-growth", TargetName(symbols), EffectDriver(driver), "1-exp(-t/tau)"},
      std::vector{motion_amplitude(table, label, symbols.front(), "per_m")},
      [axes](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        const double start = clock_start(view);
        const Eigen::VectorXd grown =
            (1.0 - (-(times(view, start).array() - start) / shape[0]).exp()).matrix();
        Eigen::MatrixXd growth(grown.size(), static_cast<Eigen::Index>(axes.size()));
        for (std::size_t k = 0; k < axes.size(); ++k)
          growth.col(static_cast<Eigen::Index>(k)) = positions_from_home(view, axes[k]).cwiseProduct(grown);
        return growth;
      },
      [axes, label](const Campaign& campaign, const SourcePlace& place) {
        for (const AxisName axis : axes) check_axis(campaign, axis, label, place);
        check_time(campaign, label, place);
      });
  EffectShape tau = shape_parameter(table, label + ": time constant", "time_constant", "s", kUsualGrowth,
                                    kShortestGrowth, kLongestGrowth);
  if (!(tau.value > 0.0)) table.fail("its time constant is not positive", "give time_constant_s = 3600.0");
  effect->add_shape(std::move(tau));
  effect->act_on(targets_of(symbols));
  effect->count_unrecorded(without_time());
  return effect;
}

std::vector<EffectSpec> common_growths(const Campaign& campaign) {
  const std::vector<AxisName> axes = axes_that_move(campaign);
  if (axes.size() < 2 || !has_time(campaign)) return {};
  return {effect_spec("common-growth", {{"axes", names_of_axes(axes)}})};
}

}  // namespace

const EffectKind& common_growth_effect() {
  static const FormulaKind kind(
      {.kind = "common-growth",
       .summary =
           "the positioning errors of several axes grow alike, in proportion to the distance from home, "
           "towards a final value after the first reading",
       .plain = "All axes become longer alike after the first reading, fast at first and then slower.",
       .usual_causes = "a machine that was switched on shortly before it was measured; coolant or hall that "
                       "reach another temperature; an instrument that warms up",
       .source = "ISO 230-3:2020, 6 (environmental temperature variation), first order",
       .polynomial = true,
       .keys = joined({{shared_axes_key("axes that grow alike: \"X Y Z\"")},
                       motion_amplitude_keys({"per_m"}, "final growth"),
                       shape_keys("time_constant", "s", "of the growth")})},
      make_common_growth, common_growths);
  return kind;
}

}  // namespace volcal
