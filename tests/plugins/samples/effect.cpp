// A sample: a cover that pulls at an axis, most where it is folded.
#include <cmath>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kFold = 0.2;  // m

std::unique_ptr<FormulaEffect> make_sample(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  return std::make_unique<FormulaEffect>(
      EffectName{"sample", symbol, position_of(symbol.axis), "exponential"},
      std::vector{motion_amplitude(table, "sample " + symbol.name(), symbol, "")},
      [symbol](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return (-positions_from_home(view, symbol.axis).array().abs() / kFold).exp().matrix();
      },
      [symbol](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, "sample " + symbol.name(), place);
      });
}

std::vector<EffectSpec> samples(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine))
    specs.push_back(effect_spec("sample", {{"symbol", symbol.name()}}));
  return specs;
}

}  // namespace

const EffectKind& sample_effect() {
  static const FormulaKind kind(
      {.kind = "sample",
       .summary = "the cover of an axis pulls where it is folded",
       .plain = "The cover of an axis pulls at it where it is folded.",
       .usual_causes = "a cover that has no grease; a cover of another machine",
#ifdef VOLCAL_WRONG_SAMPLE
       .source = "",
#else
       .source = "a sample of a test",
#endif
       .keys =
           joined({{symbol_key("error motion")}, motion_amplitude_keys({""}, "pull of the folded cover")}),
       .words = {{NamePart::Shape, "exponential", "less the farther it is from home"}},
       .simulated = false},
      make_sample, samples);
  return kind;
}

}  // namespace volcal
